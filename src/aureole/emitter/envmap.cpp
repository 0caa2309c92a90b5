// SPDX-License-Identifier: Apache-2.0
// Environment map in latitude-longitude projection, importance-sampled. Its geometry is Mitsuba's: local +y
// is up; u = 0 is the direction local -z, and u grows towards +x. Texels are centred in azimuth; the first
// and last rows are the poles. Light sampling follows the product of the map's luminance and the cosine at
// the receiver.
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/directions/lat_long_distribution.h"
#include "aureole/emitter/light.h"
#include "aureole/math/lat_long.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/image_parameter.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/upsampled_color.h"

namespace aureole {
namespace {

class EnvmapEmitter final : public Emitter {
public:
  explicit EnvmapEmitter(const Properties& p) : Emitter(p) {
    frame_ = get_placement(p).axes;
    scale_ = float(p.get_float("scale", 1, Range::non_negative()));
    mis_compensation_ = p.get_bool("mis_compensation", false);
    load(p);

    d65_ = d65_spectrum(p.context().grid, 1);
  }

  bool is_infinite() const override { return true; }

  Spectrum eval_escaped(const Vec3& d, const Wavelengths& w) const override {
    return eval_uv(lat_long_uv(frame_.to_local(d)), w);
  }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2 u,
                                            const Wavelengths& w) const override {
    return sample(distribution_, {}, u, w);
  }
  std::optional<DirectSample> sample_direct_facing(const Light&, const Vec3&, const Vec3& facing, std::size_t,
                                                   Vec2 u, const Wavelengths& w) const override {
    return sample(distribution_, facing, u, w);
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t, Vec2 position, Vec2 direction,
                                       const Wavelengths& w) const override {
    const auto s = sample(mis_compensation_ ? everything_ : distribution_, {}, direction, w);
    if (!s) return {};
    EmittedRay r = ray_from_infinity(light, -s->wo, position);
    r.value = s->radiance;
    r.pdf_direction = s->pdf;
    return r;
  }

  RayDensity pdf_ray(const Light& light, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    return density_from_infinity(light, pdf(mis_compensation_ ? everything_ : distribution_, {}, -d));
  }

  float pdf_direct_escaped(const Vec3&, const Vec3& facing, const Vec3& d) const override {
    return dot(d, facing) < 0 ? 0 : pdf(distribution_, facing, d);
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    // The spectrum of the mean colour stands for the mean of the texels' spectra, which has the same colour:
    // only used to choose densities.
    const SigmoidSpectrum mean = upsample_unbounded(mean_[0], mean_[1], mean_[2]);
    std::vector<float> nodes(d65_.nodes().begin(), d65_.nodes().end());
    for (size_t i = 0; i < nodes.size(); ++i)
      nodes[i] *= scale_ * mean.at(float(d65_.grid().node(int(i)))) * 4 * kPi * kPi * light.scene_radius *
                  light.scene_radius;
    return {d65_.grid(), nodes};
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }

private:
  float pdf(const LatLongDistribution& distribution, const Vec3& facing, const Vec3& d) const {
    const Vec3 v = frame_.to_local(d);
    const float sine = std::sqrt(v.x * v.x + v.z * v.z);
    return sine > 0 ? distribution.pdf(facing, lat_long_uv(v)) / (2 * kPi * kPi * sine) : 0;
  }
  std::optional<DirectSample> sample(const LatLongDistribution& distribution, const Vec3& facing, Vec2 u,
                                     const Wavelengths& w) const {
    float pdf;
    const Vec2 uv = distribution.sample(facing, u, &pdf);
    const float sine = cos_sin_2pi(0.5f * uv.y).y;
    if (!(pdf > 0) || !(sine > 0)) return {};
    const Vec3 wo = frame_.to_world(lat_long_direction(uv));
    // Sampled directions below the receiver's horizon occur in blocks of the map that the horizon crosses.
    if (dot(wo, facing) < 0) return {};
    DirectSample s;
    s.wo = wo;
    s.radiance = eval_uv(uv, w);
    s.pdf = pdf / (2 * kPi * kPi * sine);
    s.infinite = true;
    return s;
  }

  void load(const Properties& p) {
    auto [image, source] = read_image_parameter(p);
    if (image.cube_map)
      throw p.error(source,
                    "is a cube map; an environment map is latitude by longitude (exrenvmap -l converts it)");
    if (image.width < 2 || image.height < 3)
      throw p.error(source, "an environment map needs at least 2 x 3 pixels");
    width_ = image.width, height_ = image.height;
    int rgb[3] = {image.channel("R"), image.channel("G"), image.channel("B")};
    if (rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0) {
      const int y = image.channel("Y");
      if (y < 0) throw p.error(source, "the image has neither R, G, B nor Y channels");
      rgb[0] = rgb[1] = rgb[2] = y;
    }
    // Resampled photographs often have slightly negative pixels beside bright ones.
    mend_pixels(p, source, image, PixelRange::radiance);
    texels_.resize(size_t(width_) * size_t(height_));
    std::vector<float> luminance(texels_.size());
    double weight_sum = 0, sums[3] = {};
    for (int y = 0; y < height_; ++y) {
      const double weight = row_weight(y);
      for (int x = 0; x < width_; ++x) {
        float c[3];
        for (int k = 0; k < 3; ++k) {
          c[k] = image.at(x, y, size_t(rgb[k]));
          if (image.srgb_encoded) c[k] = srgb_decode(c[k]);
          sums[k] += c[k] * weight;
        }
        weight_sum += weight;
        const size_t i = size_t(y) * size_t(width_) + size_t(x);
        texels_[i] = UpsampledColor::of(upsample_unbounded(c[0], c[1], c[2]));
        luminance[i] = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
      }
    }
    for (int k = 0; k < 3; ++k) mean_[k] = float(sums[k] / weight_sum);
    build_distribution(luminance);
  }

