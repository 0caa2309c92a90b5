// SPDX-License-Identifier: Apache-2.0
// The sampler family: points in [0, 1)^d, indexed by pixel, sample and dimension, independent of the total
// number of samples.
#pragma once

#include <cstdint>

#include "aureole/math/vec.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class Sampler : public Object {
public:
  static constexpr const char* kFamily = "a sampler";
  static constexpr int kBlock = 8;  ///< dimensions computed together
  using Object::Object;

  /// The 8 coordinates `8 block ... 8 block + 7` of a sample. `pixel_key` is random per seed and pixel.
  virtual void block(std::uint64_t pixel_key, std::uint32_t sample, int block, float out[kBlock]) const = 0;

  std::int64_t sample_count() const { return sample_count_; }
  std::uint64_t seed() const { return seed_; }

protected:
  void read_common(const Properties& properties);

private:
  std::int64_t sample_count_ = 4;
  std::uint64_t seed_ = 0;
};

/// The coordinates of one sample of one pixel, by dimension. Holds the block of dimensions used last.
class SampleStream {
public:
  SampleStream(const Sampler& sampler, std::uint64_t pixel_key, std::uint32_t sample)
      : sampler_(&sampler), pixel_key_(pixel_key), sample_(sample) {}

  /// Dimensions are counted from here on: those before are the camera's.
  void set_first(int dimension) { first_ = dimension; }

  float get1(int dimension) {
    dimension += first_;
    const int wanted = dimension / Sampler::kBlock;
    if (wanted != block_) sampler_->block(pixel_key_, sample_, block_ = wanted, values_);
    return values_[dimension % Sampler::kBlock];
  }
  Vec2 get2(int dimension) {
    const float x = get1(dimension);
    return {x, get1(dimension + 1)};
  }
  /// A key for stochastic models, a function of (pixel, sample, dimension).
  std::uint32_t key(int dimension) const;

private:
  const Sampler* sampler_;
  std::uint64_t pixel_key_;
  std::uint32_t sample_;
  int block_ = -1, first_ = 0;
  alignas(32) float values_[Sampler::kBlock];
};

}  // namespace aureole
