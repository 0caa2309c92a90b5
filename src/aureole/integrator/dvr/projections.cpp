// SPDX-License-Identifier: Apache-2.0
// Pictures of `dvr` that are not composited of steps: the largest and the mean number of a ray, and isosurfaces.
#include <algorithm>
#include <cmath>

#include "aureole/integrator/dvr/cell_roots.h"
#include "aureole/integrator/dvr/march.h"

namespace aureole {

VolumeResult VolumeMarch::project() {
  VolumeResult result;
  const Part& part = parts_.front();
  const ScalarField& field = part.medium->field();
  float length = settings_.step;
  const int count = divide_into_steps(part.end - part.begin, length);
  const float offset = phase_;
  const bool is_mip = settings_.method == DvrSettings::Method::mip;
  result.value = is_mip ? -kInfinity : 0;
  double sum = 0;
  result.lookups = float(count);
  for (int k = 0; k < count; ++k) {
    const float a = part.begin + float(k) * length,
                b = k + 1 == count ? part.end : std::min(part.begin + float(k + 1) * length, part.end);
    const float t = a + offset * (b - a), value = field.value(at(t));
    sum += double(value) * double(b - a);
    if (is_mip && value > result.value) result.value = value, result.depth = t;
  }
  if (!is_mip)
    result.value = float(sum / double(part.end - part.begin)), result.depth = 0.5f * (part.begin + part.end);
  const Sample s = part.medium->classify(at(result.depth), result.value);
  result.depth += shift_;
  result.optical_thickness = s.extinction * part.medium->unit();
  cover(result, basis_.eval(s.color) * d65_ * part.medium->emission_scale(),
        -std::expm1(-result.optical_thickness));
  return result;
}

VolumeResult VolumeMarch::isosurfaces() {
  VolumeResult result;
  std::vector<CellRoot> roots;
  for (const Part& part : parts_) {
    float passed = 1;
    find_isosurfaces(part.medium->field(), ray_, part.begin, part.end, settings_.isovalues,
                     [&](const CellRoot& root) {
                       roots.push_back({root.t, root.value, part.medium});
                       const Sample s = part.medium->classification().surface(at(root.t), root.value);
                       passed *= 1 - part.medium->layer_opacity(s.extinction);
                       return passed > settings_.termination;
                     });
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [](const CellRoot& a, const CellRoot& b) { return a.t < b.t; });
  for (const CellRoot& root : roots) {
    const ClassifiedMedium& medium = *root.medium;
    const Sample sample = medium.classification().surface(at(root.t), root.value);
    cover(result, color_at(medium, at(root.t), sample), medium.layer_opacity(sample.extinction));
    result.optical_thickness += sample.extinction * medium.unit();
    if (result.depth == 0) result.depth = shift_ + root.t, result.value = root.value;
    if (result.transmittance < settings_.termination) {
      result.transmittance = 0;
      break;
    }
  }
  return result;
}

}  // namespace aureole