  /// The solid angle of a row, up to a common factor: its hat function times the sine of the polar angle,
  /// integrated. Rows at the poles have half a hat, whose integral is small but not zero.
  double row_weight(int y) const {
    const double step = M_PI / (height_ - 1);
    if (y == 0 || y == height_ - 1) return 1 - std::sin(step) / step;
    return 2 * (1 - std::cos(step)) / step * std::sin(step * y);
  }

  /// Cells are no larger than texels; the bilinear patches between texel centres would cross the seam. Each
  /// cell's weight is its mean over a lattice that includes its corners, so that it is never zero where the
  /// interpolant is positive.
  void build_distribution(const std::vector<float>& luminance) {
    const auto lum = [&](float u, float v) {
      const float x = u * float(width_) - 0.5f, y = v * float(height_ - 1);
      const int x0 = int(std::floor(x)), y0 = std::min(int(y), height_ - 2);
      const float fx = x - float(x0), fy = y - float(y0);
      const auto at = [&](int i, int j) {
        return luminance[size_t(j) * size_t(width_) + size_t((i + width_) % width_)];
      };
      return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
             fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
    };
    const auto multiple = [](int n, int of) { return (n + of - 1) / of * of; };
    const int columns = multiple(width_, LatLongDistribution::kBlockColumns),
              rows = multiple(height_, LatLongDistribution::kBlockRows);
    std::vector<float> weights(size_t(columns) * size_t(rows)), compensated(weights.size());
    double mean = 0, area = 0;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        float sum = 0;
        for (int j = 0; j <= 4; ++j)
          for (int i = 0; i <= 4; ++i) {
            const float v = (float(y) + 0.25f * float(j)) / float(rows);
            sum += lum((float(x) + 0.25f * float(i)) / float(columns), std::min(v, 1.f)) / 25;
          }
        const float sine = std::sin(kPi * (float(y) + 0.5f) / float(rows));
        weights[size_t(y) * size_t(columns) + size_t(x)] = sum;
        mean += double(sum) * sine, area += sine;
      }
    // MIS compensation (Karlik et al. 2019): light sampling leaves dim regions to BSDF sampling. Emitted rays
    // have no second technique, so that their density is not compensated.
    const float offset = float(mean / area);
    bool any = false;
    for (float w : weights) any |= w > offset * 1.01f;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const size_t i = size_t(y) * size_t(columns) + size_t(x);
        const float sine = std::sin(kPi * (float(y) + 0.5f) / float(rows));
        compensated[i] = (any ? std::max(0.f, weights[i] - offset) : weights[i]) * sine;
        weights[i] *= sine;
      }
    distribution_ = LatLongDistribution(mis_compensation_ ? compensated : weights, columns, rows, frame_);
    if (mis_compensation_) everything_ = LatLongDistribution(weights, columns, rows, frame_);
  }

  Spectrum eval_uv(Vec2 uv, const Wavelengths& w) const {
    // A NaN coordinate becomes 0.
    const float x = (uv.x > 0 ? uv.x : 0) * float(width_) - 0.5f,
                y = (uv.y > 0 ? uv.y : 0) * float(height_ - 1);
    const int x0 = int(std::floor(x)), y0 = std::clamp(int(y), 0, height_ - 2);
    const float fx = x - float(x0), fy = std::clamp(y - float(y0), 0.f, 1.f);
    const auto at = [&](int i, int j) -> const UpsampledColor& {
      i = i < 0 ? i + width_ : i >= width_ ? i - width_ : i;
      return texels_[size_t(j) * size_t(width_) + size_t(i)];
    };
    const UpsampledColor *a = &at(x0, y0), *b = &at(x0 + 1, y0), *c = &at(x0, y0 + 1),
                         *d = &at(x0 + 1, y0 + 1);
    const float wa = (1 - fx) * (1 - fy), wb = fx * (1 - fy), wc = (1 - fx) * fy, wd = fx * fy;
    // Spectra are interpolated, so that the colour between texels is the interpolated colour, to which
    // light sampling is proportional.
    const Spectrum nm = UpsampledColor::model_range(w.nm);
    return (a->eval(nm) * wa + b->eval(nm) * wb + c->eval(nm) * wc + d->eval(nm) * wd) * d65_.eval(w) *
           scale_;
  }

  Frame frame_;
  float scale_ = 1, mean_[3];
  bool mis_compensation_;
  int width_ = 0, height_ = 0;
  std::vector<UpsampledColor> texels_;
  /// distribution of light sampling, and the uncompensated one of emitted rays, which is only used if the
  /// first is compensated
  LatLongDistribution distribution_, everything_;
  SampledSpectrum d65_;
};

AUREOLE_PLUGIN(
    EnvmapEmitter, "emitter", "envmap",
    PluginDoc{
        "Environment map in latitude-longitude projection. Colours are upsampled to spectra and multiplied "
        "by D65.",
        "",
        {image_file_doc("EXR, HDR or any other image"),
         image_data_doc(),
         {"scale", "float", "", "1", "factor of the radiance"},
         {"to_world", "transform", "", "identity", "rotation of the map, whose local +y is up"},
         {"mis_compensation", "boolean", "", "false",
          "light sampling samples only regions brighter than average (Karlik et al. 2019, \"MIS "
          "compensation\")"}},
        {R"(<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="2"/>
    <boolean name="mis_compensation" value="true"/><transform name="to_world"><rotate y="1" angle="90"/></transform></emitter>)"}});

}  // namespace
}  // namespace aureole
