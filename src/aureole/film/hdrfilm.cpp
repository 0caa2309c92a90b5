// SPDX-License-Identifier: Apache-2.0
// High-dynamic-range film: measures CIE XYZ, or the mean spectral radiance of another band.
#include <algorithm>
#include <cmath>

#include "aureole/film/film.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"

namespace aureole {
namespace {

class HdrFilm final : public Film {
public:
  explicit HdrFilm(const Properties& p) : Film(p) {
    read_common(p);
    pixel_ = read_component_format(p);
    std::string format =
        p.get_choice("pixel_format", "rgb", {"rgb", "rgba", "xyz", "xyza", "luminance", "luminance_alpha"});
    const std::string file = p.get_choice("file_format", "openexr", {"openexr", "exr", "rgbe", "pfm"});
    if (file == "rgbe" || file == "pfm") {
      extension_ = file == "rgbe" ? ".hdr" : ".pfm";
      if (format != "rgb" && !(file == "pfm" && format == "luminance")) {
        p.note("pixel_format", "\"" + file + "\" files cannot hold \"" + format + "\": stored as \"rgb\"");
        format = "rgb";
      }
    }
    alpha_ = format == "rgba" || format == "xyza" || format == "luminance_alpha";
    kind_ = format.starts_with("rgb") ? Kind::rgb : format.starts_with("xyz") ? Kind::xyz : Kind::luminance;

    const SpectralGrid& grid = p.context().grid;
    uniform_ = p.get_choice("response", "cie1931", {"cie1931", "uniform"}) == "uniform";
    if (uniform_) {
      response_ = {SampledSpectrum::constant(grid, float(1 / (grid.max_nm - grid.min_nm)))};
      return;
    }
    const auto observer = observer_xyz(grid);
    response_.assign(observer.begin(), observer.end());
    // The threshold is proportional to the range, so that narrow bands of visible light are accepted.
    constexpr SpectralGrid kVisible;
    const double share = std::min(1.0, (grid.max_nm - grid.min_nm) / (kVisible.max_nm - kVisible.min_nm));
    if (response_[1].integral() < 1e-3 * share)
      throw p.error("response",
                    "the wavelength range lies outside the visible, where the CIE observer sees nothing; "
                    "use response \"uniform\"");
  }

  int measured_channels() const override { return int(response_.size()); }

  void measure(const Spectrum& estimate, const Wavelengths& w, float* out) const override {
    for (const SampledSpectrum& r : response_) *out++ = sum(estimate * r.eval(w));
  }

  SampledSpectrum response() const override {
    std::vector<float> nodes(response_[0].nodes().size());
    for (const auto& r : response_)
      for (size_t i = 0; i < nodes.size(); ++i) nodes[i] += r.nodes()[i];
    return {response_[0].grid(), nodes};
  }
  void multiply_response(const SampledSpectrum& factor) override {
    for (auto& r : response_) r = product(r, factor);
  }

  std::vector<std::string> channel_names() const override {
    std::vector<std::string> names;
    if (uniform_ || kind_ == Kind::luminance)
      names = {"Y"};
    else if (kind_ == Kind::xyz)
      names = {"X", "Y", "Z"};
    else
      names = {"R", "G", "B"};
    if (alpha_) names.push_back("A");
    return names;
  }

  std::vector<std::string> channel_meanings() const override {
    std::vector<std::string> meanings;
    for (const std::string& name : channel_names())
      meanings.push_back(
          name == "A"          ? "alpha: 1 where shapes or a visible environment are, 0 where nothing is"
          : uniform_           ? "mean over the film's wavelengths of what the sensor measures"
          : kind_ == Kind::rgb ? "linear sRGB, scene-referred; 1, 1, 1 has luminance 1"
          : kind_ == Kind::luminance ? "luminance; 1 for a flat spectrum of radiance 1"
                                     : "CIE 1931 XYZ; Y is 1 for a flat spectrum of radiance 1");
    return meanings;
  }

  void develop(const double* m, double alpha, float* out) const override {
    int n = 1;
    if (uniform_) {
      out[0] = float(m[0]);
    } else if (kind_ == Kind::luminance) {
      out[0] = float(m[1]);
    } else if (kind_ == Kind::xyz) {
      for (n = 0; n < 3; ++n) out[n] = float(m[n]);
    } else {
      xyz_to_srgb(m, out);
      n = 3;
    }
    if (alpha_) out[n] = float(alpha);
  }

  void develop_rgb(const double* m, float rgb[3]) const override {
    if (uniform_)
      rgb[0] = rgb[1] = rgb[2] = float(m[0]);
    else
      xyz_to_srgb(m, rgb);
  }

  ExrPixel pixel_type() const override { return pixel_; }
  std::string file_extension() const override { return extension_; }

private:
  enum class Kind { rgb, xyz, luminance } kind_;
  bool alpha_ = false, uniform_ = false;
  ExrPixel pixel_;
  std::string extension_ = ".exr";
  std::vector<SampledSpectrum> response_;  ///< responses of X, Y, Z, or of the band [1/nm]
};

AUREOLE_PLUGIN(
    HdrFilm, "film", "hdrfilm",
    PluginDoc{"Film that measures the CIE 1931 tristimulus values of the spectral radiance, scaled so that a "
              "flat spectrum of radiance 1 has luminance Y = 1, and stores linear sRGB, XYZ or luminance. "
              "With `response` \"uniform\" it measures the mean of the spectral radiance over its wavelength "
              "range, for work outside the visible.",
              "CIE 15:2018, section 7",
              {{"pixel_format", "string", "", "rgb", "rgb, rgba, xyz, xyza, luminance or luminance_alpha"},
               {"file_format", "string", "", "openexr",
                "openexr; rgbe (Radiance .hdr, rgb only); pfm (rgb or luminance). The extension of a name "
                "given by -o takes precedence"},
               {"wavelength_min", "wavelength", "nm", "360",
                "shortest wavelength; a number in nm or \"300nm\", \"0.3um\", \"10GHz\""},
               {"wavelength_max", "wavelength", "nm", "830", "longest wavelength"},
               {"response", "string", "", "cie1931", "cie1931 (XYZ) or uniform (mean over the band)"}},
              {R"(<film type="hdrfilm">
    <integer name="width" value="320"/> <integer name="height" value="240"/>
    <integer name="crop_offset_x" value="16"/> <integer name="crop_offset_y" value="16"/>
    <integer name="crop_width" value="64"/> <integer name="crop_height" value="64"/>
    <boolean name="sample_border" value="true"/>
    <string name="pixel_format" value="rgba"/> <string name="component_format" value="float32"/>
    <string name="file_format" value="openexr"/>
    <string name="wavelength_min" value="380nm"/> <float name="wavelength_max" value="780"/>
    <string name="response" value="cie1931"/>
    <rfilter type="gaussian"/>
</film>)"}});

}  // namespace
}  // namespace aureole
