// SPDX-License-Identifier: Apache-2.0
// The rules of scattering functions hold for phase functions, too: a BSDF without cosine and sides. Checked
// with Henyey and Greenstein's, right and with one fault at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aureole/instrument/check/scattering_check.h"

namespace aureole::testing {
namespace {

enum class Fault { none, density, value, gain, one_way };

/// L. G. Henyey and J. L. Greenstein, Diffuse radiation in the galaxy, 1941. Both directions point outward,
/// so that light goes straight on where cos(wi, wo) = -1.
class HenyeyGreenstein final : public ScatteringFunction {
public:
  HenyeyGreenstein(double g, Fault fault, const CheckOptions& options)
      : ScatteringFunction(SpectralGrid{}, options, "phase function"), g_(g), fault_(fault) {}

  bool is_on_surface() const override { return false; }
  Lobe lobes() const override { return Lobe::glossy; }

  void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery,
                std::span<BsdfEval> found) const override {
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const double p = density(-double(dot(wi[i], wo[i])));
      double value = p, pdf = p;
      if (fault_ == Fault::density) pdf *= 1 + 0.2 * double(wo[i].x);
      if (fault_ == Fault::value) value *= 1 + 0.2 * double(wo[i].x);
      if (fault_ == Fault::gain) value *= 1.01;
      if (fault_ == Fault::one_way) value *= 1 + 0.2 * double(wi[i].z);
      found[i] = {float(value), float(pdf)};
    }
  }
  void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, CheckQuery query,
            std::span<Spectrum> found) const override {
    std::vector<BsdfEval> both(wi.size());
    eval_pdf(wi, wo, query, both);
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = both[i].value;
  }
  void sample(std::span<const Vec3> wi, std::span<const float>, std::span<const Vec2> u2, CheckQuery query,
              std::span<std::optional<BsdfSample>> found) const override {
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const double t = (1 - g_ * g_) / (1 + g_ * (2 * double(u2[i].x) - 1));
      const double cosine = std::clamp((1 + g_ * g_ - t * t) / (2 * g_), -1.0, 1.0);
      const double sine = std::sqrt(1 - cosine * cosine), phi = 2 * M_PI * double(u2[i].y);
      const Vec3 local{float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(cosine)};
      const Vec3 wo = normalize(Frame::from_normal(-wi[i]).to_world(local));
      BsdfEval e;
      eval_pdf(wi.subspan(i, 1), {&wo, 1}, query, {&e, 1});
      found[i] = BsdfSample{wo, e.value, e.pdf, Lobe::glossy};
    }
  }

private:
  double density(double cosine) const {
    return (1 - g_ * g_) / (4 * M_PI * std::pow(1 + g_ * g_ - 2 * g_ * cosine, 1.5));
  }
  double g_;
  Fault fault_;
};

CheckResult check(double g, Fault fault) {
  CheckOptions options;
  options.samples = 100000;
  options.lossless = fault == Fault::none;
  return check_scattering(HenyeyGreenstein(g, fault, options), options);
}
bool found(const CheckResult& r, CheckRule rule) {
  return std::any_of(r.findings.begin(), r.findings.end(),
                     [&](const CheckFinding& f) { return f.rule == rule && !f.passed; });
}

TEST(PhaseFunctionCheck, AcceptsHenyeyGreenstein) {
  for (const double g : {-0.5, 0.3, 0.9}) {
    const CheckResult r = check(g, Fault::none);
    for (const std::string& problem : r.problems()) ADD_FAILURE() << "g = " << g << ": " << problem;
    EXPECT_EQ(r.histograms.size(), 12u);
    EXPECT_NEAR(r.smallest_energy, 1, 2e-3);
  }
}
TEST(PhaseFunctionCheck, SeesWrongDensity) {
  const CheckResult r = check(0.3, Fault::density);
  EXPECT_TRUE(found(r, CheckRule::chi_square));
}
TEST(PhaseFunctionCheck, SeesBrokenReciprocity) {
  EXPECT_TRUE(found(check(0.3, Fault::value), CheckRule::reciprocity));
  EXPECT_TRUE(found(check(0.3, Fault::one_way), CheckRule::reciprocity));
}
TEST(PhaseFunctionCheck, SeesEnergyGain) { EXPECT_TRUE(found(check(0.3, Fault::gain), CheckRule::energy)); }

}  // namespace
}  // namespace aureole::testing
