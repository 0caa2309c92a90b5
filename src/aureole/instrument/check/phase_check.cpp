// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/phase_check.h"

#include "aureole/instrument/check/scattering_check.h"

namespace aureole {

namespace {

class PhaseScattering final : public ScatteringFunction {
public:
  PhaseScattering(const PhaseFunction& phase, const CheckOptions& options, const Vec3& p)
      : ScatteringFunction(grid_of(phase, options), options, "phase function"), phase_(phase), p_(p) {}

  bool is_on_surface() const override { return false; }
  Lobe lobes() const override { return Lobe::glossy; }
  float area(const Vec3& w) const override { return phase_.projected_area(w, p_); }

  void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
                std::span<BsdfEval> found) const override {
    const PhaseContext ctx{wavelengths(query.hero), p_};
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const PhaseEval e = phase_.eval_pdf(wi[i], wo[i], ctx);
      found[i] = {e.value, e.pdf};
    }
  }
  void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
            std::span<Spectrum> found) const override {
    const PhaseContext ctx{wavelengths(query.hero), p_};
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = phase_.eval_pdf(wi[i], wo[i], ctx).value;
  }
  void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2, CheckQuery query,
              std::span<std::optional<BsdfSample>> found) const override {
    const PhaseContext ctx{wavelengths(query.hero), p_};
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const auto s = phase_.sample(wi[i], u1[i], u2[i], ctx);
      found[i].reset();
      if (s) found[i] = BsdfSample{s->wo, s->value, s->pdf, Lobe::glossy};
    }
  }

private:
  const PhaseFunction& phase_;
  Vec3 p_;
};

}  // namespace

CheckResult check_phase(const PhaseFunction& phase, const CheckOptions& options, const Vec3& p) {
  CheckOptions all = options;
  all.lossless = true;
  all.black_below = all.may_be_black_below = false;
  return check_scattering(PhaseScattering(phase, all, p), all);
}

}  // namespace aureole
