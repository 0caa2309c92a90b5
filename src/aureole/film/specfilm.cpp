// SPDX-License-Identifier: Apache-2.0
// A film with many channels: one per named spectral response, or one per wavelength bin.
#include <array>
#include <cmath>

#include "aureole/film/film.h"
#include "aureole/film/spectral_bins.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

using Rows = std::array<std::vector<double>, 3>;

double inner_product(const SampledSpectrum& a, const SampledSpectrum& b) { return product(a, b).integral(); }

/// Solves A x = b for each b; A is symmetric and positive definite, row by row.
void solve(std::vector<double> a, size_t n, Rows& b) {
  for (size_t k = 0; k < n; ++k)  // Cholesky's factorisation A = L L^T
    for (size_t i = k; i < n; ++i) {
      double s = a[i * n + k];
      for (size_t j = 0; j < k; ++j) s -= a[i * n + j] * a[k * n + j];
      a[i * n + k] = i == k ? std::sqrt(s) : s / a[k * n + k];
    }
  for (auto& x : b) {
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = 0; j < i; ++j) x[i] -= a[i * n + j] * x[j];
      x[i] /= a[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
      for (size_t j = i + 1; j < n; ++j) x[i] -= a[j * n + i] * x[j];
      x[i] /= a[i * n + i];
    }
  }
}

/// Returns the edges of the bins in increasing order; the scene may list them in either order.
std::vector<double> bin_edges(const Properties& p) {
  std::vector<double> nm = get_wavelength_list(p, "bin_edges");
  if (nm.front() > nm.back()) std::reverse(nm.begin(), nm.end());
  return nm;
}

/// A response without a stated range may be defined anywhere; it is evaluated over the visible range.
constexpr SpectralGrid kVisible;

WavelengthRange range_of(const SpectrumLiteral& spectrum) {
  if (spectrum.nm.empty()) return {kVisible.min_nm, kVisible.max_nm};
  return {spectrum.nm.front(), spectrum.nm.back()};
}

/// The wavelength range of a nested object that is not built yet.
WavelengthRange range_of(const Properties& nested) {
  const PluginInfo* plugin = nested.plugin();
  if (!plugin || plugin->family != "texture") return {};
  const auto stated = plugin->wavelength_range ? plugin->wavelength_range(nested) : std::nullopt;
  return stated ? *stated : WavelengthRange{kVisible.min_nm, kVisible.max_nm};
}

class SpecFilm final : public Film {
public:
  explicit SpecFilm(const Properties& p) : Film(p) {
    read_common(p);
    pixel_ = read_component_format(p);
    p.get_choice("file_format", "openexr", {"openexr", "exr"});
    preview_ = p.get_bool("preview", true);
    const auto count = p.get_int("bins", 0, {1, 4096});
    const bool by_edges = p.find("bin_edges");
    read_bands(p);
    if (p.has("bins") && by_edges) throw p.error("bins", "give either \"bins\" or \"bin_edges\"");
    has_bins_ = by_edges || p.has("bins");
    if (has_bins_ != bands_.empty())
      throw Error(p.where(), has_bins_ ? "a film has either bins or named responses"
                                       : "a spectral film needs responses, such as <spectrum name=\"red\" "
                                         "value=\"560:0, 610:1, 660:0\"/>, or \"bins\"");
    if (!has_bins_) {
      make_preview_of_bands();
      return;
    }
    const SpectralGrid& grid = p.context().grid;
    const char* source = by_edges ? "bin_edges" : "bins";
    try {
      bins_ =
          by_edges ? SpectralBins(bin_edges(p)) : SpectralBins::equal(grid.min_nm, grid.max_nm, int(count));
    } catch (const Error& e) {
      if (!e.where().file.empty()) throw;
      throw p.error(source, e.message());
    }
    check_range(p, source, bins_.lower(0), bins_.upper(bins_.count() - 1));
    for (int i = 0; i < bins_.count(); ++i) per_width_.push_back(float(1 / bins_.width(i)));
    make_preview_of_bins();
  }

