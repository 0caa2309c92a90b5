// SPDX-License-Identifier: Apache-2.0
// A picture as a texture. Colours are upsampled to spectra texel by texel, and spectra are interpolated.
// Upsampling is not linear, so that interpolated colours would give other spectra. The first row of the
// picture is at v = 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <tuple>
#include <type_traits>
#include <utility>

#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/core/unfilled.h"
#include "aureole/core/units.h"
#include "aureole/plugin/image_parameter.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/tables.h"
#include "aureole/spectrum/upsampled_color.h"
#include "aureole/texture/texture.h"
#include "aureole/texture/uv_transform.h"

namespace aureole {
namespace {

enum class Wrap { repeat, mirror, clamp };

float luminance(const Vec3& rgb) { return 0.212671f * rgb.x + 0.715160f * rgb.y + 0.072169f * rgb.z; }

/// The luminance under D65 of an upsampled colour, of which only the spectrum is stored. Sixteen wavelengths,
/// each with the observer's weight around it, give the luminance of any colour in [0, 1] to within 0.005.
class LuminanceRule {
public:
  LuminanceRule() {
    const Observer& observer = cie_1931_observer();
    const TabulatedSpectrum d65 = *find_illuminant("D65");
    double weights[kNodes] = {}, sum = 0;
    for (std::size_t i = 0; i < observer.y.size(); ++i) {
      const double nm = observer.start_nm + observer.step_nm * double(i), weight = observer.y[i] * d65.at(nm);
      const double at = std::clamp((nm - kFirstNm) / kStepNm, 0.0, kNodes - 1.0);
      const int below = std::min(int(at), kNodes - 2);
      weights[below] += weight * (below + 1 - at);
      weights[below + 1] += weight * (at - below);
      sum += weight;
    }
    for (int i = 0; i < kNodes; ++i) {
      nm_[i / kWavelengths][i % kWavelengths] = float(kFirstNm + kStepNm * i);
      weights_[i / kWavelengths][i % kWavelengths] = float(weights[i] / sum);
    }
  }
  float operator()(const UpsampledColor& t) const {
    Spectrum total;
    for (int k = 0; k < kNodes / kWavelengths; ++k) total += t.eval(nm_[k]) * weights_[k];
    return sum(total);
  }

private:
  static constexpr int kNodes = 16;
  static constexpr double kFirstNm = 430, kStepNm = 16;
  Spectrum nm_[kNodes / kWavelengths], weights_[kNodes / kWavelengths];
};

class Bitmap final : public Texture {
public:
  explicit Bitmap(const Properties& properties)
      : Texture(properties), to_uv_(properties.get_transform("to_uv")), grid_(properties.context().grid) {
    nearest_ = properties.get_choice("filter_type", "bilinear", {"bilinear", "nearest"}) == "nearest";
    const std::string wrap = properties.get_choice("wrap_mode", "repeat", {"repeat", "mirror", "clamp"});
    wrap_ = wrap == "repeat" ? Wrap::repeat : wrap == "mirror" ? Wrap::mirror : Wrap::clamp;
    const bool raw = properties.get_bool("raw", false);
    properties.get_choice("format", "auto", {"auto", "variant", "float16", "fp16", "uint8"});
    properties.get_bool("accel", true);
    for (const char* name : {"format", "accel"})
      if (properties.has(name))
        properties.note(name, "has no effect: textures are stored in single precision");
    load(properties, raw);
  }

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    if (colors_.empty()) return eval_scalar(point);
    const Spectrum nm = UpsampledColor::model_range(w.nm);
    return lookup(point, [&](std::size_t i) { return colors_[i].eval(nm); });
  }
  float eval_scalar(const SurfacePoint& point) const override {
    if (!greys_.empty()) return lookup(point, [&](std::size_t i) { return greys_[i]; });
    return lookup(point, [&](std::size_t i) { return number(i); });
  }
  Vec2 gradient(const SurfacePoint& point) const override {
    if (nearest_) return {};  // the derivative is zero almost everywhere
    const Vec2 uv = to_uv_(point.uv);
    const Axis x = axis(uv.x, width_), y = axis(uv.y, height_);
    const std::size_t row0 = std::size_t(y.i0) * width_, row1 = std::size_t(y.i1) * width_;
    const float f00 = number(row0 + x.i0), f10 = number(row0 + x.i1);
    const float f01 = number(row1 + x.i0), f11 = number(row1 + x.i1);
    return to_uv_.gradient({x.slope * ((f10 - f00) * (1 - y.t) + (f11 - f01) * y.t),
                            y.slope * ((f01 - f00) * (1 - x.t) + (f11 - f10) * x.t)});
  }
  bool has_gradient() const override { return true; }
  Vec3 eval_rgb(const SurfacePoint& point) const override {
    return lookup(point, [&](std::size_t i) { return rgbs_.at(i); });
  }
  bool has_rgb() const override { return !rgbs_.empty(); }

