// SPDX-License-Identifier: Apache-2.0
// Applies the checks of scattering functions (scattering_check.h) to a BSDF.
#pragma once

#include <optional>
#include <span>

#include "aureole/bsdf/bsdf.h"
#include "aureole/instrument/check/check_options.h"
#include "aureole/instrument/check/check_result.h"

namespace aureole {

/// Array interface of a BSDF with expensive calls, such as one written in another language. A class derives
/// from `Bsdf` and from this; `check_bsdf` then calls these methods.
class ArrayBsdf {
public:
  virtual ~ArrayBsdf() = default;
  /// Sets found[i] = eval_pdf(wi[i], wo[i], ctx).
  virtual void eval_pdf_all(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                            std::span<BsdfEval> found) const = 0;
  /// Sets found[i] = sample(wi[i], u1[i], u2[i], ctx).
  virtual void sample_all(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                          const BsdfContext& ctx, std::span<std::optional<BsdfSample>> found) const = 0;
};

/// Throws Error if the options are invalid for the BSDF, and passes on exceptions of `progress`.
CheckResult check_bsdf(const Bsdf& bsdf, const CheckOptions& options);

}  // namespace aureole
