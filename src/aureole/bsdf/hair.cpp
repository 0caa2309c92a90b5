// SPDX-License-Identifier: Apache-2.0
// A fibre of hair or fur, with all scattering at one surface point (Chiang, Bitterli, Tappan & Burley 2016):
// light is reflected (p = 0), transmitted (1), internally reflected once (p = 2) or more often (one lobe for
// all p >= 3). Each lobe is a product of a longitudinal function M_p, an azimuthal function N_p and an
// attenuation A_p. Angles: theta from the plane perpendicular to the fibre, phi around it. The fibre lies
// along the local y axis, and the offset h across its width follows from the azimuth of wi about the normal.
#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/near_field.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

constexpr int kLobes = 4;  ///< the last lobe contains all p >= 3

/// Returns exp(-x) I_0(x) for x >= 0, to 2e-7 (Abramowitz & Stegun 1964, 9.8.1 and 9.8.2).
float scaled_bessel_i0(float x) {
  const auto polynomial = [](float t, const auto&... c) {
    float sum = 0, power = 1;
    ((sum += c * power, power *= t), ...);
    return sum;
  };
  if (x < 3.75f) {
    const float t = x / 3.75f;
    return std::exp(-x) *
           polynomial(t * t, 1.f, 3.5156229f, 3.0899424f, 1.2067492f, 0.2659732f, 0.0360768f, 0.0045813f);
  }
  return polynomial(3.75f / x, 0.39894228f, 0.01328592f, 0.00225319f, -0.00157565f, 0.00916281f, -0.02057706f,
                    0.02635537f, -0.01647633f, 0.00392377f) /
         std::sqrt(x);
}

/// A direction in the fibre's angles.
struct FibreDirection {
  float sin_theta, cos_theta, phi;

  explicit FibreDirection(const Vec3& w)
      : sin_theta(w.y), cos_theta(std::hypot(w.x, w.z)), phi(std::atan2(w.z, w.x)) {}
  FibreDirection(float s, float c, float p) : sin_theta(s), cos_theta(c), phi(p) {}
};

/// The longitudinal function of variance v: a Gaussian convolution on the sphere (d'Eon et al. 2011), a
/// density per d(sin theta). It is written without cancellation of large exponents.
class Longitudinal {
public:
  Longitudinal() = default;
  explicit Longitudinal(float v) : v_(v), tail_(std::exp(-2 / v)), scale_(1 / (v * (1 - tail_))) {}

  float density(const FibreDirection& i, const FibreDirection& o) const {
    const float dc = i.cos_theta - o.cos_theta, ss = i.sin_theta + o.sin_theta;
    return scale_ * std::exp(-(dc * dc + ss * ss) / (2 * v_)) *
           scaled_bessel_i0(i.cos_theta * o.cos_theta / v_);
  }
  /// Samples the sine of theta_o (d'Eon, Marschner & Hanika 2013).
  float sample(const FibreDirection& i, Vec2 u) const {
    // 1 - cos of the angle between the longitudinal directions
    const float below = std::clamp(-v_ * std::log(u.x + (1 - u.x) * tail_), 0.f, 2.f);
    const float sine = std::sqrt(below * (2 - below));
    return std::clamp((below - 1) * i.sin_theta + sine * std::cos(2 * kPi * u.y) * i.cos_theta, -1.f, 1.f);
  }

private:
  float v_ = 1, tail_ = 0, scale_ = 1;
};

/// A logistic distribution of scale s, truncated to [-pi, pi] (Chiang et al. 2016, section 4.1).
class TrimmedLogistic {
public:
  TrimmedLogistic() = default;
  explicit TrimmedLogistic(float s)
      : s_(s), outside_(1 / (1 + std::exp(kPi / s))), inside_(std::tanh(kPi / (2 * s))) {}

  float density(float x) const {
    const float e = std::exp(-std::abs(x) / s_);
    return e / (s_ * (1 + e) * (1 + e) * inside_);
  }
  float sample(float u) const {
    return std::clamp(s_ * std::log((outside_ + u * inside_) / (outside_ + (1 - u) * inside_)), -kPi, kPi);
  }

private:
  float s_ = 1, outside_ = 0, inside_ = 1;
};

/// Absorption of the two melanins at concentration 1, per radius of the fibre. d'Eon et al. (2011, section
/// 6.1) give it for red, green and blue: (0.419, 0.697, 1.37) and (0.187, 0.4, 1.05). These agree to 5 % with
/// the power laws published for the pigments (Donner & Jensen 2006) at 650, 550 and 450 nm.
double eumelanin(double nm) { return 0.697 * std::pow(nm / 550, -3.33); }
double pheomelanin(double nm) { return 0.4 * std::pow(nm / 550, -4.75); }

