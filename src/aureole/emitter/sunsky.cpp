// SPDX-License-Identifier: Apache-2.0
// A clear sky with the sun by Hosek & Wilkie, as the environment of the scene.
#include <chrono>
#include <cmath>

#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/directions/sky_tables.h"
#include "aureole/emitter/light.h"
#include "aureole/math/piecewise.h"
#include "aureole/math/warp.h"
#include "aureole/optics/sky/sky_model.h"
#include "aureole/optics/sky/solar_position.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

using optics::SkyModel;

std::array<double, SkyModel::kChannels> albedo(const Properties& p) {
  const TexturePtr texture = get_texture(p, "albedo", 0.3, SpectrumRole::reflectance);
  if (!texture->is_constant()) throw p.error("albedo", "expected a spectrum, not a texture");
  // Outside the sensor's range, where spectra are unknown, the value at the range's limit is used.
  const SpectralGrid& grid = p.context().grid;
  std::array<double, SkyModel::kChannels> result;
  for (std::size_t c = 0; c < result.size(); ++c) {
    const double nm = std::clamp(SkyModel::wavelength_nm(c), grid.min_nm, grid.max_nm);
    result[c] = double(texture->eval({}, Wavelengths::at(grid, Spectrum(float(nm))))[0]);
  }
  return result;
}

/// Direction to the sun in local coordinates, from date, time and position. Axes are Mitsuba's: azimuth,
/// which runs from north by east, is turned from -x towards -y.
Vec3 sun_by_date(const Properties& p) {
  using namespace std::chrono;
  const auto number = [&](const char* name, std::int64_t fallback, Range range) {
    return p.get_int(name, fallback, range);
  };
  const year_month_day date{year(int(number("year", 2010, {1900, 2100}))),
                            month(unsigned(number("month", 7, {1, 12}))),
                            day(unsigned(number("day", 10, {1, 31})))};
  if (!date.ok()) throw p.error("day", "this month has fewer days");
  const double hour = p.get_float("hour", 15, {0, 24}) + p.get_float("minute", 0, {0, 60}) / 60 +
                      p.get_float("second", 0, {0, 60}) / 3600 - p.get_float("timezone", 9, {-15, 15});
  const double midnight =
      double(sys_days(date).time_since_epoch().count()) - 10957.5;  // days since noon of 2000-01-01
  const auto s =
      optics::solar_position(midnight + hour / 24, hour, p.get_float("latitude", 35.6894, {-90, 90}),
                             p.get_float("longitude", 139.6917, {-180, 360}));
  const double sine = std::sin(s.zenith_angle);
  return {float(-sine * std::cos(s.azimuth)), float(-sine * std::sin(s.azimuth)),
          float(std::cos(s.zenith_angle))};
}

Vec3 sun_direction(const Properties& p, const Frame& axes) {
  if (!p.has("sun_direction")) return sun_by_date(p);
  for (const char* other :
       {"latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"})
    if (p.has(other)) throw p.error(other, "give either \"sun_direction\" or date, time and place");
  const Vec3 d = p.get_vec3("sun_direction", {});
  if (!(length_squared(d) > 0) || !std::isfinite(length_squared(d)))
    throw p.error("sun_direction", "a direction must not be zero");
  return axes.to_local(normalize(d));
}

class SunskyEmitter final : public Emitter {
public:
  explicit SunskyEmitter(const Properties& p)
      : Emitter(p),
        axes_(get_placement(p).axes),
        sun_(sun_direction(p, axes_)),
        model_(p.get_float("turbidity", 3, {1, 10}), albedo(p),
               std::asin(std::clamp(double(sun_.z), 0.0, 1.0))),
        horizon_(1024, [&](std::size_t c, double x) { return model_.horizon(c, x * x); }),
        glow_(1024, [&](std::size_t c, double x) { return model_.glow(c, M_PI * x * x); }) {
    sky_scale_ = float(p.get_float("sky_scale", 1, Range::non_negative()));
    sun_scale_ = float(p.get_float("sun_scale", 1, Range::non_negative()));
    const double half = 0.5 * p.get_float("sun_aperture", 0.5358, {0, 89, true}) * M_PI / 180;
    complex_sun_ = p.get_bool("complex_sun", false);
    if (sun_.z < 0) {
      p.note(p.has("sun_direction") ? "sun_direction" : "hour",
             "the sun is below the horizon: there is no light");
      sky_scale_ = sun_scale_ = 0;
    }
    for (std::size_t c = 0; c < SkyModel::kChannels; ++c) zenith_gain_.v[c] = float(model_.zenith_gain(c));
    build_sun(half);
    build_distribution();
  }

