// SPDX-License-Identifier: Apache-2.0
// aureole docs: prints the reference of all plug-ins in Markdown, from their registrations.
#include <fmt/format.h>

#include "aureole/plugin/registry.h"
#include "command.h"

namespace aureole {
namespace {

std::string cell(std::string s) {
  for (size_t i = 0; (i = s.find('|', i)) != std::string::npos; i += 2) s.replace(i, 1, "\\|");
  return s;
}

int docs() {
  const Registry& registry = Registry::instance();
  fmt::print(
      "# Plug-in reference\n\nWritten by `aureole docs` from the registrations in the sources; not edited by "
      "hand.\n");
  for (const auto& family : registry.families()) {
    fmt::print("\n## {}\n", family);
    for (const auto& name : registry.names(family)) {
      const PluginDoc& d = registry.find(family, name)->doc;
      fmt::print("\n### {} `{}`\n\n{}\n", family, name, d.summary);
      if (!d.source.empty()) fmt::print("\nSource: {}\n", d.source);
      if (!d.parameters.empty()) {
        fmt::print("\n| parameter | type | unit | default | meaning |\n|---|---|---|---|---|\n");
        for (const auto& p : d.parameters)
          fmt::print("| `{}` | {} | {} | {} | {} |\n", p.name, cell(p.type), cell(p.unit), cell(p.fallback),
                     cell(p.meaning));
      }
      for (const auto& e : d.examples) fmt::print("\n```xml\n{}\n```\n", e);
    }
  }
  return 0;
}

std::function<int()> declare(CommandOptions&) {
  return [] { return docs(); };
}

AUREOLE_COMMAND("docs", "Print the plug-in reference in Markdown", declare);

}  // namespace
}  // namespace aureole