  /// Mean over all texels, or over kMeanTexels of them for very large pictures.
  SampledSpectrum average(const Shape*) const override {
    const std::size_t count = std::size_t(width_) * height_, used = std::min(count, kMeanTexels);
    const auto texel = [&](std::size_t i) {
      // Coordinates that are multiples of the golden ratio are distributed evenly for any picture width.
      const double x = double(i) * 0.6180339887498949;
      return used == count ? i : std::min(std::size_t((x - std::floor(x)) * double(count)), count - 1);
    };
    if (colors_.empty()) {
      double sum = 0;
      for (std::size_t i = 0; i < used; ++i) sum += double(number(texel(i)));
      return SampledSpectrum::constant(grid_, float(sum / double(used)));
    }
    constexpr int kBlocks = 64 / kWavelengths;
    std::vector<double> nm(64), mean(64, 0.0);
    for (int k = 0; k < 64; ++k) nm[k] = grid_.min_nm + (grid_.max_nm - grid_.min_nm) * k / 63;
    for (int block = 0; block < kBlocks; ++block) {
      const Spectrum at = UpsampledColor::model_range(
          make_spectrum([&](int j) { return float(nm[block * kWavelengths + j]); }));
      for (std::size_t i = 0; i < used; ++i) {
        const Spectrum s = colors_[texel(i)].eval(at);
        for (int j = 0; j < kWavelengths; ++j) mean[block * kWavelengths + j] += s.v[j];
      }
    }
    for (double& m : mean) m /= double(used);
    return SampledSpectrum::from_points(grid_, nm, mean);
  }
  float maximum() const override { return maximum_; }
  float minimum() const override { return minimum_; }
  std::pair<int, int> resolution() const override { return {width_, height_}; }

private:
  static constexpr std::size_t kMeanTexels = std::size_t(1) << 18;

  /// Two neighbouring texels along one axis, the weight of the second one, and its derivative by the
  /// coordinate.
  struct Axis {
    int i0, i1;
    float t, slope;
  };
  Axis axis(float u, int size) const {
    // The coordinate is wrapped before scaling, so that coordinates of any size, NaN included, stay inside
    // the picture.
    float slope = float(size);
    if (wrap_ == Wrap::repeat)
      u -= std::floor(u);
    else if (wrap_ == Wrap::mirror) {
      u -= 2 * std::floor(0.5f * u);
      if (u > 1) u = 2 - u, slope = -slope;
    }
    u = u > 0 ? std::min(u, 1.f) : 0.f;
    if (nearest_) {
      const int i = std::min(int(u * float(size)), size - 1);
      return {i, i, 0, 0};
    }
    const float p = u * float(size) - 0.5f, base = std::floor(p);
    int i0 = int(base), i1 = i0 + 1;
    if (i0 < 0) i0 = wrap_ == Wrap::repeat ? size - 1 : 0;
    if (i1 >= size) i1 = wrap_ == Wrap::repeat ? 0 : size - 1;
    return {std::min(i0, size - 1), i1, p - base, slope};
  }