  /// Returns the range in which the responses, or else the bins, are defined.
  static std::optional<WavelengthRange> wavelength_range(const Properties& p) {
    WavelengthRange all;
    for (const Properties::Entry& e : p.entries()) {
      if (e.name == "bin_edges")
        for (const double nm : get_wavelength_list(p, e.name)) all.extend(nm);
      if (const auto* spectrum = Properties::spectrum_of(e.value);
          spectrum && spectrum->kind != SpectrumLiteral::Kind::rgb)
        all.extend(range_of(*spectrum));
      if (const auto* object = std::get_if<ObjectPtr>(&e.value))
        all.extend(range_of((*object)->properties()));
    }
    return all;
  }

  int measured_channels() const override { return has_bins_ ? bins_.count() : int(bands_.size()); }

  void measure(const Spectrum& estimate, const Wavelengths& w, float* out) const override {
    if (!has_bins_) {
      for (const Band& b : bands_) *out++ = sum(estimate * b.response.eval(w));
      return;
    }
    std::fill(out, out + bins_.count(), 0.f);
    for (int i = 0; i < kWavelengths; ++i)
      if (const int bin = bins_.find(w.nm[i]); bin >= 0) out[bin] += estimate[i] * per_width_[size_t(bin)];
  }

  /// Every channel has the same weight, so that narrow ones get enough samples.
  SampledSpectrum response() const override {
    const SpectralGrid& grid = properties().context().grid;
    std::vector<float> nodes(size_t(grid.cells) + 1);
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (has_bins_) {
        const int bin = bins_.find(float(grid.node(int(i))));
        nodes[i] = bin < 0 ? 0.f : per_width_[size_t(bin)];
      }
      for (const Band& b : bands_) nodes[i] += b.response.nodes()[i] / b.integral;
    }
    return {grid, nodes};
  }
  void multiply_response(const SampledSpectrum&) override {
    throw Error(properties().where(),
                "a spectral film has responses of its own: leave the sensor's \"srf\" out");
  }

  std::vector<std::string> channel_names() const override {
    std::vector<std::string> names;
    if (has_bins_) {
      names = bins_.channel_names();
      if (preview_) names.insert(names.begin(), {"R", "G", "B"});
    }
    for (const Band& b : bands_) names.push_back(b.name);
    return names;
  }
  std::vector<std::string> channel_meanings() const override {
    std::vector<std::string> meanings;
    if (has_bins_ && preview_) meanings.assign(3, "preview: colour of the spectrum, linear sRGB");
    for (int i = 0; has_bins_ && i < bins_.count(); ++i)
      meanings.push_back(fmt::format("mean {}spectral {} from {:.6g} to {:.6g} nm, {}", measured_name(),
                                     radiometric_name(measured_kind()), bins_.lower(i), bins_.upper(i),
                                     per_nm()));
    for (std::size_t i = 0; i < bands_.size(); ++i)
      meanings.push_back(fmt::format("integral of response times {}spectral {} over nm, {}", measured_name(),
                                     radiometric_name(measured_kind()), radiometric_unit(measured_kind())));
    return meanings;
  }
  void develop(const double* m, double, float* out) const override {
    if (has_bins_ && preview_) {
      develop_rgb(m, out);
      out += 3;
    }
    for (int i = 0; i < measured_channels(); ++i) out[i] = float(m[i]);
  }
  void develop_rgb(const double* m, float rgb[3]) const override {
    double xyz[3] = {};
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < xyz_[c].size(); ++i) xyz[c] += xyz_[c][i] * m[i];
    if (is_visible_)
      xyz_to_srgb(xyz, rgb);
    else
      std::copy(xyz, xyz + 3, rgb);
  }
  ExrPixel pixel_type() const override { return pixel_; }

