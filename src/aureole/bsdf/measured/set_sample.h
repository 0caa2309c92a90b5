// SPDX-License-Identifier: Apache-2.0
// The last step of `sample` of BSDFs that sample directions from a table.
#pragma once

#include <optional>

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// Fills `result` with the direction `wo` and the value and pdf of the BSDF's `eval_pdf`, or leaves it empty
/// where the pdf is zero.
template <class B>
void set_sample(const B& bsdf, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx, Lobe lobe,
                std::optional<BsdfSample>& result) {
  const BsdfEval e = bsdf.eval_pdf(wi, wo, ctx);
  if (!(e.pdf[0] > 0)) return;
  BsdfSample& s = result.emplace();
  s.wo = wo, s.value = e.value, s.pdf = e.pdf, s.lobe = lobe;
}

}  // namespace aureole
