// SPDX-License-Identifier: Apache-2.0
// A spot light: a point whose intensity falls linearly with the angle between the beam width and the cutoff.
#include <cmath>

#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

/// Returns 1 - cos(angle) without cancellation at small angles.
double one_minus_cosine(double angle) {
  const double s = std::sin(0.5 * angle);
  return 2 * s * s;
}

class SpotEmitter final : public Emitter {
public:
  explicit SpotEmitter(const Properties& p)
      : Emitter(p),
        motion_(get_placement_motion(p)),
        placement_(get_placement(p, motion_.first())),
        texture_(get_optional_texture(p, "texture", SpectrumRole::response)) {
    const Emission emission(p, "intensity");
    intensity_ = emission.texture();
    if (!intensity_->is_constant())
      throw p.error("intensity", "expected a spectrum; a picture to project belongs to \"texture\"");
    if (texture_ && texture_->is_constant())
      throw p.error("texture", "expected a picture to project; a colour belongs to \"intensity\"");
    const double cutoff_degrees = p.get_float("cutoff_angle", 20, {0, 180, true});
    const double beam_degrees = p.get_float("beam_width", 0.75 * cutoff_degrees, {0, 180});
    if (beam_degrees > cutoff_degrees) throw p.error("beam_width", "must not exceed cutoff_angle");
    if (texture_ && cutoff_degrees >= 90)
      throw p.error("cutoff_angle",
                    "a texture is projected onto a plane: the angle must be below 90 degrees");
    cutoff_ = cutoff_degrees * M_PI / 180, beam_ = beam_degrees * M_PI / 180;
    cutoff_one_minus_cosine_ = float(one_minus_cosine(cutoff_));
    beam_one_minus_cosine_ = float(one_minus_cosine(beam_));
    // Rejects a cone too narrow for float precision, which would cause a division by zero.
    if (!(cutoff_one_minus_cosine_ > 1e-14f)) throw p.error("cutoff_angle", "is too narrow");
    inverse_transition_ = cutoff_ > beam_ ? float(1 / (cutoff_ - beam_)) : 0;
    inverse_tangent_ = float(1 / std::tan(cutoff_));
    if (!emission.amount()) return;
    // With a picture, the flux is the flux after the picture, and the intensity belongs to the picture's
    // white.
    const double per_unit = per_square_unit(p);
    const bool is_flux = emission.amount()->quantity == EmissionAmount::Quantity::flux;
    const SampledSpectrum average =
        texture_ && is_flux ? product(intensity_->average(), texture_mean()) : intensity_->average();
    intensity_ = scaled_texture(
        intensity_, emission.scale({.flux = per_unit / solid_angle(), .intensity = per_unit}, average));
  }

  bool is_delta() const override { return true; }
  const Motion* motion() const override { return motion_.is_moving() ? &motion_ : nullptr; }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3& reference, std::size_t, Vec2,
                                            const Wavelengths& w) const override {
    const Vec3 to = placement_.origin - reference;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) return {};
    DirectSample s;
    s.wo = to * (1 / std::sqrt(d2));
    const Vec3 local = placement_.axes.to_local(-s.wo);
    const float f = falloff(local);
    if (!(f > 0)) return {};
    s.p = placement_.origin;
    s.radiance = intensity(local, w) * (f / d2);
    s.pdf = 1;
    s.delta = true;
    return s;
  }

  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2, Vec2 direction,
                                       const Wavelengths& w) const override {
    const Vec3 local = square_to_uniform_cone(direction, cutoff_one_minus_cosine_);
    const float f = falloff(local);
    if (!(f > 0)) return {};
    EmittedRay r;
    r.p = placement_.origin;
    r.d = normalize(placement_.axes.to_world(local));
    r.value = intensity(local, w) * f;
    r.pdf_position = 1, r.delta_position = true;
    r.pdf_direction = uniform_cone_pdf(cutoff_one_minus_cosine_);
    return r;
  }

  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    const bool lit = falloff(placement_.axes.to_local(d)) > 0;
    return {1, lit ? uniform_cone_pdf(cutoff_one_minus_cosine_) : 0};
  }

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = texture_ ? product(intensity_->average(), texture_mean()) : intensity_->average();
    s.scale(float(solid_angle()));
    return s;
  }

  EmissionBounds emission_bounds(const Light&, std::size_t) const override {
    // The bound exceeds the cone by the rounding error of the light tree's arithmetic. Beyond 90 degrees, the
    // cone of normals opens as well, because the tree takes the cosine of the remaining angle for a factor.
    const double edge = std::min(M_PI, cutoff_ + 2e-3);
    const bool wide = edge >= M_PI / 2;
    return {{placement_.origin, placement_.origin},
            placement_.axes.n,
            float(wide ? std::cos(edge - M_PI / 2) : 1),
            float(wide ? 0 : std::cos(edge)),
            1,
            float(M_PI / solid_angle())};
  }

