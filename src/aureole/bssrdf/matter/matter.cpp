// SPDX-License-Identifier: Apache-2.0
#include "aureole/bssrdf/matter/matter.h"

#include <algorithm>
#include <string>
#include <utility>

#include "aureole/medium/medium.h"
#include "aureole/phase/mean_cosine.h"

namespace aureole {

namespace {

constexpr const char* kColour[] = {"reflectance", "mean_free_path"};
constexpr const char* kCoefficients[] = {"sigma_a", "sigma_s", "sigma_t", "albedo", "g"};

void refuse(const Properties& p, std::initializer_list<const char*> names, const std::string& why) {
  for (const char* name : names)
    if (p.has(name)) throw p.error(name, why);
}

/// Returns a spectrum on the scene's grid; an error if it varies over the surface.
SampledSpectrum get_spectrum(const Properties& p, const char* name, double fallback, SpectrumRole role) {
  const TexturePtr texture = get_texture(p, name, fallback, role);
  if (!texture->is_constant()) throw p.error(name, "varies over the surface; here one spectrum is needed");
  return texture->average();
}

/// Tabulates the coefficients of a uniform medium at the nodes of the grid.
Matter tabulate(const Medium& medium, const SpectralGrid& grid) {
  const std::size_t nodes = std::size_t(grid.cells) + 1;
  Matter m{std::vector<double>(nodes), std::vector<double>(nodes), std::vector<double>(nodes)};
  for (std::size_t first = 0; first < nodes; first += kWavelengths) {
    const auto node = [&](int i) { return std::min(first + std::size_t(i), nodes - 1); };
    const Wavelengths w =
        Wavelengths::at(grid, make_spectrum([&](int i) { return float(grid.node(int(node(i)))); }));
    MediumCoefficients c;
    medium.eval({}, {0, 0, 1}, w, c);
    std::array<double, kWavelengths> g{};
    if (any(c.sigma_s.v > 0.f)) g = mean_cosine(medium.phase(), {}, {}, w);
    for (int i = 0; i < kWavelengths; ++i) {
      m.absorption[node(i)] = std::max(double(c.sigma_t[i]) - double(c.sigma_s[i]), 0.0);
      m.scattering[node(i)] = double(c.sigma_s[i]), m.asymmetry[node(i)] = g[std::size_t(i)];
    }
  }
  return m;
}

Matter of_medium(const Properties& p, const Medium& medium) {
  if (!medium.is_uniform() || !medium.phase().is_uniform())
    throw Error(medium.properties().where(), "varies in space; a bssrdf needs the same medium everywhere");
  if (!medium.phase().is_isotropic_medium())
    throw Error(medium.properties().where(),
                "scatters differently in different directions; a bssrdf needs a medium that does not");
  if (medium.emits()) medium.properties().note("emission", "a bssrdf does not emit: no effect");
  const auto matter = p.shared_model<Matter>(
      [&] { return std::make_shared<const Matter>(tabulate(medium, p.context().grid)); });
  if (matter) return *matter;
  // In a scene with errors the medium may lack its tables; such a scene is not rendered.
  const std::vector<double> ones(std::size_t(p.context().grid.cells) + 1, 1);
  return {ones, ones, std::vector<double>(ones.size())};
}

Matter of_coefficients(const Properties& p) {
  const bool by_parts = p.has("sigma_a") || p.has("sigma_s");
  if (by_parts)
    refuse(p, {"sigma_t", "albedo"}, "give either \"sigma_t\" and \"albedo\" or \"sigma_a\" and \"sigma_s\"");
  // All coefficients are read before use, so that each is checked.
  const SampledSpectrum absorption = get_spectrum(p, "sigma_a", 0, SpectrumRole::unbounded);
  const SampledSpectrum scattering = get_spectrum(p, "sigma_s", 0, SpectrumRole::unbounded);
  const SampledSpectrum extinction = get_spectrum(p, "sigma_t", 1, SpectrumRole::unbounded);
  const SampledSpectrum albedo = get_spectrum(p, "albedo", 0.75, SpectrumRole::reflectance);
  const double g = p.get_float("g", 0, {-1, 1});
  const std::size_t nodes = absorption.nodes().size();
  Matter m{std::vector<double>(nodes), std::vector<double>(nodes), std::vector<double>(nodes)};
  for (std::size_t i = 0; i < nodes; ++i) {
    const double t = double(extinction.nodes()[i]), a = std::min(double(albedo.nodes()[i]), 1.0);
    m.absorption[i] = by_parts ? double(absorption.nodes()[i]) : t * (1 - a);
    m.scattering[i] = by_parts ? double(scattering.nodes()[i]) : t * a;
    m.asymmetry[i] = g;
  }
  return m;
}

}  // namespace

bool is_shown_matter(const Properties& p) { return p.has("reflectance") || p.has("mean_free_path"); }

ShownMatter read_shown_matter(const Properties& p) {
  for (const char* name : kColour)
    if (!p.has(name))
      throw p.error(name, "\"reflectance\" and \"mean_free_path\" belong together: \"" + std::string(name) +
                              "\" is missing");
  for (const char* name : kCoefficients)
    refuse(p, {name}, "give either \"reflectance\" and \"mean_free_path\" or coefficients");
  if (const MediumPtr medium = only_medium(p))
    throw Error(medium->properties().where(),
                "give either \"reflectance\" and \"mean_free_path\" or a medium");
  ShownMatter m{get_texture(p, "reflectance", 0.5, SpectrumRole::reflectance),
                get_spectrum(p, "mean_free_path", 1, SpectrumRole::unbounded)};
  const double scale = p.get_float("scale", 1, Range::positive());
  m.mean_free_path.scale(float(1 / scale));
  if (!(m.mean_free_path.minimum() > 0))
    throw p.error("mean_free_path", "must be positive at all wavelengths");
  return m;
}

Matter read_matter(const Properties& p) {
  const MediumPtr medium = only_medium(p);
  const bool stated = std::any_of(std::begin(kCoefficients), std::end(kCoefficients),
                                  [&](const char* name) { return p.has(name); });
  if (medium)
    for (const char* name : kCoefficients) refuse(p, {name}, "give either a medium or its coefficients");
  if (!medium && !stated)
    throw Error(p.where(),
                "\"" + p.type() +
                    "\" needs to know what the body is made of: a nested medium, \"sigma_a\" and "
                    "\"sigma_s\", \"sigma_t\" and \"albedo\", or \"reflectance\" and \"mean_free_path\"");
  Matter m = medium ? of_medium(p, *medium) : of_coefficients(p);
  const double scale = p.get_float("scale", 1, Range::positive());
  for (std::size_t i = 0; i < m.size(); ++i) {
    m.absorption[i] *= scale, m.scattering[i] *= scale;
    if (!(m.transport(i) > 0))
      throw Error(p.where(), "the body neither absorbs nor scatters at " +
                                 std::to_string(int(p.context().grid.node(int(i)))) +
                                 " nm; use a BSDF such as \"dielectric\" for clear bodies");
  }
  return m;
}

std::vector<ParameterDoc> matter_rows() {
  return {
      {"medium", "medium", "", "none",
       "material of the body: a medium without spatial variation, whose reduced coefficients are used"},
      {"sigma_a", "spectrum", "1/length", "0",
       "absorption coefficient; give sigma_a and sigma_s instead of a medium"},
      {"sigma_s", "spectrum", "1/length", "0", "scattering coefficient"},
      {"sigma_t", "spectrum", "1/length", "1",
       "extinction coefficient; give sigma_t and albedo instead of sigma_a and sigma_s"},
      {"albedo", "spectrum", "", "0.75", "single-scattering albedo: ratio of scattering to extinction"},
      {"g", "float", "", "0", "asymmetry, the mean cosine of the scattering angle; used with coefficients"},
      {"reflectance", "texture", "", "none",
       "diffuse reflectance of a thick body, without reflection at its boundary; replaces medium and "
       "coefficients"},
      {"mean_free_path", "spectrum", "length", "none",
       "reduced mean free path 1/(sigma_a + sigma_s (1 - g)), used with reflectance"},
      {"scale", "float", "", "1", "factor of the coefficients, divisor of the mean free path"}};
}

}  // namespace aureole
