// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/label_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "aureole/core/parallel.h"
#include "aureole/plugin/properties.h"

namespace aureole {

namespace {

ScalarField read_labels(const Properties& p, const char* name) {
  const auto volume = p.get_object<Volume>(name);
  if (!volume->to_box())
    throw p.error(name, "is constant in space; labels on a grid are needed, such as a \"gridvolume\"");
  if (volume->channels() > 1)
    throw p.error(name, fmt::format("has {} numbers at each point; one label is needed", volume->channels()));
  if (volume->has_colors()) throw p.error(name, "holds colours; one label at each point is needed");
  const Properties& of = volume->properties();
  if (of.has("filter_type") && of.get_string("filter_type") != "nearest")
    throw of.error("filter_type", "has no effect here: labels are not interpolated");
  if (of.has("wrap_mode") && of.get_string("wrap_mode") != "clamp")
    throw of.error("wrap_mode", "has no effect here: outside of its box a mask has the label 0");
  return ScalarField(*volume);
}

}  // namespace

LabelField::LabelField(const Properties& p, const char* name, std::vector<std::uint8_t> class_of)
    : field_(read_labels(p, name)), class_of_(std::move(class_of)), counts_(std::size_t(kMaxLabel) + 1) {
  const std::array<int, 3>& size = field_.size();
  std::mutex mutex;
  std::array<int, 3> first{size[2], 0, 0};  // index (z, y, x) of the first value that is no label
  float bad = 0;
  for_ranges(
      std::size_t(size[2]),
      [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> counts(counts_.size());
        for (std::size_t z = begin; z < end; ++z)
          for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) {
              const float v = field_.voxel(x, y, int(z));
              if (v >= 0 && v <= float(kMaxLabel) && v == std::floor(v)) {
                ++counts[std::size_t(v)];
                continue;
              }
              const std::lock_guard lock(mutex);
              if (const std::array here{int(z), y, x}; here < first) first = here, bad = v;
            }
        const std::lock_guard lock(mutex);
        for (std::size_t i = 0; i < counts.size(); ++i) counts_[i] += counts[i];
      },
      16);
  if (first[0] < size[2])
    throw p.error(
        name, fmt::format("holds {:g} at x = {}, y = {}, z = {}; labels are whole numbers from 0 to {}", bad,
                          first[2], first[1], first[0], kMaxLabel));
}

LabelField::Classes LabelField::classes_in(const Transform& from_box, const Vec3& lower,
                                           const Vec3& upper) const {
  Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 i = field_.index_of(from_box.point(
        {corner & 1 ? upper.x : lower.x, corner & 2 ? upper.y : lower.y, corner & 4 ? upper.z : lower.z}));
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], i[k]), high[k] = std::max(high[k], i[k]);
  }
  Classes classes;
  int first[3], last[3];
  for (int k = 0; k < 3; ++k) {
    const float n = float(field_.size()[std::size_t(k)]);
    constexpr float kRounding = 0.01f;
    const float a = std::floor(low[k] + 0.5f - kRounding), b = std::floor(high[k] + 0.5f + kRounding);
    if (a < 0 || b >= n) classes.set(class_of_[0]);
    first[k] = int(std::clamp(a, 0.f, n)), last[k] = int(std::clamp(b, -1.f, n - 1));
  }
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) classes.set(class_of_[std::size_t(field_.voxel(x, y, z))]);
  return classes;
}

}  // namespace aureole
