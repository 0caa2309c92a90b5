// SPDX-License-Identifier: Apache-2.0
// aureole cache: the tables that are kept for the next start.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <memory>

#include "aureole/core/error.h"
#include "command.h"
#include "scene_loading.h"

namespace aureole {
namespace {

std::shared_ptr<TableCache> required_cache() {
  const std::shared_ptr<TableCache> cache = table_cache();
  if (!cache)
    throw Error("the cache is off: --cache or the environment variable AUREOLE_CACHE names a folder");
  return cache;
}

std::string count_text(std::size_t tables) {
  return fmt::format("{} {}", tables, tables == 1 ? "table" : "tables");
}

double megabytes(std::uint64_t bytes) { return 1e-6 * double(bytes); }

void print_size(const TableCache& cache, const std::vector<TableEntry>& entries) {
  std::uint64_t bytes = 0;
  double seconds = 0;
  for (const TableEntry& e : entries) bytes += e.bytes, seconds += e.seconds;
  fmt::print("{}: {}, {:.1f} MB of {:.1f} MB, {:.1f} s to make\n", cache.folder().string(),
             count_text(entries.size()), megabytes(bytes), megabytes(cache.limit()), seconds);
}

int list_entries() {
  const auto cache = required_cache();
  const std::vector<TableEntry> entries = cache->entries();
  const std::string build = table_build();
  if (!entries.empty())
    fmt::print("{:>9} {:>9} {:<16} {:<34} {}\n", "MB", "seconds", "last used", "table", "made for");
  for (const TableEntry& e : entries) {
    const std::string used = fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::time_t(e.used_s)));
    const char* remark = e.table.empty() ? "damaged" : e.build != build ? ", by another version" : "";
    fmt::print("{:9.2f} {:9.2f} {:<16} {:<34} {}{}\n", megabytes(e.bytes), e.seconds, used, e.table,
               e.made_for, remark);
  }
  print_size(*cache, entries);
  return 0;
}

int print_cache_size() {
  const auto cache = required_cache();
  print_size(*cache, cache->entries());
  return 0;
}

int clear_cache() {
  const auto cache = required_cache();
  fmt::print("{}: {} removed\n", cache->folder().string(), count_text(cache->clear()));
  return 0;
}

int limit_cache(const std::string& bytes) {
  const auto cache = required_cache();
  if (!bytes.empty()) cache->set_limit(parse_bytes(bytes));
  fmt::print("{}: at most {:.1f} MB\n", cache->folder().string(), megabytes(cache->limit()));
  return 0;
}

std::function<int()> declare_list(CommandOptions& options) {
  add_cache_option(options);
  return list_entries;
}
std::function<int()> declare_size(CommandOptions& options) {
  add_cache_option(options);
  return print_cache_size;
}
std::function<int()> declare_clear(CommandOptions& options) {
  add_cache_option(options);
  return clear_cache;
}
std::function<int()> declare_limit(CommandOptions& options) {
  auto bytes = std::make_shared<std::string>();
  options.add("bytes", *bytes,
              "upper bound of the folder's size, such as 500MB; without it the bound is printed");
  add_cache_option(options);
  return [=] { return limit_cache(*bytes); };
}

const CommandRegistration kRegistrations[] = {
    CommandRegistration(
        {"cache", "Tables that are kept for the next start: list, size, clear, limit", nullptr}),
    CommandRegistration({"cache list", "List the kept tables, the last used first", declare_list}),
    CommandRegistration({"cache size", "Print the size of all kept tables", declare_size}),
    CommandRegistration({"cache clear", "Remove all kept tables", declare_clear}),
    CommandRegistration({"cache limit", "Print or set the upper bound of their size", declare_limit})};

}  // namespace
}  // namespace aureole
