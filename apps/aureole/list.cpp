// SPDX-License-Identifier: Apache-2.0
// aureole list: lists the available plug-ins.
#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/plugin/registry.h"
#include "command.h"

namespace aureole {
namespace {

/// Returns the text up to the first punctuation mark that ends a clause; the point of "0.7" does not end one.
std::string first_clause(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((text[i] == '.' || text[i] == ':' || text[i] == ';') &&
        (i + 1 == text.size() || text[i + 1] == ' ' || text[i + 1] == '\n'))
      return text.substr(0, i);
  return text;
}

int list(const std::string& kind) {
  const Registry& registry = Registry::instance();
  const auto families = registry.families();
  if (!kind.empty() && std::find(families.begin(), families.end(), kind) == families.end())
    throw Error(fmt::format("there is no kind \"{}\"{}; kinds: {}", kind, did_you_mean(kind, families),
                            fmt::join(families, ", ")));
  for (const auto& family : families) {
    if (!kind.empty() && family != kind) continue;
    fmt::print("{}\n", family);
    for (const auto& name : registry.names(family)) {
      const std::string& summary = registry.find(family, name)->doc.summary;
      fmt::print("  {:<22} {}\n", name, first_clause(summary));
    }
  }
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto kind = std::make_shared<std::string>();
  options.add("kind", *kind, "family of plug-ins: bsdf, emitter, film, ...");
  return [=] { return list(*kind); };
}

AUREOLE_COMMAND("list", "List the plug-ins of one family or of all", declare);

}  // namespace
}  // namespace aureole