  /// Interpolates `value(i)` of the texels at the point.
  template <class Value>
  std::invoke_result_t<Value, std::size_t> lookup(const SurfacePoint& point, const Value& value) const {
    const Vec2 uv = to_uv_(point.uv);
    const Axis x = axis(uv.x, width_), y = axis(uv.y, height_);
    const std::size_t row0 = std::size_t(y.i0) * width_, row1 = std::size_t(y.i1) * width_;
    auto a = value(row0 + x.i0);
    if (nearest_) return a;
    a = a * (1 - x.t) + value(row0 + x.i1) * x.t;
    const auto b = value(row1 + x.i0) * (1 - x.t) + value(row1 + x.i1) * x.t;
    return a * (1 - y.t) + b * y.t;
  }

  /// The value of a texel as one number.
  float number(std::size_t i) const {
    if (!greys_.empty()) return greys_[i];
    if (!rgbs_.empty()) return luminance(rgbs_[i]);
    static const LuminanceRule rule;
    return rule(colors_[i]);
  }

  /// Throws an Error about the first pixel that is negative, if there is one.
  static void refuse_negative(const Properties& properties, const std::string& source, const Image& image,
                              const std::vector<int>& channels) {
    for (int py = 0; py < image.height; ++py)
      for (int px = 0; px < image.width; ++px)
        for (const int c : channels)
          if (const float v = image.at(px, py, std::size_t(c)); v < 0)
            throw properties.error(
                source, "the pixel at column " + std::to_string(px) + ", row " + std::to_string(py) + " is " +
                            shown_number(v) +
                            "; a texture needs values that are not negative (\"raw\" takes them)");
  }

  void load(const Properties& properties, bool raw) {
    auto [image, source] = read_image_parameter(properties, raw ? ImageColors::stored : ImageColors::srgb);
    width_ = image.width;
    height_ = image.height;
    const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
    const int y = image.channel_count() == 1 ? 0 : image.channel("Y");
    const bool color = r >= 0 && g >= 0 && b >= 0;
    if (!color && y < 0) {
      std::string names;
      for (const auto& name : image.channels) names += (names.empty() ? "" : ", ") + name;
      throw properties.error(source, "needs the channels R, G, B or Y, but the picture has " + names);
    }
    if (mend_pixels(properties, source, image, raw ? PixelRange::any : PixelRange::not_negative) && !raw)
      refuse_negative(properties, source, image, color ? std::vector{r, g, b} : std::vector{y});
    const bool decode = image.srgb_encoded && !raw;
    std::array<float, 256> decoded;
    for (int i = 0; i < 256; ++i) decoded[i] = srgb_decode(float(i) / 255);
    const auto value = [&](int px, int py, int c) {
      const float v = image.at(px, py, std::size_t(c));
      if (!decode) return v;
      const float level = v * 255;
      return level <= 255 && level == std::floor(level) ? decoded[int(level)] : srgb_decode(v);
    };
    const std::size_t count = std::size_t(width_) * height_;
    ColorRange values;
    std::mutex mutex;
    // Sets all texels by `set(i, px, py, range)`, which extends the range by the texel's values.
    const auto each_texel = [&](auto&& set) {
      for_rows(width_, height_, [&](std::size_t begin, std::size_t end) {
        ColorRange range;
        for (int py = int(begin); py < int(end); ++py)
          for (int px = 0; px < width_; ++px) set(std::size_t(py) * width_ + px, px, py, range);
        const std::lock_guard lock(mutex);
        values.extend(range);
      });
    };
    bool grey = !color;
    if (color && !raw) {
      // Grey texels are stored as numbers, since they need no spectrum; masks are often stored as colour
      // images.
      grey = true;
      for (std::size_t i = 0; grey && i < count; ++i) {
        const int px = int(i % std::size_t(width_)), py = int(i / std::size_t(width_));
        const float v = image.at(px, py, std::size_t(r));
        grey = v == image.at(px, py, std::size_t(g)) && v == image.at(px, py, std::size_t(b));
      }
    }
    if (grey) {
      greys_.resize(count);
      each_texel([&](std::size_t i, int px, int py, ColorRange& range) {
        greys_[i] = value(px, py, color ? r : y);
        range.extend(greys_[i], greys_[i]);
      });
    } else if (raw) {
      // Raw colours have no spectrum; their scalar value is the luminance.
      rgbs_.resize(count);
      each_texel([&](std::size_t i, int px, int py, ColorRange& range) {
        rgbs_[i] = {value(px, py, r), value(px, py, g), value(px, py, b)};
        range.extend(luminance(rgbs_[i]), luminance(rgbs_[i]));
      });
    } else {
      colors_.resize(count);
      each_texel([&](std::size_t i, int px, int py, ColorRange& range) {
        colors_[i] = UpsampledColor::of_rgb(value(px, py, r), value(px, py, g), value(px, py, b));
        range.extend(colors_[i]);
      });
    }
    std::tie(minimum_, maximum_) = values.values();
  }

