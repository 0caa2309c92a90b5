// SPDX-License-Identifier: Apache-2.0
// A picture as a texture. Colours become spectra texel by texel, and spectra are interpolated: upsampling is
// not linear, so that interpolated colours would give other spectra. The first row of the picture is at v =
// 0.
#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/upsampling.h"
#include "aureole/texture/texture.h"
#include "aureole/texture/uv_transform.h"

namespace aureole {
namespace {

enum class Wrap { repeat, mirror, clamp };

/// A coloured texel: a sigmoid polynomial times a scale, which is one for colours in [0, 1].
struct alignas(16) ColorTexel {
  float c0 = 0, c1 = 0, c2 = 0, scale = 0;
};

/// SigmoidPolynomial::at for all wavelengths at once; `nm` is in the model's range.
inline Spectrum evaluate(const ColorTexel& t, const Spectrum& nm) {
  const Spectrum x = (nm * t.c0 + t.c1) * nm + t.c2;
  const Spectrum root = sqrt(Spectrum(1.f) + x * x);
  const Spectrum tail = Spectrum(0.5f) / (root * (root + abs(x)));
  return select(x.v < Spectrum(0.f).v, tail, Spectrum(1.f) - tail) * t.scale;
}

inline Spectrum model_range(const Spectrum& nm) {
  return min(max(nm, SigmoidPolynomial::kMinNm), SigmoidPolynomial::kMaxNm);
}

/// Smallest and largest value of a texel over the wavelengths: the sigmoid is monotonic, its argument a
/// parabola.
std::pair<float, float> range_of(const ColorTexel& t) {
  const SigmoidPolynomial p{t.c0, t.c1, t.c2};
  const float a = p.at(SigmoidPolynomial::kMinNm), b = p.at(SigmoidPolynomial::kMaxNm);
  const float vertex = t.c0 != 0 ? p.at(-t.c1 / (2 * t.c0)) : a;  // clamped to the range by `at`
  return {t.scale * std::min({a, b, vertex}), t.scale * std::max({a, b, vertex})};
}

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
    const Vec2 uv = to_uv_(point.uv);
    const Axis x = axis(uv.x, width_), y = axis(uv.y, height_);
    const std::size_t row0 = std::size_t(y.i0) * width_, row1 = std::size_t(y.i1) * width_;
    if (!greys_.empty()) {
      if (nearest_) return greys_[row0 + x.i0];
      const float a = greys_[row0 + x.i0] * (1 - x.t) + greys_[row0 + x.i1] * x.t;
      const float b = greys_[row1 + x.i0] * (1 - x.t) + greys_[row1 + x.i1] * x.t;
      return a * (1 - y.t) + b * y.t;
    }
    const Spectrum nm = model_range(w.nm);
    if (nearest_) return evaluate(colors_[row0 + x.i0], nm);
    const Spectrum a =
        evaluate(colors_[row0 + x.i0], nm) * (1 - x.t) + evaluate(colors_[row0 + x.i1], nm) * x.t;
    const Spectrum b =
        evaluate(colors_[row1 + x.i0], nm) * (1 - x.t) + evaluate(colors_[row1 + x.i1], nm) * x.t;
    return a * (1 - y.t) + b * y.t;
  }