class Hair final : public Bsdf {
public:
  explicit Hair(const Properties& properties)
      : Bsdf(properties),
        sigma_a_(get_optional_texture(properties, "sigma_a", SpectrumRole::unbounded)),
        scale_(float(properties.get_float("scale", 1, Range::non_negative()))),
        eta_(Ior::from(properties, "int_ior", "amber").at_sodium_d() /
             Ior::from(properties, "ext_ior", "air").at_sodium_d()) {
    const double eu = properties.get_float("eumelanin", 1.3, Range::non_negative());
    const double pheo = properties.get_float("pheomelanin", 0.2, Range::non_negative());
    for (const char* melanin : {"eumelanin", "pheomelanin"})
      if (sigma_a_ && properties.has(melanin))
        throw properties.error(melanin, "give either sigma_a or the melanins, not both");
    if (!sigma_a_) {
      melanin_ = SampledSpectrum::from_function(
          properties.context().grid, [&](double nm) { return eu * eumelanin(nm) + pheo * pheomelanin(nm); });
      if (properties.has("scale"))
        properties.note("scale", "is a factor of sigma_a and has no effect without it");
    }

    // Fits that map perceptually uniform roughnesses to variances (Chiang et al. 2016, section 4.1).
    const auto roughness = [&](const char* name) {
      return std::max(properties.get_float(name, 0.3, Range::unit()), kSmoothest);
    };
    const double l = roughness("longitudinal_roughness"), a = roughness("azimuthal_roughness");
    const double v = std::pow(0.726 * l + 0.812 * l * l + 3.7 * std::pow(l, 20), 2);
    longitudinal_ = {Longitudinal(float(v)), Longitudinal(float(v / 4)), Longitudinal(float(4 * v)),
                     Longitudinal(float(4 * v))};
    azimuthal_ =
        TrimmedLogistic(float(std::sqrt(kPi / 8) * (0.265 * a + 1.194 * a * a + 5.372 * std::pow(a, 22))));

    // Tilt of each lobe along the fibre by the scales of the cuticle (Marschner et al. 2003).
    const double tilt = properties.get_float("scale_tilt", 2, {-90, 90}) * (kPi / 180);
    constexpr double kTurns[kLobes] = {-2, 1, 4, 0};
    for (std::size_t p = 0; p < kLobes; ++p)
      turns_[p] = {float(std::sin(kTurns[p] * tilt)), float(std::cos(kTurns[p] * tilt))};
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    return at(Incidence(*this, wi, ctx), FibreDirection(wo));
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const Incidence in(*this, wi, ctx);
    std::size_t p = 0;
    float u = u1 * in.total[0];
    while (p + 1 < kLobes && u >= in.part[p][0]) u -= in.part[p++][0];
    u = std::clamp(u / in.part[p][0], 0.f, 1.f);

    const float sin_theta = longitudinal_[p].sample(in.turned[p], u2);
    const float cos_theta = std::sqrt((1 - sin_theta) * (1 + sin_theta));
    const float turn = p + 1 < kLobes ? in.exit(p) + azimuthal_.sample(u) : 2 * kPi * u;
    const float phi = in.wi.phi + turn;
    const Vec3 wo = normalize(Vec3{cos_theta * std::cos(phi), sin_theta, cos_theta * std::sin(phi)});
    const BsdfEval e = at(in, FibreDirection(wo));
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, Lobe::glossy | (wo.z < 0 ? Lobe::transmit : Lobe::reflect)};
  }

  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect | Lobe::transmit | kNearField; }

