// SPDX-License-Identifier: Apache-2.0
#include "harness/bsdf_harness.h"

#include <algorithm>
#include <sstream>

#include "harness/case_list.h"
#include "harness/check_report.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole::testing {

HarnessResult check_case(const BsdfCase& c, const HarnessOptions& harness) {
  CheckOptions options = c;
  options.reciprocal = c.not_reciprocal.empty();
  options.significance = harness.family_significance;
  options.family_size = harness.family_size;
  options.seed = harness.seed;
  options.samples = test::effort(std::min(options.samples, harness.most_samples), options.samples);
  options.bin_tolerance =
      test::effort(CheckOptions::bin_tolerance_for(harness.most_samples), options.bin_tolerance);
  const std::shared_ptr<const Bsdf> bsdf =
      c.bsdf ? c.bsdf : build<Bsdf>(c.xml, make_context(c.min_nm, c.max_nm), test::example_file);
  HarnessResult result;
  result.check = check_bsdf(*bsdf, options);
  result.failures = report(c.name, result.check, harness.dump_folder);
  if (!c.gains_energy.empty() && !(result.check.largest_energy > 1 + c.tolerance)) {
    std::ostringstream text;
    text << c.name << ": is said to gain energy (" << c.gains_energy << "), but reflects "
         << result.check.largest_energy << " at most";
    result.failures.push_back(text.str());
  }
  return result;
}

BsdfCases::BsdfCases(std::string plugin, std::function<void(BsdfCase&)> adapt, std::vector<BsdfCase> extra) {
  CaseList<BsdfCase>::instance().add(std::move(plugin), std::move(adapt), std::move(extra));
}

std::vector<BsdfCase> with_samples(std::size_t samples, std::vector<BsdfCase> cases) {
  for (BsdfCase& c : cases) c.samples = samples;
  return cases;
}

std::vector<BsdfCase> all_bsdf_cases() {
  return CaseList<BsdfCase>::instance().all("bsdf", [](std::string name, std::string xml) {
    BsdfCase c;
    c.name = std::move(name);
    c.xml = std::move(xml);
    return c;
  });
}

}  // namespace aureole::testing
