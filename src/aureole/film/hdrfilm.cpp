// SPDX-License-Identifier: Apache-2.0
// High-dynamic-range film: measures CIE XYZ, or the mean spectral radiance of another band.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/film/film.h"
#include "aureole/optics/photometry/glare.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/photometry.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

/// A quantity that a film measures in absolute units.
struct FilmQuantity {
  const char *name, *words, *unit;
  MeasuredKind kind;
  SampledSpectrum (*weight)(const SpectralGrid&);
  bool over_time = false;  ///< multiplied by the duration of the exposure
  bool is_flux = false;    ///< multiplied by the area of a pixel
};

SampledSpectrum one(const SpectralGrid& grid) { return SampledSpectrum::constant(grid, 1); }
/// Stands for `mesopic_efficacy`, which depends on the adaptation.
SampledSpectrum mesopic(const SpectralGrid& grid) { return mesopic_efficacy(grid, 1); }

constexpr FilmQuantity kQuantities[] = {
    {"radiance", "radiance", "W/(m^2 sr)", MeasuredKind::radiance, one},
    {"irradiance", "irradiance", "W/m^2", MeasuredKind::irradiance, one},
    {"intensity", "radiant intensity", "W/sr", MeasuredKind::intensity, one},
    {"photon_radiance", "photon radiance", "umol/(s m^2 sr)", MeasuredKind::radiance, photons_per_joule},
    {"photon_irradiance", "photon irradiance", "umol/(s m^2)", MeasuredKind::irradiance, photons_per_joule},
    {"photon_intensity", "photon intensity", "umol/(s sr)", MeasuredKind::intensity, photons_per_joule},
    {"luminance", "luminance", "cd/m^2", MeasuredKind::radiance, photopic_efficacy},
    {"illuminance", "illuminance", "lx", MeasuredKind::irradiance, photopic_efficacy},
    {"luminous_intensity", "luminous intensity", "cd", MeasuredKind::intensity, photopic_efficacy},
    {"scotopic_luminance", "scotopic luminance", "cd/m^2", MeasuredKind::radiance, scotopic_efficacy},
    {"scotopic_illuminance", "scotopic illuminance", "lx", MeasuredKind::irradiance, scotopic_efficacy},
    {"scotopic_intensity", "scotopic luminous intensity", "cd", MeasuredKind::intensity, scotopic_efficacy},
    {"judd_vos_luminance", "luminance by V_M of Judd and Vos", "cd/m^2", MeasuredKind::radiance,
     modified_photopic_efficacy},
    {"judd_vos_illuminance", "illuminance by V_M of Judd and Vos", "lx", MeasuredKind::irradiance,
     modified_photopic_efficacy},
    {"judd_vos_intensity", "luminous intensity by V_M of Judd and Vos", "cd", MeasuredKind::intensity,
     modified_photopic_efficacy},
    {"mesopic_luminance", "mesopic luminance", "cd/m^2", MeasuredKind::radiance, mesopic},
    {"mesopic_illuminance", "mesopic illuminance", "lx", MeasuredKind::irradiance, mesopic},
    {"mesopic_intensity", "mesopic luminous intensity", "cd", MeasuredKind::intensity, mesopic},
    {"radiant_flux", "radiant flux", "W", MeasuredKind::irradiance, one, false, true},
    {"photon_flux", "photon flux", "umol/s", MeasuredKind::irradiance, photons_per_joule, false, true},
    {"luminous_flux", "luminous flux", "lm", MeasuredKind::irradiance, photopic_efficacy, false, true},
    {"scotopic_flux", "scotopic luminous flux", "lm", MeasuredKind::irradiance, scotopic_efficacy, false,
     true},
    {"radiant_energy", "radiant energy", "J", MeasuredKind::irradiance, one, true, true},
    {"photon_number", "number of photons", "umol", MeasuredKind::irradiance, photons_per_joule, true, true},
    {"luminous_energy", "luminous energy", "lm s", MeasuredKind::irradiance, photopic_efficacy, true, true},
    {"time_integrated_radiance", "time-integrated radiance", "J/(m^2 sr)", MeasuredKind::radiance, one, true},
    {"radiant_exposure", "radiant exposure", "J/m^2", MeasuredKind::irradiance, one, true},
    {"time_integrated_intensity", "time-integrated radiant intensity", "J/sr", MeasuredKind::intensity, one,
     true},
    {"photon_exposure", "photon exposure", "umol/m^2", MeasuredKind::irradiance, photons_per_joule, true},
    {"time_integrated_luminance", "time-integrated luminance", "cd s/m^2", MeasuredKind::radiance,
     photopic_efficacy, true},
    {"luminous_exposure", "luminous exposure", "lx s", MeasuredKind::irradiance, photopic_efficacy, true},
    {"time_integrated_luminous_intensity", "time-integrated luminous intensity", "cd s",
     MeasuredKind::intensity, photopic_efficacy, true}};