  UvTransform to_uv_;
  SpectralGrid grid_;
  bool nearest_ = false;
  Wrap wrap_ = Wrap::repeat;
  int width_ = 0, height_ = 0;
  // Texels; exactly one of the three lists is not empty.
  UnfilledVector<UpsampledColor> colors_;
  UnfilledVector<float> greys_;
  UnfilledVector<Vec3> rgbs_;
  float minimum_ = 0, maximum_ = 0;
};

AUREOLE_PLUGIN(Bitmap, "texture", "bitmap",
               PluginDoc{
                   "A picture. 8- and 16-bit formats are decoded from sRGB, colours are upsampled to spectra "
                   "and the spectra of neighbouring texels are interpolated. Grey pictures have equal values "
                   "at all wavelengths. The first row is at v = 0. Colours with components above one are "
                   "scaled down for the upsampling, and their spectra are scaled back (Mitsuba clamps "
                   "them); in a reflectance they are an error.",
                   "W. Jakob, J. Hanika, A low-dimensional function space for efficient spectral upsampling, "
                   "Computer Graphics Forum 38(2), 2019",
                   {image_file_doc("EXR, PNG, JPEG, TIFF, HDR, TGA or BMP with channels R, G, B or Y"),
                    image_data_doc(),
                    {"filter_type", "string", "", "bilinear", "bilinear, or nearest for no interpolation"},
                    {"wrap_mode", "string", "", "repeat",
                     "values outside uv in [0, 1]: repeat, mirror, or clamp to the edge"},
                    {"raw", "boolean", "", "false",
                     "use values unchanged, for heights, opacities and normals: no decoding, and the "
                     "spectrum of a colour is its luminance at every wavelength"},
                    {"to_uv", "transform", "", "identity", "transform of uv before the look-up"},
                    {"format", "string", "", "auto",
                     "accepted for compatibility with Mitsuba (auto, variant, float16, uint8), no effect"},
                    {"accel", "boolean", "", "true", "accepted for compatibility with Mitsuba, no effect"}},
                   {R"(<texture type="bitmap">
    <string name="filename" value="texture.png"/>
    <string name="wrap_mode" value="mirror"/>
    <transform name="to_uv">
        <scale x="2" y="2"/>
    </transform>
</texture>)",
                    R"(<texture type="bitmap">
    <string name="filename" value="texture.png"/>
    <string name="filter_type" value="nearest"/>
    <boolean name="raw" value="true"/>
    <string name="format" value="variant"/>
    <boolean name="accel" value="false"/>
</texture>)"}});

}  // namespace
}  // namespace aureole