private:
  /// Returns the unit of a quantity per nm of wavelength.
  std::string per_nm() const {
    switch (measured_kind()) {
      case MeasuredKind::radiance:
        return "W/(m^2 sr nm)";
      case MeasuredKind::irradiance:
        return "W/(m^2 nm)";
      default:
        return "W/(sr nm)";
    }
  }

  struct Band {
    std::string name;
    SampledSpectrum response;
    float integral;
  };

  static void check_range(const Properties& p, std::string_view name, double first, double last) {
    const SpectralGrid& grid = p.context().grid;
    if (first < grid.min_nm * (1 - 1e-9) || last > grid.max_nm * (1 + 1e-9))
      throw p.error(name, fmt::format("reaches from {:g} to {:g} nm, beyond the film's range of {:g} to {:g}",
                                      first, last, grid.min_nm, grid.max_nm));
  }

  /// Reads all spectra that no other parameter uses.
  void read_bands(const Properties& p) {
    p.find("(any name)");
    for (const Properties::Entry& e : p.entries()) {
      const auto* literal = Properties::spectrum_of(e.value);
      const auto* object = std::get_if<ObjectPtr>(&e.value);
      const auto texture = object ? std::dynamic_pointer_cast<Texture>(*object) : nullptr;
      if (e.used || (!literal && !texture)) continue;
      e.used = true;
      if (e.name.empty()) throw Error(e.where, "a response needs a name, which becomes its channel's");
      if (e.name == "A") throw p.error("A", "the name of a channel for alpha");
      if (literal && literal->kind == SpectrumLiteral::Kind::rgb)
        throw p.error(e.name, "a response is a spectrum, not a colour");
      if (texture && !texture->is_constant())
        throw p.error(e.name, "a response is one spectrum, not a picture");
      if (literal && literal->kind == SpectrumLiteral::Kind::points && !literal->nm.empty())
        check_range(p, e.name, literal->nm.front(), literal->nm.back());
      bands_.push_back({e.name, tabulate(p, e, texture.get()), 0});
      bands_.back().integral = float(bands_.back().response.integral());
      if (!(bands_.back().integral > 0))
        throw p.error(e.name, "the response is zero over the whole range of the film");
    }
  }
  static SampledSpectrum tabulate(const Properties& p, const Properties::Entry& e, const Texture* texture) {
    if (texture && texture->minimum() < 0) throw p.error(e.name, "a response must not be negative");
    if (texture) return texture->average();
    // Other spectra are read through a copy of the properties that declares the name.
    Properties named(p.type(), p.id(), p.where(), p.shared_context());
    named.add(e.name, e.value, e.where);
    return get_texture(named, e.name, 0, SpectrumRole::response)->average();
  }

  /// The preview colour is the colour of the radiance that is a combination of the responses and reproduces
  /// the measured values. Differences of nearly equal responses would amplify noise, and so they get little
  /// weight.
  void make_preview_of_bands() {
    const auto observer = observer_xyz(properties().context().grid);
    const size_t n = bands_.size();
    std::vector<double> gram(n * n);
    double trace = 0;
    for (size_t i = 0; i < n; ++i) {
      for (size_t c = 0; c < 3; ++c) xyz_[c].push_back(inner_product(observer[c], bands_[i].response));
      for (size_t j = 0; j <= i; ++j)
        gram[i * n + j] = gram[j * n + i] = inner_product(bands_[i].response, bands_[j].response);
      trace += gram[i * n + i];
    }
    for (size_t i = 0; i < n; ++i) gram[i * n + i] += 1e-3 * trace / double(n);
    is_visible_ = *std::max_element(xyz_[1].begin(), xyz_[1].end()) > 0;
    if (is_visible_) return solve(std::move(gram), n, xyz_);
    for (auto& row : xyz_)
      for (size_t i = 0; i < n; ++i) row[i] = 1 / (double(bands_[i].integral) * double(n));
  }

  /// The preview colour is the colour of the radiance that is constant in every bin; the mean if no bin is
  /// visible.
  void make_preview_of_bins() {
    const SpectralGrid& grid = properties().context().grid;
    const auto observer = observer_xyz(grid);
    const double range = bins_.upper(bins_.count() - 1) - bins_.lower(0);
    for (size_t c = 0; c < 3; ++c) {
      xyz_[c].resize(size_t(bins_.count()));
      const auto nodes = observer[c].nodes();
      // The range is divided into intervals so small that nearly all of them lie in one bin.
      const int per_cell = std::max(8, int(16.0 * bins_.count() / grid.cells));
      for (int cell = 0; cell < grid.cells; ++cell)
        for (int k = 0; k < per_cell; ++k) {
          const double t = (k + 0.5) / per_cell, nm = grid.node(cell) + t * grid.step();
          const double value = nodes[size_t(cell)] * (1 - t) + nodes[size_t(cell) + 1] * t;
          if (const int bin = bins_.find(float(nm)); bin >= 0)
            xyz_[c][size_t(bin)] += value * grid.step() / per_cell;
        }
    }
    is_visible_ = observer[1].integral() > 1e-3;
    if (is_visible_) return;
    for (auto& row : xyz_)
      for (int i = 0; i < bins_.count(); ++i) row[size_t(i)] = bins_.width(i) / range;
  }

  ExrPixel pixel_;
  bool has_bins_ = false, preview_ = true;
  SpectralBins bins_;
  std::vector<float> per_width_;  ///< inverse width 1 / width of each bin [1/nm]
  std::vector<Band> bands_;
  bool is_visible_ = false;
  Rows xyz_;  ///< maps measured values to the preview's X, Y, Z, or grey if no channel is visible
};

