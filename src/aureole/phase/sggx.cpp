// SPDX-License-Identifier: Apache-2.0
// Fibres and flakes of ellipsoidal normal distribution with mirror reflection: the specular phase function of
// E. Heitz, J. Dupuy, C. Crassin & C. Dachsbacher, "The SGGX microflake distribution", 2015.
#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/phase/lobe/flakes.h"
#include "aureole/phase/phase.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"

namespace aureole {
namespace {

using Matrix = std::array<float, 6>;

class Sggx final : public PhaseFunction {
public:
  explicit Sggx(const Properties& p) : PhaseFunction(p), constant_(Matrix{1, 1, 1, 0, 0, 0}) {
    const Properties::Entry* e = p.find("S");
    if (!e) throw p.error("S", "the parameter \"S\" is required: six numbers or a volume of six channels");
    if (std::holds_alternative<std::string>(e->value)) {
      read_constant(p);
      return;
    }
    volume_ = p.get_object<const Volume>("S");
    if (volume_->channels() != 6)
      throw p.error("S", "needs a volume of six channels, got one of " + std::to_string(volume_->channels()));
    if (volume_->is_constant()) {
      Matrix s;
      volume_->eval_channels({}, s.data());
      set_constant(p, s);
      volume_ = nullptr;
      return;
    }
    // Bound of the projected area by the largest eigenvalue of S, which is at most its trace.
    largest_area_ = std::sqrt(3 * std::max(volume_->maximum(), 1e-12f));
    // Empty space is replaced by the unit matrix.
    largest_area_ = std::max(largest_area_, 1.f);
  }

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const override {
    const float p = at(ctx.p).eval(wi, wo);
    return {p, p};
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float, Vec2 u2, const PhaseContext& ctx) const override {
    const Flakes flakes = at(ctx.p);
    const Vec3 wo = flakes.sample(wi, u2);
    const float p = flakes.eval(wi, wo);
    if (!(p > 0)) return {};
    return PhaseSample{wo, p, p};
  }

  float projected_area(const Vec3& d, const Vec3& p) const override { return at(p).area(d); }
  float largest_projected_area() const override { return largest_area_; }
  bool is_isotropic_medium() const override { return false; }
  bool is_uniform() const override { return !volume_; }

private:
  void read_constant(const Properties& p) {
    const std::vector<double> numbers = get_number_list(p, "S");
    Matrix s;
    if (numbers.size() != s.size())
      throw p.error("S", "needs six numbers (xx, yy, zz, xy, xz, yz), got " + std::to_string(numbers.size()));
    std::transform(numbers.begin(), numbers.end(), s.begin(), [](double v) { return float(v); });
    set_constant(p, s);
  }
  void set_constant(const Properties& p, const Matrix& s) {
    if (!Flakes::is_valid(s))
      throw p.error("S", "the matrix is not positive definite, or too flat for single precision");
    constant_ = Flakes(s);
    // Bound of the largest eigenvalue: it is at most the largest absolute row sum (Gershgorin).
    const float x = s[0] + std::abs(s[3]) + std::abs(s[4]), y = s[1] + std::abs(s[3]) + std::abs(s[5]),
                z = s[2] + std::abs(s[4]) + std::abs(s[5]);
    largest_area_ = std::sqrt(std::max({x, y, z}));
  }

  Flakes at(const Vec3& p) const {
    if (!volume_) return constant_;
    Matrix s;
    volume_->eval_channels(p, s.data());
    return Flakes(s);
  }

  Flakes constant_;
  std::shared_ptr<const Volume> volume_;  // volume of S; null: S is constant
  float largest_area_ = 1;
};

AUREOLE_PLUGIN(
    Sggx, "phase", "sggx",
    PluginDoc{
        "Oriented fibres and flakes that reflect as tiny mirrors: wood, cloth, hair from a distance. The "
        "symmetric, positive definite matrix S describes an ellipsoid in world axes. Its projected area "
        "along w, sqrt(w^T S w), is a factor of the medium's coefficients. Fibres along z with roughness r "
        "have S = diag(1, 1, r^2), flakes across z S = diag(r^2, r^2, 1).\n\nA grid's matrix that is not "
        "positive definite is replaced by the multiple of the unit matrix with its trace.",
        "Heitz, Dupuy, Crassin & Dachsbacher, The SGGX microflake distribution, 2015",
        {{"S", "string or volume", "", "required",
          "the entries xx, yy, zz, xy, xz, yz of the matrix: six numbers or a volume of six channels"}},
        {R"(<phase type="sggx">
    <string name="S" value="1, 1, 0.04, 0, 0, 0"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
