// SPDX-License-Identifier: Apache-2.0
// The cache of tables of this process. The public interface is in aureole/cache.py.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <mutex>
#include <optional>

#include "aureole/core/error.h"
#include "bindings.h"
#include "current_tables.h"
#include "text.h"

namespace aureole::python {

namespace {

struct CurrentTables {
  std::mutex mutex;
  bool is_chosen = false;
  std::shared_ptr<TableCache> cache;
};

CurrentTables& current() {
  static CurrentTables instance;
  return instance;
}

std::shared_ptr<TableCache> required() {
  std::shared_ptr<TableCache> cache = current_tables();
  if (!cache) throw Error("the cache is off: cache.use names a folder");
  return cache;
}

}  // namespace

std::shared_ptr<TableCache> current_tables() {
  CurrentTables& c = current();
  const std::lock_guard guard(c.mutex);
  if (!c.is_chosen) c.cache = TableCache::chosen(""), c.is_chosen = true;
  return c.cache;
}

void bind_cache(nb::module_& m) {
  m.def(
      "cache_use",
      [](const std::filesystem::path& choice) {
        CurrentTables& c = current();
        const std::lock_guard guard(c.mutex);
        c.cache = TableCache::chosen(choice.string()), c.is_chosen = true;
      },
      nb::arg("choice"));
  m.def("cache_folder", []() -> std::optional<nb::str> {
    const auto cache = current_tables();
    if (!cache) return {};
    return file_name(cache->folder().string());
  });
  m.def("cache_entries", [] {
    nb::list list;
    const auto cache = required();
    for (const TableEntry& e : cache->entries())
      list.append(nb::make_tuple(file_name(e.file.string()), e.bytes, e.used_s, decoded(e.table),
                                 decoded(e.made_for), decoded(e.build), e.seconds));
    return list;
  });
  m.def("cache_clear", [] { return required()->clear(); });
  m.def("cache_limit", [] { return required()->limit(); });
  m.def(
      "cache_set_limit", [](const std::string& bytes) { required()->set_limit(parse_bytes(bytes)); },
      nb::arg("bytes"));
}

}  // namespace aureole::python