  bool is_infinite() const override { return true; }

  Spectrum eval_escaped(const Vec3& d, const Wavelengths& w) const override {
    const Vec3 local = axes_.to_local(d);
    return radiance(local, in_sun(local), w);
  }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2 u,
                                            const Wavelengths& w) const override {
    Vec3 local;
    bool in_disc = true;
    if (u.x < sky_share_) {
      u.x = std::min(u.x / sky_share_, kOneMinusEpsilon);
      float ignored;  // value that is not used: `density` includes the sun's pdf
      const Vec2 uv = distribution_.sample(u, &ignored);
      const Vec2 around = cos_sin_2pi(uv.x);
      const float sine = std::sqrt((1 - uv.y) * (1 + uv.y));
      local = {sine * around.x, sine * around.y, uv.y};
      in_disc = in_sun(local);
    } else {
      u.x = std::min((u.x - sky_share_) / (1 - sky_share_), kOneMinusEpsilon);
      local = normalize(sun_frame_.to_world(square_to_uniform_cone(u, sun_one_minus_cosine_)));
      if (!(local.z >= 0)) return {};
    }
    DirectSample s;
    s.wo = normalize(axes_.to_world(local));
    // `in_disc` is passed on: a second test whether the direction is in the disc could differ by rounding.
    s.radiance = radiance(local, in_disc, w);
    s.pdf = density(local, in_disc);
    s.infinite = true;
    return s;
  }

  float pdf_direct_escaped(const Vec3&, const Vec3&, const Vec3& d) const override {
    const Vec3 local = axes_.to_local(d);
    return density(local, in_sun(local));
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& w) const override {
    const auto s = sample_direct(light, {}, part, direction, w);
    if (!s) return {};
    EmittedRay r = ray_from_infinity(light, -s->wo, position);
    r.value = s->radiance;
    r.pdf_direction = s->pdf;
    return r;
  }

  RayDensity pdf_ray(const Light& light, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    return density_from_infinity(light, pdf_direct_escaped({}, {}, -d));
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    std::array<double, SkyModel::kChannels> nm, values;
    for (std::size_t c = 0; c < nm.size(); ++c) {
      nm[c] = SkyModel::wavelength_nm(c);
      values[c] = (sky_integral_[c] + sun_integral_[c]) * M_PI * double(light.scene_radius) *
                  double(light.scene_radius);
    }
    return SampledSpectrum::from_points(properties().context().grid, nm, values);
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }

