// SPDX-License-Identifier: Apache-2.0
// Distributions of the radii of particles. aureole/_sizes.py checks the arguments and shapes the results.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <tuple>
#include <vector>

#include "aureole/optics/particle/radius_distribution.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::RadiusDistribution;

RadiusDistribution make(const std::string& kind, double radius, double first, double second, bool by_volume) {
  if (kind == "gamma") return RadiusDistribution::gamma(radius, first);
  if (kind == "modified_gamma") return RadiusDistribution::modified_gamma(radius, first, second);
  return log_normal_radii(radius, first, by_volume);
}

/// Radii, their weights, and effective radius, effective variance, mean area and mean volume.
std::tuple<std::vector<double>, std::vector<double>, std::vector<double>> sizes(const std::string& kind,
                                                                                double radius, double first,
                                                                                double second, bool by_volume,
                                                                                double steps) {
  return naming("radius", [&] {
    constexpr std::size_t kMaxNodes = 100000;
    const RadiusDistribution d = make(kind, radius, first, second, by_volume);
    std::vector<double> radii, weights;
    for (const optics::RadiusNode& node : d.nodes(0, steps, kMaxNodes))
      radii.push_back(node.radius), weights.push_back(node.weight);
    return std::tuple(
        std::move(radii), std::move(weights),
        std::vector<double>{d.effective_radius(), d.effective_variance(), d.mean_area(), d.mean_volume()});
  });
}

}  // namespace

RadiusDistribution log_normal_radii(double median, double spread, bool by_volume) {
  if (spread == 0) return RadiusDistribution::monodisperse(median);
  return RadiusDistribution::log_normal(
      median, spread, by_volume ? optics::SizeWeighting::volume : optics::SizeWeighting::number);
}

void bind_sizes(nb::module_& m) {
  using nb::arg;
  m.def("size_distribution", &sizes, arg("kind"), arg("radius"), arg("first"), arg("second"),
        arg("by_volume"), arg("steps"));
}

}  // namespace aureole::python
