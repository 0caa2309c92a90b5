// SPDX-License-Identifier: Apache-2.0
#include "aureole/sampler/sampler.h"

#include <fmt/format.h>

#include <algorithm>

#include "aureole/core/error.h"
#include "aureole/plugin/registry.h"

namespace aureole {

const std::vector<std::string>& adaptive_target_names() {
  static const std::vector<std::string> names{"none", "absolute", "display", "relative"};
  return names;
}

AdaptiveTarget adaptive_target(const std::string& name) {
  const auto& names = adaptive_target_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw Error(fmt::format("adaptive: expected one of {}, got \"{}\"", fmt::join(names, ", "), name));
  return AdaptiveTarget(found - names.begin());
}

std::string name_of(AdaptiveTarget error) { return adaptive_target_names()[size_t(error)]; }

void Sampler::read_common(const Properties& properties) {
  sample_count_ = properties.get_int("sample_count", 4, {1, 4294967295.0});
  seed_ = std::uint64_t(properties.get_int("seed", 0, Range::non_negative()));
  adaptive_ = adaptive_target(properties.get_choice("adaptive", "none", adaptive_target_names()));
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "sampler",
    .fallback = "sobol",
    .parameters =
        {{"sample_count", "integer", "", "4", "samples per pixel"},
         {"seed", "integer", "", "0", "selects an independent set of samples"},
         {"adaptive", "string", "", "none",
          "none; absolute, display or relative: noisy pixels get more samples, each half to 4 times "
          "`sample_count`, which is the upper bound of their average. This minimises the squared errors of "
          "the picture in units of 1, of the square root of the brightness (as perceived on a display) or of "
          "the brightness. The noise is estimated from the first 8 samples of all pixels. No effect with "
          "fewer than 16 samples per pixel"}},
    .parameters_are_of_render = true});

}  // namespace aureole