private:
  /// lower bound of the roughness: narrower lobes exceed single precision
  static constexpr double kSmoothest = 0.01;

  struct Turn {
    float sine, cosine;
  };

  /// Quantities that depend only on wi and the point.
  struct Incidence {
    FibreDirection wi;
    float gamma_i, gamma_t;  ///< angles of the normal with wi, and with the refracted ray, in the plane
                             ///< perpendicular to the fibre
    std::array<FibreDirection, kLobes> turned;
    std::array<Spectrum, kLobes> part;  ///< A_p
    Spectrum total{0.f};

    Incidence(const Hair& hair, const Vec3& w, const BsdfContext& ctx)
        : wi(w),
          gamma_i(std::atan2(-w.x, w.z)),
          turned{hair.turned(wi, 0), hair.turned(wi, 1), hair.turned(wi, 2), wi} {
      // In the plane perpendicular to the fibre, light is refracted with an effective index (Bravais).
      const float eta = hair.eta_, h = -w.x / wi.cos_theta, s2 = wi.sin_theta * wi.sin_theta;
      const float across = std::sqrt(std::max(eta * eta - s2, 0.f));  // eta cos theta_t = eta' cos theta_i
      gamma_t = std::asin(std::clamp(h * wi.cos_theta / std::max(across, 1e-6f), -1.f, 1.f));
      // theta_i and gamma_i combine to the angle with the normal.
      const float reflected = fresnel_dielectric(std::min(w.z, 1.f), eta).reflectance;
      const float entering = 1 - reflected, length = 2 * std::cos(gamma_t) * eta / std::max(across, 1e-6f);
      const Spectrum sigma = hair.absorption(ctx);
      const Spectrum passed = make_spectrum([&](int i) { return std::exp(-sigma[i] * length); });
      part[0] = reflected;
      part[1] = passed * (entering * entering);
      part[2] = part[1] * passed * reflected;
      part[3] = part[2] * passed * reflected / max(Spectrum(1.f) - passed * reflected, 1e-6f);
      for (const Spectrum& a : part) total += a;
    }

    /// Returns phi_o - phi_i of the lobe's centre (Marschner et al. 2003).
    float exit(std::size_t p) const { return float(p) * (2 * gamma_t + kPi) - 2 * gamma_i; }
  };

  FibreDirection turned(const FibreDirection& w, std::size_t p) const {
    const auto [sine, cosine] = turns_[p];
    return {w.sin_theta * cosine + w.cos_theta * sine, std::abs(w.cos_theta * cosine - w.sin_theta * sine),
            w.phi};
  }

  BsdfEval at(const Incidence& in, const FibreDirection& wo) const {
    Spectrum value = in.part[kLobes - 1] *
                     (longitudinal_[kLobes - 1].density(in.turned[kLobes - 1], wo) * (0.5f * kInvPi));
    for (std::size_t p = 0; p + 1 < kLobes; ++p) {
      const float phi = std::remainder(wo.phi - in.wi.phi - in.exit(p), 2 * kPi);
      value += in.part[p] * (longitudinal_[p].density(in.turned[p], wo) * azimuthal_.density(phi));
    }
    return {value, safe_divide(value, in.total)};
  }

  Spectrum absorption(const BsdfContext& ctx) const {
    return sigma_a_ ? sigma_a_->eval(ctx.point, ctx.wavelengths) * scale_ : melanin_.eval(ctx.wavelengths);
  }

  TexturePtr sigma_a_;
  float scale_;
  SampledSpectrum melanin_;
  float eta_;
  std::array<Longitudinal, kLobes> longitudinal_;
  TrimmedLogistic azimuthal_;
  std::array<Turn, kLobes> turns_;
};

AUREOLE_PLUGIN(
    Hair, "bsdf", "hair",
    PluginDoc{
        "A fibre of hair or fur, for `bsplinecurve` and `linearcurve`; on other shapes the fibre lies along "
        "dp/dv. Light is reflected by the surface, which tilted scales roughen, or passes through the "
        "coloured interior with any number of internal reflections. All scattering happens at one point: "
        "transmitted light leaves on the opposite side. The offset across the width follows from the "
        "direction to the viewer, or in light tracing (`ptracer`) from the direction to the light, so the "
        "model is not reciprocal. It is black from inside. Both indices are those at 589 nm. Melanins "
        "absorb by the power laws of their measured spectra (Mitsuba upsamples three numbers, of which it "
        "clips those above 1). `bdpt` does not support it.",
        "M. J.-Y. Chiang, B. Bitterli, C. Tappan, B. Burley, A practical and controllable hair and fur model for "
        "production path tracing, Computer Graphics Forum 35(2), 2016; E. d'Eon et al., An energy-conserving hair "
        "reflectance model, EGSR 2011 (M_p, coefficients of melanins); C. Donner, H. W. Jensen, A spectral BSSRDF "
        "for shading human skin, EGSR 2006 (their spectra)",
        {{"eumelanin", "float", "", "1.3",
          "concentration of the brown to black pigment; 0.3 is blond, 8 black"},
         {"pheomelanin", "float", "", "0.2", "concentration of the yellow to red pigment"},
         {"sigma_a", "texture", "1/radius", "none",
          "absorption coefficient per radius of the fibre, instead of melanins"},
         {"scale", "float", "", "1", "factor of sigma_a"},
         {"longitudinal_roughness", "float", "", "0.3",
          "width of highlights along the fibre, from 0 to 1; below 0.01 as 0.01"},
         {"azimuthal_roughness", "float", "", "0.3",
          "width of highlights around the fibre, from 0 to 1; below 0.01 as 0.01"},
         {"scale_tilt", "float", "degree", "2",
          "angle between scales and surface. The reflected lobe is tilted by twice this angle towards the "
          "end of the curve, the root of natural hair, the transmitted lobe by this angle towards its tip"},
         {"int_ior", "float or string", "", "amber",
          "index of refraction of the interior, as a number or the name of a material; 1.55"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction of the exterior, as a number or the name of a material"}},
        {R"(<bsdf type="hair">
    <float name="eumelanin" value="0.3"/>
    <float name="pheomelanin" value="0.1"/>
    <float name="longitudinal_roughness" value="0.25"/>
    <float name="azimuthal_roughness" value="0.4"/>
    <float name="scale_tilt" value="3"/>
</bsdf>)",
         R"(<bsdf type="hair">
    <rgb name="sigma_a" value="0.1, 0.3, 0.9"/>
    <float name="scale" value="2"/>
    <float name="int_ior" value="1.55"/>
    <string name="ext_ior" value="air"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
