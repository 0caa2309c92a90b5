// SPDX-License-Identifier: Apache-2.0
// `PythonBsdf`: a BSDF that is a class written in Python.
#pragma once

#include <nanobind/nanobind.h>

#include "aureole/bsdf/bsdf.h"

namespace aureole::python {

namespace nb = nanobind;

class PythonBsdf final : public Bsdf {
public:
  /// `adapter` is an aureole._python_bsdf.Adapter, which checks what the class returns.
  PythonBsdf(const Properties& properties, nb::object adapter);
  ~PythonBsdf() override;

  const nb::object& instance() const { return adapter_; }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override;
  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override;
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override;
  Lobe lobes() const override { return lobes_; }
  bool needs_choice() const override { return true; }
  bool needs_tangent() const override { return needs_tangent_; }

private:
  nb::object adapter_;
  Lobe lobes_;
  bool needs_tangent_;
};

}  // namespace aureole::python
