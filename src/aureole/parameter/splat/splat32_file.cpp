// SPDX-License-Identifier: Apache-2.0
// Files `.splat` of 32 bytes per splat (A. Kwok, antimatter15/splat): position and scale as three float32 each, red,
// green, blue and opacity as bytes that represent [0, 1], and the rotation w, x, y, z as bytes (q 128 + 128).
#include <fmt/format.h>

#include "aureole/core/parallel.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole::splat_reader {

SplatCloud read_splat32(const Path&, const SharedBytes& bytes, const SplatFileOptions&) {
  constexpr std::size_t kBytes = 32;
  if (bytes.size() == 0 || bytes.size() % kBytes != 0)
    throw Error(fmt::format("has {} bytes; a file .splat has {} for each splat, and one splat at least",
                            bytes.size(), kBytes));
  const std::size_t count = bytes.size() / kBytes;
  if (count > kMaxSplats) throw Error(fmt::format("has {} splats; {} are possible", count, kMaxSplats));
  SplatCloud c;
  c.format = ".splat", c.axes = "RDF";
  c.resize(count, 0);
  for_ranges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::byte* at = bytes.bytes.data() + kBytes * i;
      for (int k = 0; k < 3; ++k) {
        c.positions[i][k] = load<float>(at + 4 * k), c.scales[i][k] = load<float>(at + 12 + 4 * k);
        c.harmonics[3 * i + std::size_t(k)] = (float(at[24 + k]) / 255 - 0.5f) / kHarmonic0;
      }
      c.opacities[i] = float(at[27]) / 255;
      for (std::size_t k = 0; k < 4; ++k) c.rotations[i][k] = (float(at[28 + k]) - 128) / 128;
    }
  });
  return c;
}

}  // namespace aureole::splat_reader