private:
  using Integral = std::array<double, SkyModel::kChannels>;

  bool in_sun(const Vec3& local) const {
    return 0.5f * length_squared(local - sun_) <= sun_one_minus_cosine_;
  }

  Channels sky(const Vec3& local) const {
    // The angle between two unit vectors, accurate for nearly parallel ones.
    const float gamma = 2 * std::atan2(length(local - sun_), length(local + sun_));
    const float root = std::sqrt(std::min(local.z, 1.f));
    const Channels far = horizon_.at(root), near = glow_.at(std::sqrt(gamma * kInvPi));
    Channels r;
    for (int c = 0; c < 12; ++c)
      r.v[c] = std::max(0.f, sky_scale_ * far.v[c] * (near.v[c] + zenith_gain_.v[c] * root));
    return r;
  }

  Spectrum sun(const Vec3& local, const Wavelengths& w) const {
    if (!complex_sun_) return at_wavelengths(sun_mean_, w);
    const float chord2 = length_squared(local - sun_), sine2 = chord2 * (1 - 0.25f * chord2);
    const float elevation = std::asin(std::min(local.z, 1.f));
    return at_wavelengths(disc_->at((elevation - lowest_) / (2 * half_)), w) *
           at_wavelengths(limb_->at(std::sqrt(std::max(0.f, 1 - sine2 * inverse_sine2_))), w);
  }

  Spectrum radiance(const Vec3& local, bool in_disc, const Wavelengths& w) const {
    if (!(local.z >= 0)) return 0.f;
    const Spectrum from_sky = sky_scale_ > 0 ? at_wavelengths(sky(local), w) : Spectrum(0.f);
    return in_disc && sun_scale_ > 0 ? from_sky + sun(local, w) : from_sky;
  }

  float density(const Vec3& local, bool in_disc) const {
    if (!(local.z >= 0)) return 0;
    const float turn = std::atan2(local.y, local.x) * (0.5f * kInvPi);
    const float of_sky =
        distribution_.pdf({turn < 0 ? turn + 1 : turn, std::min(local.z, 1.f)}) * (0.5f * kInvPi);
    return sky_share_ * of_sky + (in_disc ? (1 - sky_share_) * uniform_cone_pdf(sun_one_minus_cosine_) : 0);
  }

  /// Builds tables of the disc and its integral. A sun of another size than the real one has the same power.
  void build_sun(double half) {
    const double real_half = 0.5 * SkyModel::kSunDiameter, elevation = std::asin(double(sun_.z));
    const auto one_minus_cosine = [](double a) { return 2 * std::sin(0.5 * a) * std::sin(0.5 * a); };
    const double scale = sun_scale_ * one_minus_cosine(real_half) / one_minus_cosine(half);
    sun_frame_ = Frame::from_normal(sun_);
    sun_one_minus_cosine_ = float(one_minus_cosine(half));
    half_ = float(half), lowest_ = float(elevation - half);
    inverse_sine2_ = float(1 / (std::sin(half) * std::sin(half)));
    if (complex_sun_) {
      disc_ = std::make_unique<ChannelTable>(512, [&](std::size_t c, double x) {
        return scale * model_.sun(c, std::min(elevation + half * (2 * x - 1), M_PI / 2));
      });
      limb_ = std::make_unique<ChannelTable>(
          128, [](std::size_t c, double x) { return SkyModel::limb_darkening(c, x); });
    }
    // Rings and spokes of equal solid angle over the disc, or over the real sun's disc, whose mean is then
    // used for the whole disc.
    const double over = complex_sun_ ? half : real_half;
    constexpr int kRings = 100, kSpokes = 64;
    Integral sum{};
    for (int i = 0; i < kRings; ++i) {
      const double cosine = 1 - one_minus_cosine(over) * (i + 0.5) / kRings,
                   sine = std::sqrt(1 - cosine * cosine);
      const double q = sine / std::sin(over), cos_psi = std::sqrt(std::max(0.0, 1 - q * q));
      for (int j = 0; j < kSpokes; ++j) {
        const double z = std::sin(elevation) * cosine +
                         std::cos(elevation) * sine * std::cos(2 * M_PI * (j + 0.5) / kSpokes);
        for (std::size_t c = 0; c < sum.size(); ++c)
          sum[c] += model_.sun(c, std::asin(std::clamp(z, -1.0, 1.0))) *
                    SkyModel::limb_darkening(c, cos_psi) * scale / (kRings * kSpokes);
      }
    }
    for (std::size_t c = 0; c < sum.size(); ++c) {
      sun_mean_.v[c] = float(sum[c]);
      sun_integral_[c] = sum[c] * 2 * M_PI * one_minus_cosine(half);
    }
  }

  /// Builds the density of sky light over azimuth and cosine. Cells have their mean radiance over the
  /// sensor's range, plus a small fraction of the whole sky's mean, for features between the nine points of a
  /// cell.
  void build_distribution() {
    constexpr int kColumns = 180, kRows = 90;
    const SpectralGrid& grid = properties().context().grid;
    std::array<double, SkyModel::kChannels> share{};  // weight of each channel in a mean over the range
    for (int i = 0; i <= grid.cells; ++i) {
      const double p = (grid.node(i) - SkyModel::wavelength_nm(0)) / 40, cell = std::floor(p);
      for (const double c : {cell, cell + 1})
        if (p >= 0 && p <= double(share.size() - 1) && c < double(share.size()))
          share[std::size_t(c)] += (1 - std::abs(p - c)) / (grid.cells + 1);
    }
    std::vector<float> weights;
    double total = 0;
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        double weight = 0;
        for (int j = 0; j <= 2; ++j)
          for (int i = 0; i <= 2; ++i) {
            const double z = (y + 0.5 * j) / kRows, phi = 2 * M_PI * (x + 0.5 * i) / kColumns,
                         r = std::sqrt(1 - z * z);
            const Channels l = sky({float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)});
            // Weights of Simpson's rule.
            const double part = (i == 1 ? 4 : 1) * (j == 1 ? 4 : 1) / 36.0;
            for (std::size_t c = 0; c < share.size(); ++c) {
              weight += part * share[c] * double(l.v[c]);
              sky_integral_[c] += part * double(l.v[c]) * 2 * M_PI / (kColumns * kRows);
            }
          }
        weights.push_back(float(weight));
        total += weight;
      }
    const float least = float(0.02 * total / double(weights.size()));
    for (float& w : weights) w += least;
    distribution_ = Piecewise2D(weights, kColumns, kRows);
    double of_sky = 0, of_sun = 0;
    for (std::size_t c = 0; c < share.size(); ++c)
      of_sky += share[c] * sky_integral_[c], of_sun += share[c] * sun_integral_[c];
    // Sun and sky are each chosen with a probability of at least 0.25: points in the shadow receive sky light
    // only.
    sky_share_ = of_sun == 0   ? 1.f
                 : of_sky == 0 ? 0.f
                               : float(std::clamp(of_sky / (of_sky + of_sun), 0.25, 0.75));
  }

  Frame axes_;
  Vec3 sun_;  ///< direction to the sun in local coordinates
  SkyModel model_;
  /// `glow_` is a table over the square roots of the cosine and of the angle to the sun: fine near horizon and sun
  ChannelTable horizon_, glow_;
  Channels zenith_gain_;
  float sky_scale_, sun_scale_;
  bool complex_sun_;

  Frame sun_frame_;
  float sun_one_minus_cosine_, half_, lowest_, inverse_sine2_;
  Channels sun_mean_;
  /// table over elevation and over the cosine at the sun, for complex_sun
  std::unique_ptr<ChannelTable> disc_, limb_;

  Integral sky_integral_{}, sun_integral_{};  ///< integrals of the radiance over all directions
  Piecewise2D distribution_;
  float sky_share_;
};

