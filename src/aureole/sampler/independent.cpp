// SPDX-License-Identifier: Apache-2.0
// Independent uniform random numbers, counter-based. The hash may change, but not its statistics.
#include "aureole/core/random.h"
#include "aureole/plugin/registry.h"
#include "aureole/sampler/sampler.h"

namespace aureole {
namespace {

class IndependentSampler final : public Sampler {
public:
  explicit IndependentSampler(const Properties& p) : Sampler(p) { read_common(p); }

  void block(std::uint64_t pixel_key, std::uint32_t sample, int block, float out[kBlock]) const override {
    const std::uint64_t key = combine_bits(pixel_key, sample);
    for (int i = 0; i < kBlock; i += 2) {
      const std::uint64_t bits = combine_bits(key, std::uint64_t(block) * kBlock + std::uint64_t(i));
      out[i] = unit_float(std::uint32_t(bits));
      out[i + 1] = unit_float(std::uint32_t(bits >> 32));
    }
  }
};

AUREOLE_PLUGIN(
    IndependentSampler, "sampler", "independent",
    PluginDoc{
        .summary = "Independent uniform random numbers. `sobol` converges faster on almost every scene.",
        .source = "",
        .parameters = {},
        .examples =
            {R"(<sampler type="independent"><integer name="sample_count" value="64"/><integer name="seed" value="1"/>
    <string name="adaptive" value="display"/></sampler>)"},
        .advice = "the scene asks for independent samples; --sampler sobol usually converges faster"});

}  // namespace
}  // namespace aureole
