// SPDX-License-Identifier: Apache-2.0
// The rules of scattering functions (scattering_check.h), applied to a BSDF.
#pragma once

#include <optional>
#include <span>

#include "aureole/bsdf/bsdf.h"
#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"

namespace aureole {

/// A BSDF that prefers to be asked about many directions at once, such as one written in another language,
/// where every call is dear. A class derives from `Bsdf` and from this; `check_bsdf` then uses these.
class ArrayBsdf {
public:
  virtual ~ArrayBsdf() = default;
  /// found[i] = eval_pdf(wi[i], wo[i], ctx).
  virtual void eval_pdf_all(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                            std::span<BsdfEval> found) const = 0;
  /// found[i] = sample(wi[i], u1[i], u2[i], ctx).
  virtual void sample_all(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                          const BsdfContext& ctx, std::span<std::optional<BsdfSample>> found) const = 0;
};

/// Throws Error where the options make no sense for the BSDF, and whatever `progress` throws.
CheckResult check_bsdf(const Bsdf& bsdf, const CheckOptions& options);

}  // namespace aureole
