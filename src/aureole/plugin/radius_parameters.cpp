// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/radius_parameters.h"

#include <stdexcept>
#include <string>

namespace aureole {

namespace {

/// Throws an Error if a parameter is given that the distribution does not use.
void refuse(const Properties& p, const std::string& distribution, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (p.has(name)) throw p.error(name, "has no meaning for the distribution \"" + distribution + "\"");
}

}  // namespace

optics::RadiusDistribution read_radii(const Properties& p) {
  using optics::RadiusDistribution;
  using optics::SizeWeighting;
  if (!p.has("radius"))
    throw p.error("radius", "the parameter \"radius\" is required, a length such as \"5um\"");
  const double radius = p.get_length_m("radius", 0);
  const std::string distribution =
      p.get_choice("distribution", "log_normal", {"log_normal", "gamma", "modified_gamma"});
  if (distribution == "gamma") {
    refuse(p, distribution, {"size_spread", "weighting", "alpha", "gamma"});
    const double variance = p.get_float("effective_variance", 0.1, Range{0, 0.49, true});
    return RadiusDistribution::gamma(radius, variance);
  }
  if (distribution == "modified_gamma") {
    refuse(p, distribution, {"size_spread", "weighting", "effective_variance"});
    return RadiusDistribution::modified_gamma(radius, p.get_float("alpha", 6, Range{0, 100, true}),
                                              p.get_float("gamma", 1, Range{0, 20, true}));
  }
  refuse(p, distribution, {"effective_variance", "alpha", "gamma"});
  const double spread = p.get_float("size_spread", 0, Range{0, 1.5});
  const bool by_volume = p.get_choice("weighting", "number", {"number", "volume"}) == "volume";
  if (spread == 0) return RadiusDistribution::monodisperse(radius);
  return RadiusDistribution::log_normal(radius, spread,
                                        by_volume ? SizeWeighting::volume : SizeWeighting::number);
}

std::vector<ParameterDoc> radius_docs() {
  return {
      {"radius", "length", "", "required",
       "radius of the spheres, such as 5um. log_normal: the median; gamma: the effective radius <r^3>/<r^2>; "
       "modified_gamma: the mode"},
      {"distribution", "string", "", "log_normal",
       "distribution of the radii: log_normal, gamma (Hansen 1971) or modified_gamma (Deirmendjian 1969)"},
      {"size_spread", "float", "", "0",
       "log_normal: standard deviation of ln(radius), up to 1.5; 0: one radius"},
      {"weighting", "string", "", "number",
       "log_normal: number or volume: the quantity whose distribution over the radius is log-normal"},
      {"effective_variance", "float", "", "0.1", "gamma: effective variance, below 0.5"},
      {"alpha", "float", "", "6", "modified_gamma: the number grows as radius^alpha at small radii"},
      {"gamma", "float", "", "1",
       "modified_gamma: the number falls as exp(-(alpha/gamma) (radius/mode)^gamma) at large radii"}};
}

}  // namespace aureole
