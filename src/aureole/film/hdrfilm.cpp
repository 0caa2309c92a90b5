// SPDX-License-Identifier: Apache-2.0
// High-dynamic-range film: measures CIE XYZ (or the mean spectral radiance of another band) and stores
// OpenEXR.
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
    const std::string format =
        p.get_choice("pixel_format", "rgb", {"rgb", "rgba", "xyz", "xyza", "luminance", "luminance_alpha"});
    alpha_ = format == "rgba" || format == "xyza" || format == "luminance_alpha";
    kind_ = format.starts_with("rgb") ? Kind::rgb : format.starts_with("xyz") ? Kind::xyz : Kind::luminance;
    pixel_ = p.get_choice("component_format", "float16", {"float16", "float32"}) == "float16"
                 ? ExrPixel::half
                 : ExrPixel::float32;
    p.get_choice("file_format", "openexr", {"openexr", "exr"});
    // The scene reader has already turned these two into the grid.
    p.find("wavelength_min");
    p.find("wavelength_max");
    const SpectralGrid& grid = p.context().grid;
    uniform_ = p.get_choice("response", "cie1931", {"cie1931", "uniform"}) == "uniform";
    if (!uniform_) {
      observer_ = observer_xyz(grid);
      if (observer_[1].integral() < 1e-3)
        throw p.error("response",
                      "the wavelength range lies outside the visible, where the CIE observer sees nothing; "
                      "use response \"uniform\"");
    }
  }

  int measured_channels() const override { return uniform_ ? 1 : 3; }

  void measure(const Spectrum& estimate, const Wavelengths& w, float* out) const override {
    if (uniform_) {
      const SpectralGrid& grid = properties().context().grid;
      out[0] = sum(estimate) * float(1 / (grid.max_nm - grid.min_nm));
      return;
    }
    for (int c = 0; c < 3; ++c) out[c] = sum(estimate * observer_[size_t(c)].eval(w));
  }

  SampledSpectrum response() const override {
    const SpectralGrid& grid = properties().context().grid;
    if (uniform_) return SampledSpectrum::constant(grid, 1);
    std::vector<float> nodes(size_t(grid.cells) + 1);
    for (size_t i = 0; i < nodes.size(); ++i)
      for (const auto& o : observer_) nodes[i] += o.nodes()[i];
    return {grid, nodes};
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

private:
  enum class Kind { rgb, xyz, luminance } kind_;
  bool alpha_ = false, uniform_ = false;
  ExrPixel pixel_;
  std::array<SampledSpectrum, 3> observer_;
};

AUREOLE_PLUGIN(
    HdrFilm, "film", "hdrfilm",
    PluginDoc{"Film that measures the CIE 1931 tristimulus values of the spectral radiance, scaled so that a "
              "flat spectrum of radiance 1 has luminance "
              "Y = 1, and stores linear sRGB, XYZ or luminance in OpenEXR. With `response` \"uniform\" it "
              "measures the mean of the "
              "spectral radiance over its wavelength range, for work outside the visible.",
              "CIE 15:2018, section 7",
              {{"width", "integer", "pixels", "768", "width of the film"},
               {"height", "integer", "pixels", "576", "height of the film"},
               {"crop_offset_x", "integer", "pixels", "0", "left edge of the rendered part"},
               {"crop_offset_y", "integer", "pixels", "0", "top edge of the rendered part"},
               {"crop_width", "integer", "pixels", "width", "width of the rendered part"},
               {"crop_height", "integer", "pixels", "height", "height of the rendered part"},
               {"sample_border", "boolean", "", "false",
                "also sample beyond the border, as far as the filter reaches"},
               {"rfilter", "rfilter", "", "gaussian", "reconstruction filter"},
               {"pixel_format", "string", "", "rgb", "rgb, rgba, xyz, xyza, luminance or luminance_alpha"},
               {"component_format", "string", "", "float16", "float16 or float32"},
               {"file_format", "string", "", "openexr", "openexr"},
               {"wavelength_min", "wavelength", "nm", "360",
                "shortest wavelength; a number in nm or \"300nm\", \"0.3um\", \"10GHz\""},
               {"wavelength_max", "wavelength", "nm", "830", "longest wavelength"},
               {"response", "string", "", "cie1931", "cie1931 (XYZ) or uniform (the band's mean)"}},
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
