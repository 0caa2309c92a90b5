// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/picture/picture_comparison.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {

namespace {

Verdict verdict_of(const Comparison& c) {
  if (c.not_finite > 0) return Verdict::not_finite;
  if (c.max == 0) return Verdict::identical;
  if (!c.z) return Verdict::untested;
  if (c.z->has_too_few_replicates()) return Verdict::too_few_replicates;
  if (c.z->shares_noise()) return Verdict::shares_random_numbers;
  return c.z->passes ? Verdict::within_noise : Verdict::different;
}

}  // namespace

std::string verdict_text(Verdict verdict, const Comparison& comparison) {
  switch (verdict) {
    case Verdict::identical:
      return "identical";
    case Verdict::within_noise:
      return "the same within noise";
    case Verdict::different:
      return "DIFFERENT";
    case Verdict::not_finite:
      return "DIFFERENT: " + std::to_string(comparison.not_finite) + " values are NaN or infinite";
    case Verdict::untested:
      return "";
    case Verdict::too_few_replicates:
      return "UNDECIDED: the variances are those of too few replicates: render with --replicates 4 or more";
    case Verdict::shares_random_numbers:
      return "UNDECIDED: they differ by much less than their noise, so that they share random numbers, or "
             "one has the samples of the other. Render one of them with another seed of its sampler";
  }
  return "";
}

bool is_same(Verdict verdict) {
  return verdict == Verdict::identical || verdict == Verdict::within_noise || verdict == Verdict::untested;
}

bool PictureComparison::is_same() const {
  return std::all_of(layers.begin(), layers.end(),
                     [](const LayerComparison& l) { return aureole::is_same(l.verdict); });
}

Comparison PictureComparison::z_map() const {
  Comparison all;
  for (const LayerComparison& l : layers) {
    const Image& map = l.comparison.z_map;
    if (!l.comparison.z) continue;
    if (all.z_map.pixels.empty())
      all.z_map = map;
    else
      for (std::size_t i = 0; i < map.pixels.size(); ++i)
        if (std::abs(map.pixels[i]) > std::abs(all.z_map.pixels[i])) all.z_map.pixels[i] = map.pixels[i];
  }
  return all;
}

int replicates_of(const ExrAttributes& attributes) {
  const auto found = attributes.integers.find("aureole:replicates");
  return found == attributes.integers.end() ? 0 : found->second;
}

PictureComparison compare_pictures(const Image& a, const Image& b, Replicates replicates) {
  const std::vector<std::string> layers = common_layers(a, b);
  if (layers.empty()) throw Error("the pictures have no colour channel in common");
  PictureComparison result;
  for (const std::string& layer : layers) {
    LayerComparison& found = result.layers.emplace_back();
    found.layer = layer;
    found.comparison = compare_images(layer_of(a, layer), layer_of(b, layer), kStorageRounding, replicates);
    found.verdict = verdict_of(found.comparison);
  }
  return result;
}

}  // namespace aureole
