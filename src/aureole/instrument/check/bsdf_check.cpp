// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/bsdf_check.h"

#include <memory>
#include <vector>

#include "aureole/instrument/check/scattering_check.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"

namespace aureole {

namespace {

std::shared_ptr<const Shape> make_square(const Properties& like) {
  const PluginInfo* plugin = Registry::instance().find("shape", "rectangle");
  const Properties properties("rectangle", "", {}, like.shared_context(), plugin);
  return std::dynamic_pointer_cast<const Shape>(plugin->create(properties));
}

/// A BSDF at a point of a square whose shading frame equals the world frame.
class BsdfFunction final : public ScatteringFunction {
public:
  BsdfFunction(const Bsdf& bsdf, const CheckOptions& options)
      : ScatteringFunction(grid_of(bsdf, options), options, "BSDF"),
        bsdf_(bsdf),
        arrays_(dynamic_cast<const ArrayBsdf*>(&bsdf)),
        shape_(make_square(bsdf.properties())) {
    point_.uv = {0.31f, 0.64f};
    point_.p = {2 * point_.uv.x - 1, 2 * point_.uv.y - 1, 0};
    point_.ng = {0, 0, 1};
    point_.shape = shape_.get();
  }

  bool is_on_surface() const override { return true; }
  Lobe lobes() const override { return bsdf_.lobes(); }

  void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                std::span<BsdfEval> found) const override {
    const BsdfContext ctx = context(query);
    if (arrays_) return arrays_->eval_pdf_all(wi, wo, ctx, found);
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = bsdf_.eval_pdf(wi[i], wo[i], ctx);
  }
  void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
            std::span<Spectrum> found) const override {
    if (arrays_) {
      std::vector<BsdfEval> both(wi.size());
      eval_pdf(wi, wo, query, both);
      for (std::size_t i = 0; i < wi.size(); ++i) found[i] = both[i].value;
      return;
    }
    const BsdfContext ctx = context(query);
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = bsdf_.eval(wi[i], wo[i], ctx);
  }
  void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2, CheckQuery query,
              std::span<std::optional<BsdfSample>> found) const override {
    const BsdfContext ctx = context(query);
    if (arrays_) return arrays_->sample_all(wi, u1, u2, ctx, found);
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = bsdf_.sample(wi[i], u1[i], u2[i], ctx);
  }

private:
  BsdfContext context(CheckQuery query) const { return {wavelengths(query.hero), point_, query.mode, 0}; }

  const Bsdf& bsdf_;
  const ArrayBsdf* arrays_;  // array methods of the BSDF; null: it has none
  std::shared_ptr<const Shape> shape_;
  SurfacePoint point_;
};

}  // namespace

CheckResult check_bsdf(const Bsdf& bsdf, const CheckOptions& options) {
  return check_scattering(BsdfFunction(bsdf, options), options);
}

}  // namespace aureole
