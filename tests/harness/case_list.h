// SPDX-License-Identifier: Apache-2.0
// The cases that a harness checks: the examples of all plug-ins of a family, adapted by what tests say of a
// plug-in, and the further cases that they add.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole::testing {

template <class Case>
class CaseList {
public:
  static CaseList& instance() {
    static CaseList list;
    return list;
  }
  void add(std::string plugin, std::function<void(Case&)> adapt, std::vector<Case> extra) {
    entries_.push_back({std::move(plugin), std::move(adapt), std::move(extra)});
  }
  /// `make` returns the case of that name for the XML of an example.
  template <class Make>
  std::vector<Case> all(const std::string& family, Make&& make) const {
    std::vector<Case> cases;
    for (const std::string& plugin : Registry::instance().names(family)) {
      const auto& examples = Registry::instance().find(family, plugin)->doc.examples;
      for (std::size_t i = 0; i < examples.size(); ++i) {
        Case c = make(plugin + "_example_" + std::to_string(i + 1), examples[i]);
        for (const Entry& e : entries_)
          if (e.plugin == plugin && e.adapt) e.adapt(c);
        cases.push_back(std::move(c));
      }
      for (const Entry& e : entries_)
        if (e.plugin == plugin) cases.insert(cases.end(), e.extra.begin(), e.extra.end());
    }
    return cases;
  }

private:
  struct Entry {
    std::string plugin;
    std::function<void(Case&)> adapt;
    std::vector<Case> extra;
  };
  std::vector<Entry> entries_;
};

}  // namespace aureole::testing