AUREOLE_PLUGIN(
    SunskyEmitter, "emitter", "sunsky",
    PluginDoc{
        "A clear sky with its sun, as the environment of the scene. Local +z is up; `to_world` turns it if "
        "another axis of the scene is up. Radiance is absolute, in W/(m^2 sr nm). The model covers 320 to "
        "720 nm; there is no light at other wavelengths or from below the horizon.",
        "L. Hosek, A. Wilkie, An analytic model for full spectral sky-dome radiance, ACM TOG 31(4), "
        "2012; Adding a solar-radiance function to the Hosek-Wilkie skylight model, IEEE CG&A 33(3), 2013",
        {{"turbidity", "float", "", "3", "haze: 1 is pure air, 3 a clear day, 10 a hazy one"},
         {"albedo", "spectrum", "", "0.3", "albedo of the ground, whose reflection brightens the sky"},
         {"sun_direction", "vector", "", "from date and place",
          "direction towards the sun, in world coordinates"},
         {"latitude", "float", "degrees", "35.6894", "north is positive"},
         {"longitude", "float", "degrees", "139.6917", "east is positive"},
         {"timezone", "float", "h", "9", "local time minus UT"},
         {"year", "integer", "", "2010", "1900 to 2100"},
         {"month", "integer", "", "7", "1 to 12"},
         {"day", "integer", "", "10", "1 to 31"},
         {"hour", "float", "h", "15", "local time; may have a fraction"},
         {"minute", "float", "min", "0", "local time"},
         {"second", "float", "s", "0", "local time"},
         {"sun_scale", "float", "", "1", "factor of the sun's light; 0: sky only"},
         {"sky_scale", "float", "", "1", "factor of the sky's light; 0: sun only"},
         {"sun_aperture", "float", "degrees", "0.5358",
          "angular diameter of the sun; its power does not depend on it"},
         {"complex_sun", "boolean", "", "false",
          "a disc with limb darkening that is redder towards the horizon, instead of a uniform one of the "
          "same power"},
         {"to_world", "transform", "", "identity",
          "rotation; local +z is up, the azimuth of the sun by date runs from north at -x by east "
          "at -y"}},
        {R"(<emitter type="sunsky">
    <integer name="year" value="2024"/> <integer name="month" value="6"/> <integer name="day" value="21"/>
    <float name="hour" value="16.5"/> <float name="minute" value="0"/> <float name="second" value="0"/>
    <float name="latitude" value="48.2"/> <float name="longitude" value="16.4"/> <float name="timezone" value="2"/>
    <float name="turbidity" value="4"/> <rgb name="albedo" value="0.2, 0.25, 0.15"/>
    <transform name="to_world"><rotate x="1" angle="-90"/></transform>
</emitter>)",
         R"(<emitter type="sunsky">
    <vector name="sun_direction" value="1, 0.4, 1.2"/> <float name="sun_aperture" value="2"/>
    <float name="sun_scale" value="0.8"/> <float name="sky_scale" value="1.2"/> <boolean name="complex_sun" value="true"/>
</emitter>)"}});

}  // namespace
}  // namespace aureole
