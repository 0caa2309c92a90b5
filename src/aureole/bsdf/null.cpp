// SPDX-License-Identifier: Apache-2.0
// A null surface: the boundary of a medium, or an invisible shape.
#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Null final : public Bsdf {
public:
  using Bsdf::Bsdf;

  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2, const BsdfContext&) const override {
    return null_sample(wi, 1);
  }
  Spectrum null_transmittance(const Vec3&, const BsdfContext&) const override { return 1.f; }
  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return kNullLobe; }
};

AUREOLE_PLUGIN(Null, "bsdf", "null",
               PluginDoc{
                   "An invisible surface: light passes it unchanged. It is not a path vertex: it does not "
                   "count for `max_depth`, and light sampling passes through it.",
                   "",
                   {},
                   {R"(<bsdf type="null"/>)"}});

}  // namespace
}  // namespace aureole
