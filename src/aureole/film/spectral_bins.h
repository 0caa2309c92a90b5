// SPDX-License-Identifier: Apache-2.0
// Contiguous wavelength bins, and the names of their channels in OpenEXR.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

class SpectralBins {
public:
  SpectralBins() = default;
  /// Makes bins between increasing edges [nm], at least two. Throws Error where a bin is too narrow for a
  /// float wavelength.
  explicit SpectralBins(std::vector<double> edges) : edges_(std::move(edges)) {
    for (std::size_t i = 0; i + 1 < edges_.size(); ++i)
      if (!(edges_[i] > 0) || !(edges_[i + 1] - edges_[i] > 1e-5 * edges_[i]))
        throw Error(
            fmt::format("bins must have positive, increasing edges, at least a 100000th of the wavelength "
                        "apart: {:g} and {:g} nm",
                        edges_[i], edges_[i + 1]));
    const double span = edges_.back() - edges_.front();
    guide_.resize(4 * std::size_t(count()));
    per_nm_ = float(double(guide_.size()) / span);
    for (std::size_t g = 0, bin = 0; g < guide_.size(); ++g) {
      const double start = edges_.front() + span * double(g) / double(guide_.size());
      while (bin + 1 < std::size_t(count()) && edges_[bin + 1] <= start) ++bin;
      guide_[g] = int(bin);
    }
    floats_.assign(edges_.begin(), edges_.end());
  }
  static SpectralBins equal(double min_nm, double max_nm, int count) {
    std::vector<double> edges;
    for (int i = 0; i <= count; ++i) edges.push_back(min_nm + (max_nm - min_nm) * i / count);
    return SpectralBins(std::move(edges));
  }

  int count() const { return int(edges_.size()) - 1; }
  double lower(int bin) const { return edges_[std::size_t(bin)]; }
  double upper(int bin) const { return edges_[std::size_t(bin) + 1]; }
  double width(int bin) const { return upper(bin) - lower(bin); }

  /// Returns the index of the bin that contains a wavelength, or -1. A table gives a first guess, a bin that
  /// begins slightly below the wavelength.
  int find(float nm) const {
    if (!(nm >= floats_.front() && nm <= floats_.back())) return -1;
    const auto g = std::min(std::size_t((nm - floats_.front()) * per_nm_), guide_.size() - 1);
    int bin = guide_[g];
    if (bin > 0 && nm < floats_[std::size_t(bin)]) --bin;  // the product was rounded up across the edge
    while (bin + 1 < count() && nm >= floats_[std::size_t(bin) + 1]) ++bin;
    return bin;
  }

  /// Returns names such as "S0.550,00nm": the unpolarised radiance at the centre of each bin (Fichet,
  /// Pacanowski & Wilkie 2021, "An OpenEXR layout for spectral images"), with enough digits to distinguish
  /// the bins.
  std::vector<std::string> channel_names() const {
    for (int digits = 2;; ++digits) {
      std::vector<std::string> names;
      for (int i = 0; i < count(); ++i) {
        names.push_back(fmt::format("S0.{:.{}f}nm", 0.5 * (lower(i) + upper(i)), digits));
        std::replace(names.back().begin() + 3, names.back().end(), '.', ',');
      }
      if (std::set(names.begin(), names.end()).size() == names.size()) return names;
    }
  }

private:
  std::vector<double> edges_;
  std::vector<float> floats_;
  std::vector<int> guide_;  ///< the bin at the start of each of equal intervals of the whole range
  float per_nm_ = 0;        ///< number of intervals per nm
};

}  // namespace aureole