/// A unit beside the SI's own, with its size in the SI unit.
struct FilmUnit {
  const char *name, *of;
  double size;
};
constexpr FilmUnit kFilmUnits[] = {
    {"nit", "cd/m^2", 1},     {"kcd/m^2", "cd/m^2", 1e3}, {"fL", "cd/m^2", 3.4262590996},
    {"klx", "lx", 1e3},       {"fc", "lx", 10.763910417}, {"kcd", "cd", 1e3},
    {"mW/cm^2", "W/m^2", 10}, {"mW", "W", 1e-3},          {"kW", "W", 1e3},
    {"klm", "lm", 1e3},       {"mJ", "J", 1e-3},          {"lm h", "lm s", 3600}};

std::vector<std::string> quantity_names() {
  std::vector<std::string> names{"relative"};
  for (const FilmQuantity& q : kQuantities) names.emplace_back(q.name);
  return names;
}

class HdrFilm final : public Film {
public:
  explicit HdrFilm(const Properties& p) : Film(p) {
    read_common(p);
    pixel_ = read_component_format(p);
    const std::string quantity = p.get_choice("quantity", "relative", quantity_names());
    for (const FilmQuantity& q : kQuantities)
      if (quantity == q.name) quantity_ = &q;
    // Absolute values default to float32, since they exceed the range of 16 bits: 65504 cd/m^2 is less than
    // the luminance of a lamp.
    if (quantity_ && !p.has("component_format")) pixel_ = ExrPixel::float32;
    read_unit(p);
    std::string format = p.get_choice("pixel_format", quantity_ ? "luminance" : "rgb",
                                      {"rgb", "rgba", "xyz", "xyza", "luminance", "luminance_alpha"});
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

    read_adaptation(p);
    const SpectralGrid& grid = p.context().grid;
    uniform_ = p.get_choice("response", "cie1931", {"cie1931", "uniform"}) == "uniform";
    if (quantity_) {
      read_quantity(p);
      return;
    }
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
  bool measures_flux() const override { return quantity_ && quantity_->is_flux; }
  bool integrates_over_time() const override { return quantity_ && quantity_->over_time; }
  void set_exposure(double seconds) override {
    if (!integrates_over_time()) return;
    if (!(seconds > 0))
      throw properties().error("quantity", "\"" + std::string(quantity_->name) +
                                               "\" is an integral over the exposure: the sensor needs "
                                               "\"shutter_open\" and a later \"shutter_close\"");
    for (auto& r : response_) r.scale(float(seconds));
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
          : quantity_          ? absolute_meaning()
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
      rgb[0] = rgb[1] = rgb[2] = float(m[0] / white_);
    else
      xyz_to_srgb(m, rgb);
    if (!uniform_ && white_ != 1)
      for (int c = 0; c < 3; ++c) rgb[c] = float(rgb[c] / white_);
  }

  ExrPixel pixel_type() const override { return pixel_; }
  std::string file_extension() const override { return extension_; }

protected:
  void check_kind(MeasuredKind kind) const override {
    if (!quantity_ || quantity_->kind == kind) return;
    std::string fitting;
    for (const FilmQuantity& q : kQuantities)
      if (q.kind == kind) fitting += (fitting.empty() ? "" : ", ") + std::string(q.name);
    throw properties().error(
        "quantity", "the sensor of this film measures " + std::string(radiometric_name(kind)) +
                        ", of which the quantities are " + fitting + ", not \"" + quantity_->name + "\"");
  }

private:
  void read_unit(const Properties& p) {
    white_ = p.get_float("white", 1, Range::positive());
    const std::string unit = p.get_string("unit", "");
    if (!p.has("unit")) {
      unit_ = quantity_ ? quantity_->unit : "";
      return;
    }
    if (!quantity_) throw p.error("unit", "needs the \"quantity\" of which it is the unit");
    std::vector<std::string> names{quantity_->unit};
    unit_ = unit;
    if (unit == quantity_->unit) return;
    for (const FilmUnit& u : kFilmUnits)
      if (quantity_->unit == std::string(u.of)) {
        names.emplace_back(u.name);
        if (unit == u.name) {
          unit_size_ = u.size;
          return;
        }
      }
    throw p.error("unit", "\"" + unit + "\" is no unit of the quantity \"" + quantity_->name + "\"" +
                              did_you_mean_or_all(unit, names));
  }

  /// Reads what the eye is adapted to, for mesopic quantities.
  void read_adaptation(const Properties& p) {
    const bool is_mesopic = quantity_ && quantity_->weight == mesopic;
    if (is_mesopic && !p.has("adaptation_luminance"))
      throw p.error(
          "adaptation_luminance",
          "\"adaptation_luminance\" is needed: mesopic vision depends on the luminance that the eye is adapted to");
    const double luminance = p.get_float("adaptation_luminance", 1, {0, 1e9, true}),
                 ratio = p.get_float("scotopic_to_photopic", 1, {0, 100, true});
    if (is_mesopic) {
      adaptation_ = optics::mesopic_luminance(luminance, ratio);
      return;
    }
    for (const char* name : {"adaptation_luminance", "scotopic_to_photopic"})
      if (p.has(name))
        p.note(name, "has no effect: only mesopic quantities depend on the adaptation of the eye");
  }

  /// Sets the responses of an absolute quantity.
  void read_quantity(const Properties& p) {
    const SpectralGrid& grid = p.context().grid;
    if (p.has("response")) p.note("response", "has no effect: the quantity decides the response");
    const bool has_colours = quantity_->weight == photopic_efficacy && kind_ != Kind::luminance;
    if (quantity_->weight == photopic_efficacy && !covers_photopic_vision(grid))
      throw p.error("quantity", "the film's wavelengths do not cover the visible, from 380 to 780 nm");
    if (has_colours) {
      // Sets the tristimulus values, with Y in the unit of the quantity.
      const auto observer = observer_xyz(grid);
      response_.assign(observer.begin(), observer.end());
      for (SampledSpectrum& r : response_) r.scale(float(kPhotopicEfficacy * cie_y_integral() / unit_size_));
      uniform_ = false;
      return;
    }
    if (kind_ != Kind::luminance) {
      p.note("pixel_format", "the quantity \"" + std::string(quantity_->name) + "\" has one channel");
      kind_ = Kind::luminance;
    }
    response_ = {quantity_->weight == mesopic ? mesopic_efficacy(grid, adaptation_.m)
                                              : quantity_->weight(grid)};
    response_[0].scale(float(1 / unit_size_));
    uniform_ = true;
    if (!(response_[0].maximum() > 0)) throw p.error("quantity", "is zero at all wavelengths of the film");
  }

  std::string absolute_meaning() const {
    std::string words = measured_name() + quantity_->words;
    if (quantity_->weight == mesopic) words += fmt::format(" (CIE 191, m = {:.4f})", adaptation_.m);
    if (uniform_) return words + ", " + unit_;
    return (kind_ == Kind::rgb ? "linear sRGB; 1, 1, 1 has " : "CIE 1931 XYZ; Y is ") + words +
           (kind_ == Kind::rgb ? " 1 " : ", ") + unit_;
  }

  enum class Kind { rgb, xyz, luminance } kind_;
  bool alpha_ = false, uniform_ = false;
  const FilmQuantity* quantity_ = nullptr;  ///< measured quantity; null: relative values
  optics::MesopicLuminance adaptation_{};   ///< of the eye, for mesopic quantities
  std::string unit_;
  /// size of the unit in the SI unit; the value that the preview shows as white
  double unit_size_ = 1, white_ = 1;
  ExrPixel pixel_;
  std::string extension_ = ".exr";
  std::vector<SampledSpectrum> response_;  ///< responses of X, Y, Z, or of the band [1/nm]
};

AUREOLE_PLUGIN(
    HdrFilm, "film", "hdrfilm",
    PluginDoc{
        "Film that measures the CIE 1931 tristimulus values of the spectral radiance, scaled so that a "
        "flat spectrum of radiance 1 has luminance Y = 1, and stores linear sRGB, XYZ or luminance. "
        "With `response` \"uniform\" it measures the mean of the spectral radiance over its wavelength "
        "range, for work outside the visible. With a `quantity` it stores that in its unit, which the header of the "
        "picture states; emitters must then be absolute (`photometric`, `blackbody`, or with an `amount`).",
        "CIE 15:2018, section 7",
        {{"pixel_format", "string", "", "rgb", "rgb, rgba, xyz, xyza, luminance or luminance_alpha"},
         {"file_format", "string", "", "openexr",
          "openexr; rgbe (Radiance .hdr, rgb only); pfm (rgb or luminance). The extension of a name "
          "given by -o takes precedence"},
         {"wavelength_min", "wavelength", "nm", "360",
          "shortest wavelength; a number in nm or \"300nm\", \"0.3um\", \"10GHz\""},
         {"wavelength_max", "wavelength", "nm", "830", "longest wavelength"},
         {"response", "string", "", "cie1931", "cie1931 (XYZ) or uniform (mean over the band)"},
         {"quantity", "string", "", "relative",
          "relative, or an absolute quantity of the kind that the sensor measures. Of a camera: radiance, "
          "photon_radiance, luminance, scotopic_luminance, judd_vos_luminance, mesopic_luminance; of a meter or a grid of "
          "receivers: irradiance, photon_irradiance, illuminance, scotopic_illuminance, judd_vos_illuminance, "
          "mesopic_illuminance, and as power through each pixel radiant_flux, photon_flux, luminous_flux, scotopic_flux; of a "
          "goniophotometer: intensity, photon_intensity, luminous_intensity, scotopic_intensity, judd_vos_intensity, "
          "mesopic_intensity. Integrals over the exposure: radiant_energy, photon_number, luminous_energy; "
          "time_integrated_radiance, time_integrated_luminance; radiant_exposure, luminous_exposure, photon_exposure; "
          "time_integrated_intensity, time_integrated_luminous_intensity. One channel Y in float32; luminance, "
          "illuminance and luminous_intensity also have colours by pixel_format, with Y in the unit"},
         {"unit", "string", "", "that of the SI",
          "unit of the quantity: cd/m^2, nit, kcd/m^2 or fL; lx, klx or fc; cd or kcd; W/m^2 or mW/cm^2; W, mW or kW; lm or "
          "klm; J or mJ; lm s or lm h"},
         {"adaptation_luminance", "float", "cd/m^2", "none",
          "for mesopic quantities: photopic luminance that the eye is adapted to"},
         {"scotopic_to_photopic", "float", "", "1",
          "for mesopic quantities: ratio S/P of that luminance, scotopic over photopic"},
         {"white", "float", "", "1", "value that the PNG beside the picture shows as white"}},
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
</film>)",
         R"(<film type="hdrfilm"><string name="quantity" value="luminance"/><string name="unit" value="nit"/>
    <float name="white" value="300"/></film>)",
         R"(<film type="hdrfilm"><string name="quantity" value="mesopic_luminance"/>
    <float name="adaptation_luminance" value="0.3"/><float name="scotopic_to_photopic" value="2.1"/></film>)"}});

}  // namespace
}  // namespace aureole
