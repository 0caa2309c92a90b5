// SPDX-License-Identifier: Apache-2.0
#include "harness/phase_harness.h"

#include "aureole/plugin/registry.h"

namespace aureole::testing {

namespace {

struct Entry {
  std::string plugin;
  std::function<void(PhaseCase&)> adapt;
  std::vector<PhaseCase> extra;
};
std::vector<Entry>& entries() {
  static std::vector<Entry> all;
  return all;
}

}  // namespace

PhaseCase::PhaseCase(std::string a_name, std::string an_xml)
    : name(std::move(a_name)), xml(std::move(an_xml)) {
  min_nm = 360, max_nm = 830;
  samples = 100000;
}

PhaseCases::PhaseCases(std::string plugin, std::function<void(PhaseCase&)> adapt,
                       std::vector<PhaseCase> extra) {
  entries().push_back({std::move(plugin), std::move(adapt), std::move(extra)});
}

void has_peaks(PhaseCase& c, double angle) {
  c.focus = [](const Vec3& wi) { return std::vector<Vec3>{-wi, wi}; };
  c.focus_angle = angle;
}

std::vector<PhaseCase> all_phase_cases() {
  std::vector<PhaseCase> cases;
  for (const std::string& plugin : Registry::instance().names("phase")) {
    const auto& examples = Registry::instance().find("phase", plugin)->doc.examples;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      PhaseCase c(plugin + "_example_" + std::to_string(i + 1), examples[i]);
      for (const Entry& e : entries())
        if (e.plugin == plugin && e.adapt) e.adapt(c);
      cases.push_back(std::move(c));
    }
    for (const Entry& e : entries())
      if (e.plugin == plugin) cases.insert(cases.end(), e.extra.begin(), e.extra.end());
  }
  return cases;
}

}  // namespace aureole::testing
