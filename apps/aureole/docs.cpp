// SPDX-License-Identifier: Apache-2.0
// aureole docs: prints the reference of all plug-ins in Markdown, from their registrations.
#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/plugin/registry.h"
#include "command.h"

namespace aureole {
namespace {

std::string cell(std::string s) {
  for (size_t i = 0; (i = s.find('|', i)) != std::string::npos; i += 2) s.replace(i, 1, "\\|");
  return s;
}

void print_plugin(const std::string& family, const std::string& name) {
  const PluginDoc& d = Registry::instance().find(family, name)->doc;
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

int docs(const std::string& wanted) {
  const Registry& registry = Registry::instance();
  if (wanted.empty())
    fmt::print(
        "# Plug-in reference\n\nWritten by `aureole docs` from the registrations in the sources; not edited by "
        "hand.\n");
  std::vector<std::string> all;
  bool found = false;
  for (const auto& family : registry.families()) {
    if (wanted.empty()) fmt::print("\n## {}\n", family);
    for (const auto& name : registry.names(family)) {
      all.push_back(name);
      if (!wanted.empty() && wanted != name && wanted != family) continue;
      print_plugin(family, name);
      found = true;
    }
  }
  if (!wanted.empty() && !found)
    throw Error("docs: there is no plug-in \"" + wanted + "\"" + did_you_mean(wanted, all) +
                "; `aureole list` lists them");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto name = std::make_shared<std::string>();
  options.add("name", *name, "a plug-in, such as diffuse, or a family, such as bsdf; all if left out");
  return [=] { return docs(*name); };
}

AUREOLE_COMMAND("docs", "Print the plug-in reference in Markdown", declare);

}  // namespace
}  // namespace aureole
