// SPDX-License-Identifier: Apache-2.0
#include "aureole/sampler/sampler.h"

namespace aureole {

void Sampler::read_common(const Properties& properties) {
  sample_count_ = properties.get_int("sample_count", 4, {1, 4294967295.0});
  seed_ = std::uint64_t(properties.get_int("seed", 0, Range::non_negative()));
}

}  // namespace aureole
