// SPDX-License-Identifier: Apache-2.0
#include "aureole/sampler/sampler.h"

#include "aureole/core/random.h"

namespace aureole {

void Sampler::read_common(const Properties& properties) {
  sample_count_ = properties.get_int("sample_count", 4, {1, 4294967295.0});
  seed_ = std::uint64_t(properties.get_int("seed", 0, Range::non_negative()));
}

std::uint32_t SampleStream::key(int dimension) const {
  return std::uint32_t(combine_bits(combine_bits(pixel_key_, sample_), std::uint64_t(dimension)) >> 32);
}

}  // namespace aureole
