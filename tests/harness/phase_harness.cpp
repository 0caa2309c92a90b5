// SPDX-License-Identifier: Apache-2.0
#include "harness/phase_harness.h"

#include "harness/case_list.h"
#include "harness/effort.h"

namespace aureole::testing {

PhaseCase::PhaseCase(std::string a_name, std::string an_xml)
    : name(std::move(a_name)), xml(std::move(an_xml)) {
  min_nm = 360, max_nm = 830;
  samples = test::effort(40000, 100000);
}

PhaseCases::PhaseCases(std::string plugin, std::function<void(PhaseCase&)> adapt,
                       std::vector<PhaseCase> extra) {
  CaseList<PhaseCase>::instance().add(std::move(plugin), std::move(adapt), std::move(extra));
}

void has_peaks(PhaseCase& c, double angle) {
  c.focus = [](const Vec3& wi) { return std::vector<Vec3>{-wi, wi}; };
  c.focus_angle = angle;
}

std::vector<PhaseCase> all_phase_cases() {
  return CaseList<PhaseCase>::instance().all(
      "phase", [](std::string name, std::string xml) { return PhaseCase(std::move(name), std::move(xml)); });
}

}  // namespace aureole::testing