  /// Over all texels (of very large pictures, over kMeanTexels of them).
  SampledSpectrum average() const override {
    const std::size_t count = std::size_t(width_) * height_, used = std::min(count, kMeanTexels);
    const auto texel = [&](std::size_t i) {
      // Multiples of the golden ratio are spread evenly whatever the width.
      const double x = double(i) * 0.6180339887498949;
      return used == count ? i : std::min(std::size_t((x - std::floor(x)) * double(count)), count - 1);
    };
    if (!greys_.empty()) {
      double sum = 0;
      for (std::size_t i = 0; i < used; ++i) sum += greys_[texel(i)];
      return SampledSpectrum::constant(grid_, float(sum / double(used)));
    }
    constexpr int kBlocks = 64 / kWavelengths;
    std::vector<double> nm(64), mean(64, 0.0);
    for (int k = 0; k < 64; ++k) nm[k] = grid_.min_nm + (grid_.max_nm - grid_.min_nm) * k / 63;
    for (int block = 0; block < kBlocks; ++block) {
      const Spectrum at =
          model_range(make_spectrum([&](int j) { return float(nm[block * kWavelengths + j]); }));
      for (std::size_t i = 0; i < used; ++i) {
        const Spectrum s = evaluate(colors_[texel(i)], at);
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

  /// Two neighbouring texels along one axis and the weight of the second.
  struct Axis {
    int i0, i1;
    float t;
  };
  Axis axis(float u, int size) const {
    // Wrapped before it is scaled: coordinates of any size, NaN included, stay inside the picture.
    if (wrap_ == Wrap::repeat)
      u -= std::floor(u);
    else if (wrap_ == Wrap::mirror) {
      u -= 2 * std::floor(0.5f * u);
      u = u > 1 ? 2 - u : u;
    }
    u = u > 0 ? std::min(u, 1.f) : 0.f;
    if (nearest_) {
      const int i = std::min(int(u * float(size)), size - 1);
      return {i, i, 0};
    }
    const float p = u * float(size) - 0.5f, base = std::floor(p);
    int i0 = int(base), i1 = i0 + 1;
    if (i0 < 0) i0 = wrap_ == Wrap::repeat ? size - 1 : 0;
    if (i1 >= size) i1 = wrap_ == Wrap::repeat ? 0 : size - 1;
    return {std::min(i0, size - 1), i1, p - base};
  }

  void load(const Properties& properties, bool raw) {
    const Image image = [&] {
      const std::filesystem::path file = properties.get_file("filename");
      try {
        return read_image(file);
      } catch (const Error& problem) {
        throw properties.error("filename", problem.message());
      }
    }();
    width_ = image.width;
    height_ = image.height;
    const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
    const int y = image.channel_count() == 1 ? 0 : image.channel("Y");
    const bool color = r >= 0 && g >= 0 && b >= 0;
    if (!color && y < 0) {
      std::string names;
      for (const auto& name : image.channels) names += (names.empty() ? "" : ", ") + name;
      throw properties.error("filename", "needs the channels R, G, B or Y, but the picture has " + names);
    }
    const bool decode = image.srgb_encoded && !raw;
    std::array<float, 256> decoded;
    for (int i = 0; i < 256; ++i) decoded[i] = srgb_decode(float(i) / 255);
    const auto value = [&](int px, int py, int c) {
      const float v = image.at(px, py, std::size_t(c));
      if (!(v >= 0) || !std::isfinite(v))
        throw properties.error("filename", "the pixel at column " + std::to_string(px) + ", row " +
                                               std::to_string(py) + " is " + std::to_string(v) +
                                               "; a texture needs finite values that are not negative");
      if (!decode) return v;
      const float level = v * 255;
      return level <= 255 && level == std::floor(level) ? decoded[int(level)] : srgb_decode(v);
    };
    const std::size_t count = std::size_t(width_) * height_;
    minimum_ = kInfinity;
    maximum_ = 0;
    (color && !raw ? colors_.resize(count) : greys_.resize(count));
    for (int py = 0; py < height_; ++py)
      for (int px = 0; px < width_; ++px) {
        const std::size_t i = std::size_t(py) * width_ + px;
        float lower, upper;
        if (color && !raw) {
          colors_[i] = upsample(value(px, py, r), value(px, py, g), value(px, py, b));
          std::tie(lower, upper) = range_of(colors_[i]);
        } else {
          // Of raw colours nobody knows a spectrum; as a number they are their luminance.
          greys_[i] = color ? 0.212671f * value(px, py, r) + 0.715160f * value(px, py, g) +
                                  0.072169f * value(px, py, b)
                            : value(px, py, y);
          lower = upper = greys_[i];
        }
        minimum_ = std::min(minimum_, lower);
        maximum_ = std::max(maximum_, upper);
      }
  }

  static ColorTexel upsample(float r, float g, float b) {
    if (std::max({r, g, b}) <= 1) {
      const SigmoidPolynomial p = upsample_srgb(r, g, b);
      return {p.c0, p.c1, p.c2, 1};
    }
    const UnboundedRgb u = upsample_unbounded(r, g, b);
    return {u.polynomial.c0, u.polynomial.c1, u.polynomial.c2, u.scale};
  }

  UvTransform to_uv_;
  SpectralGrid grid_;
  bool nearest_ = false;
  Wrap wrap_ = Wrap::repeat;
  int width_ = 0, height_ = 0;
  std::vector<ColorTexel> colors_;  // one of the two is empty
  std::vector<float> greys_;
  float minimum_ = 0, maximum_ = 0;
};

AUREOLE_PLUGIN(Bitmap, "texture", "bitmap",
               PluginDoc{
                   "A picture. 8- and 16-bit formats are decoded from sRGB, colours are upsampled to spectra "
                   "and the spectra of "
                   "neighbouring texels interpolated; grey pictures are the same at every wavelength. The "
                   "first row is at v = 0. "
                   "Components over one are scaled down for the upsampling and their spectrum up again "
                   "(Mitsuba clamps them); as a "
                   "reflectance they are an error.",
                   "W. Jakob, J. Hanika, A low-dimensional function space for efficient spectral upsampling, "
                   "Computer Graphics Forum "
                   "38(2), 2019",
                   {{"filename", "file", "", "required",
                     "EXR, PNG, JPEG, TIFF, HDR, TGA or BMP with channels R, G, B or Y"},
                    {"filter_type", "string", "", "bilinear", "bilinear, or nearest for no interpolation"},
                    {"wrap_mode", "string", "", "repeat",
                     "outside uv in [0, 1]: repeat, mirror, or clamp to the edge"},
                    {"raw", "boolean", "", "false",
                     "take the numbers as they are: no decoding, and colours stand for their luminance at "
                     "every wavelength"},
                    {"to_uv", "transform", "", "identity", "applied to uv first"},
                    {"format", "string", "", "auto",
                     "accepted for Mitsuba's sake (auto, variant, float16, uint8), has no effect"},
                    {"accel", "boolean", "", "true", "accepted for Mitsuba's sake, has no effect"}},
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
