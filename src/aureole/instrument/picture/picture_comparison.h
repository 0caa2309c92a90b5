// SPDX-License-Identifier: Apache-2.0
// The difference of two pictures layer by layer, tested against their noise, with a verdict.
#pragma once

#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/render/statistics.h"

namespace aureole {

enum class Verdict {
  identical,
  within_noise,
  different,
  not_finite,            ///< different, since values are NaN or infinite
  untested,              ///< neither picture has variances
  too_few_replicates,    ///< undecided
  shares_random_numbers  ///< undecided: they differ by much less than their noise
};

/// The verdict in words, as `aureole compare` prints it. Empty for `untested`.
std::string verdict_text(Verdict verdict, const Comparison& comparison);
/// Whether the pictures are the same as far as is known: `identical`, `within_noise` or `untested`.
bool is_same(Verdict verdict);

struct LayerComparison {
  std::string layer;  ///< "" for R, G, B and Y without a dot
  Comparison comparison;
  Verdict verdict = Verdict::untested;
};

struct PictureComparison {
  std::vector<LayerComparison> layers;

  bool is_same() const;
  /// One channel: the z of largest magnitude of all layers, per pixel. Empty without variances.
  Comparison z_map() const;
};

/// Number of replicates from which the variances of a picture come, by the attributes of its file; 0 if they do not say.
int replicates_of(const ExrAttributes& attributes);

/// Throws Error if the sizes differ or no colour channel is common.
PictureComparison compare_pictures(const Image& a, const Image& b, Replicates replicates);

}  // namespace aureole