private:
  /// Falloff in the direction of a unit vector in the local frame; 0 outside the cutoff.
  float falloff(const Vec3& local) const {
    const float x = local.z > 0 ? (local.x * local.x + local.y * local.y) / (1 + local.z) : 1 - local.z;
    if (x <= beam_one_minus_cosine_) return 1;
    if (!(x < cutoff_one_minus_cosine_)) return 0;
    const float angle = 2 * std::asin(std::sqrt(std::min(0.5f * x, 1.f)));
    return std::max((float(cutoff_) - angle) * inverse_transition_, 0.f);
  }

  /// Texture coordinates: the picture fills the square around the circle in which the cutoff cone cuts the
  /// plane z = 1.
  Vec2 uv(const Vec3& local) const {
    const float k = 0.5f * inverse_tangent_ / local.z;
    return {0.5f + k * local.x, 0.5f + k * local.y};
  }

  Spectrum intensity(const Vec3& local, const Wavelengths& w) const {
    const Spectrum i = intensity_->eval({}, w);
    if (!texture_) return i;
    SurfacePoint point;
    point.uv = uv(local);
    return i * texture_->eval(point, w);
  }

  /// Integral of the falloff over directions [sr].
  double solid_angle() const {
    if (inverse_transition_ == 0) return 2 * M_PI * one_minus_cosine(cutoff_);
    // (sin c - sin b) / (c - b) = cos((c + b)/2) sinc((c - b)/2), subtracted from 1 without cancellation.
    const double half = 0.5 * (cutoff_ - beam_), middle = 0.5 * (cutoff_ + beam_);
    const double sinc_deficit = half < 1e-3 ? half * half / 6 : 1 - std::sin(half) / half;
    return 2 * M_PI * (one_minus_cosine(middle) + std::cos(middle) * sinc_deficit);
  }

  /// The mean spectrum of the picture, weighted by the falloff.
  SampledSpectrum texture_mean() const {
    const SpectralGrid& grid = properties().context().grid;
    std::vector<float> nodes(std::size_t(grid.cells) + 1);
    constexpr int kRings = 24, kSpokes = 48;
    double total = 0;
    std::vector<std::pair<SurfacePoint, float>> points;
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kSpokes; ++j) {
        const Vec3 local = square_to_uniform_cone({(float(i) + 0.5f) / kRings, (float(j) + 0.5f) / kSpokes},
                                                  cutoff_one_minus_cosine_);
        SurfacePoint point;
        point.uv = uv(local);
        points.emplace_back(point, falloff(local));
        total += points.back().second;
      }
    for (std::size_t first = 0; first < nodes.size(); first += kWavelengths) {
      const auto node = [&](int k) { return std::min(first + std::size_t(k), nodes.size() - 1); };
      const Wavelengths w =
          Wavelengths::at(grid, make_spectrum([&](int k) { return float(grid.node(int(node(k)))); }));
      Spectrum sum = 0.f;
      for (const auto& [point, weight] : points) sum += texture_->eval(point, w) * weight;
      for (int k = 0; k < kWavelengths; ++k) nodes[node(k)] = sum[k] / float(total);
    }
    return {grid, std::move(nodes)};
  }

  Motion motion_;
  Placement placement_;
  TexturePtr intensity_, texture_;  ///< intensity, and the picture, which may be null
  double cutoff_, beam_;            ///< angles of the cutoff and of the beam [rad]
  float cutoff_one_minus_cosine_, beam_one_minus_cosine_, inverse_transition_, inverse_tangent_;
};

AUREOLE_PLUGIN(
    SpotEmitter, "emitter", "spot",
    PluginDoc{
        "Spot light: a point with full intensity inside a beam around its local +z axis. Outside, the "
        "intensity falls linearly with the angle, up to the cutoff. A picture may be projected.",
        "",
        with_amount_parameters(
            {{"intensity", "spectrum", "W/(sr nm), any common scale", "1",
              "spectral radiant intensity in the beam"},
             {"cutoff_angle", "float", "degrees", "20",
              "half-angle of the cone beyond which the intensity is zero"},
             {"beam_width", "float", "degrees", "3/4 of cutoff_angle",
              "half-angle of the cone of full intensity"},
             {"texture", "texture", "", "none",
              "picture that multiplies the intensity; it fills the square around the cutoff's circle, u along "
              "+x"},
             {"to_world", "transform", "", "identity",
              "light to world: moves the origin to the light and turns +z along the beam. An `<animation>` of key frames moves the "
              "light"}},
            "lm, W, cd, W/sr", "flux of the light, or its intensity in the beam"),
        {R"(<emitter type="spot">
    <transform name="to_world"><lookat origin="0, 4, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <rgb name="intensity" value="60, 50, 40"/> <float name="cutoff_angle" value="35"/> <float name="beam_width" value="10"/>
</emitter>)",
         R"(<emitter type="spot"><texture name="texture" type="bitmap"><string name="filename" value="stencil.png"/></texture></emitter>)",
         R"(<emitter type="spot"><string name="amount" value="1200 cd"/><float name="color_temperature" value="3000"/></emitter>)",
         R"(<emitter type="spot"><string name="amount" value="50 W"/><float name="efficacy" value="18"/></emitter>)"}});

}  // namespace
}  // namespace aureole
