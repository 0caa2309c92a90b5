// SPDX-License-Identifier: Apache-2.0
// The sky model's values at its 11 wavelengths, each tabulated over one variable, so that a look-up needs no
// exponential.
#pragma once

#include <algorithm>
#include <vector>

#include "aureole/optics/sky/sky_model.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// One value per channel of the model, padded to whole vectors.
struct Channels {
  float v[12] = {};
};

/// A function on [0, 1] for all channels at once, tabulated.
class ChannelTable {
public:
  template <class F>  // `f` is double(channel, x)
  ChannelTable(int cells, F&& f) : rows_(std::size_t(cells) + 1) {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t c = 0; c < optics::SkyModel::kChannels; ++c)
        rows_[i].v[c] = float(f(c, double(i) / cells));
  }
  Channels at(float x) const {
    const float p = std::clamp(x, 0.f, 1.f) * float(rows_.size() - 1);
    const std::size_t i = std::min(std::size_t(p), rows_.size() - 2);
    const float t = p - float(i);
    Channels r;
    for (int c = 0; c < 12; ++c) r.v[c] = rows_[i].v[c] + (rows_[i + 1].v[c] - rows_[i].v[c]) * t;
    return r;
  }

private:
  std::vector<Channels> rows_;
};

/// Interpolates linearly between the channels; zero outside their range.
inline Spectrum at_wavelengths(const Channels& c, const Wavelengths& w) {
  constexpr int kLast = optics::SkyModel::kChannels - 1;
  return make_spectrum([&](int j) {
    const float p = (w.nm[j] - float(optics::SkyModel::wavelength_nm(0))) / 40;
    if (!(p >= 0 && p <= float(kLast))) return 0.f;
    const int i = std::min(int(p), kLast - 1);
    return c.v[i] + (c.v[i + 1] - c.v[i]) * (p - float(i));
  });
}

}  // namespace aureole