AUREOLE_PLUGIN(
    SpecFilm, "film", "specfilm",
    PluginDoc{
        "Spectral film, for any wavelengths. Either it has named responses: every <spectrum>, whatever its "
        "name, is one, and the channel of that name holds the integral of response times spectral radiance "
        "over the wavelength in nm. Or it has `bins`: each channel holds the mean spectral radiance of a "
        "wavelength interval, in the OpenEXR layout for spectral images (S0.550,00nm for the bin around "
        "550 nm; units W/(m^2 sr nm)).",
        "Fichet, Pacanowski & Wilkie 2021, \"An OpenEXR layout for spectral images\"",
        {{"(any name)", "spectrum", "", "none", "a response, linear between its points; not negative"},
         {"bins", "integer", "", "none", "number of equal bins from wavelength_min to wavelength_max"},
         {"bin_edges", "string", "nm", "none",
          "instead of `bins`: the edges of contiguous bins, in increasing or decreasing order; with units "
          "\"29GHz, 28GHz, 27GHz\""},
         {"preview", "boolean", "", "true",
          "bins: also store their colour as R, G, B for viewers without support of spectra (the mean if no "
          "bin is visible)"},
         {"file_format", "string", "", "openexr", "openexr"},
         {"wavelength_min", "wavelength", "nm", "minimum of the responses or edges, or 360",
          "shortest wavelength; a number in nm or \"300nm\", \"0.3um\", \"10GHz\""},
         {"wavelength_max", "wavelength", "nm", "maximum of the responses or edges, or 830",
          "longest wavelength"}},
        {R"(<film type="specfilm">
    <integer name="width" value="320"/> <integer name="height" value="240"/>
    <spectrum name="near_infrared" value="780:0, 800:1, 820:0"/>
    <spectrum name="green" value="500:0, 550:1, 600:0"/>
    <string name="component_format" value="float32"/>
</film>)",
         R"(<film type="specfilm">
    <float name="wavelength_min" value="400"/> <float name="wavelength_max" value="700"/>
    <integer name="bins" value="30"/>
    <boolean name="preview" value="false"/>
    <rfilter type="box"/>
</film>)",
         R"(<film type="specfilm">
    <string name="bin_edges" value="400, 480, 510, 600, 0.7um"/>
</film>)"}});

}  // namespace
}  // namespace aureole
