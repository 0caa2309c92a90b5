// SPDX-License-Identifier: Apache-2.0
// Figures of the laboratory: what traced instruments read.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace aureole {

struct LaboratoryCurves {
  std::string svg, caption;
};

/// A Lambertian base under a smooth coat, read in five geometries: traced values with their errors, and Saunderson's closed form.
LaboratoryCurves five_instruments(double base, double ior, std::int64_t paths, const std::atomic<bool>& stop);
/// The reflectance factor de:8 of a slab with the index of air over the diameter of the sample's port, of which 0.6, or 12 mm
/// at most, is viewed.
LaboratoryCurves edge_loss(const std::vector<double>& ports_mm, double scattering_per_mm, double thickness_mm,
                           std::int64_t paths, const std::atomic<bool>& stop);
/// Lobes of a GGX metal in the plane of incidence: readings with errors, and the model that was fitted to them.
LaboratoryCurves measured_lobes(double alpha, const std::vector<double>& incident, std::int64_t paths,
                                const std::atomic<bool>& stop);

}  // namespace aureole
