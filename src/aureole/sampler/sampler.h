// SPDX-License-Identifier: Apache-2.0
// The sampler family: points in [0, 1)^d, indexed by pixel, sample and dimension, independent of the total
// number of samples.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aureole/core/random.h"
#include "aureole/math/vec.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The error whose sum of squares over the pixels is minimised by adaptive sampling. `absolute`: the
/// difference itself; `display`: the difference divided by the square root of the pixel's brightness,
/// approximately as perceived on a display; `relative`: the difference divided by the brightness. A tenth of
/// the picture's mean is added to the brightness, so that black pixels do not dominate. `none`: all pixels
/// have equally many samples.
enum class AdaptiveTarget { none, absolute, display, relative };
/// The targets' names, in order.
const std::vector<std::string>& adaptive_target_names();
/// Returns the target of that name; throws Error for an unknown name.
AdaptiveTarget adaptive_target(const std::string& name);
std::string name_of(AdaptiveTarget error);

class Sampler : public Object {
public:
  static constexpr const char* kFamily = "a sampler";
  static constexpr int kBlock = 8;  ///< number of dimensions that are computed together
  using Object::Object;

  /// Computes the 8 coordinates `8 block ... 8 block + 7` of a sample. `pixel_key` is random per seed and
  /// pixel.
  virtual void block(std::uint64_t pixel_key, std::uint32_t sample, int block, float out[kBlock]) const = 0;

  std::int64_t sample_count() const { return sample_count_; }
  std::uint64_t seed() const { return seed_; }
  AdaptiveTarget adaptive() const { return adaptive_; }

protected:
  void read_common(const Properties& properties);

private:
  std::int64_t sample_count_ = 4;
  std::uint64_t seed_ = 0;
  AdaptiveTarget adaptive_ = AdaptiveTarget::none;
};

/// The coordinates of one sample of one pixel, by dimension. It caches the blocks of dimensions used last.
class SampleStream {
public:
  SampleStream() = default;
  SampleStream(const Sampler& sampler, std::uint64_t pixel_key, std::uint32_t sample)
      : sampler_(&sampler), pixel_key_(pixel_key), sample_(sample) {}

  /// The stream of a second path of this sample, with the same dimensions: the light path of a bidirectional
  /// method.
  SampleStream of_second_path() const {
    SampleStream s(*sampler_, mix_bits(pixel_key_), sample_);
    s.first_ = first_;
    return s;
  }

  /// Sets the number of dimensions that the camera uses; later dimension numbers count from there.
  void set_first(int dimension) { first_ = dimension; }

  float get1(int dimension) { return *values_from(dimension); }
  Vec2 get2(int dimension) {
    const float x = get1(dimension);
    return {x, get1(dimension + 1)};
  }
  /// The two pairs of `direction(vertex, ...)`, valid until the pairs of another vertex are requested.
  /// Requires the offset of `set_first` to be the camera's dimensions.
  const float* directions(int vertex) { return values_from(direction(vertex, 0)); }

  // The order of dimensions was chosen by measurement (docs/performance.md). The first block of 8 contains
  // the film position, the set of wavelengths, the directions of the first vertex (or the lens), and last the
  // hero wavelength.
  static constexpr int kFilm = 0, kWavelengthSet = 2, kLens = 3, kTime = 5, kHero = 7;
  /// `further`: the camera uses the lens or the time.
  static constexpr int camera_dimensions(bool further) { return further ? 11 : 3; }

  // A vertex of a path needs two pairs for directions, which profit from low dimensions, and up to four
  // single numbers for choices, many of which are never used. So choices have separate dimensions.
  static constexpr int kChoices = 128;  ///< first dimension of choices; both repeat after twice as many
  static constexpr int kVertices = 28;  ///< number of vertices before dimensions repeat
  /// Dimensions follow the camera's; vertices from the second on start at a block or half a block.
  static constexpr int direction(int vertex, int pair) {
    const int round = vertex < kVertices ? 0 : vertex / kVertices, v = vertex - round * kVertices;
    return round * 2 * kChoices + 4 * v + (v > 0) + 2 * pair;
  }
  static constexpr int choice(int vertex, int k) {
    return vertex / kVertices * 2 * kChoices + kChoices + 1 + vertex % kVertices * 4 + k;
  }
  /// Returns a random key for stochastic models, a function of (pixel, sample, dimension).
  std::uint32_t key(int dimension) const {
    std::uint32_t x =
        std::uint32_t(pixel_key_) + 0x9e3779b9u * sample_ + 0x85ebca6bu * std::uint32_t(dimension);
    x = (x ^ (x >> 16) ^ std::uint32_t(pixel_key_ >> 32)) * 0x21f0aaadu;
    x = (x ^ (x >> 15)) * 0xd35a2d97u;
    return x ^ (x >> 15);
  }

  /// Random bits for a dimension of a pixel, the same for all of its samples.
  std::uint32_t pixel_bits(int dimension) const {
    return std::uint32_t(mix_bits(pixel_key_ + 0x9e3779b97f4a7c15u * std::uint64_t(dimension + 1)) >> 32);
  }
  /// A number in [0, 1) that is spread evenly over the samples of a pixel: van der Corput's sequence (1935), shifted modulo 1 by
  /// `shift` / 2^32.
  float spread(std::uint32_t shift) const {
    std::uint32_t x = __builtin_bswap32(sample_);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    return unit_float(x + shift);
  }

private:
  /// The values of a dimension and of those after it in its block.
  const float* values_from(int dimension) {
    const unsigned d = unsigned(dimension + first_), wanted = d / Sampler::kBlock;
    Slot& slot = slots_[d / kChoices & 1];
    if (int(wanted) != slot.block)
      sampler_->block(pixel_key_, sample_, slot.block = int(wanted), slot.values);
    return slot.values + d % Sampler::kBlock;
  }

  const Sampler* sampler_ = nullptr;
  std::uint64_t pixel_key_ = 0;
  std::uint32_t sample_ = 0;
  int first_ = 0;
  struct Slot {
    alignas(32) float values[Sampler::kBlock];
    int block = -1;
  };
  Slot slots_[2];  ///< cached blocks, one for directions and one for choices
};

}  // namespace aureole
