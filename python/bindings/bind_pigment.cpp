// SPDX-License-Identifier: Apache-2.0
// Paints: layers, interfaces, fits, recipes. aureole/pigment.py checks the arguments and shapes the results.
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/instrument/paint/aperture_loss.h"
#include "aureole/instrument/paint/colour_figures.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/medium/suspension_model.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/grain_index.h"
#include "aureole/pigment/grains.h"
#include "aureole/pigment/hiding.h"
#include "aureole/pigment/hold_out.h"
#include "aureole/pigment/kubelka_munk_inverse.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/streams_mixture.h"
#include "aureole/pigment/two_flux_error.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using Numbers = std::vector<double>;
using Table = std::vector<Numbers>;  ///< a row for each paint
using SurfaceNumbers = std::tuple<double, double, double>;
/// Index, mean cosine, geometry and specular component of a palette's streams.
using StreamsParts = std::tuple<double, double, std::string, std::string>;
/// Wavelengths, names, K, S, errors of K, of S, relative, surface, densities of a palette that mixes by volume, streams,
/// mean cosines of the paints where they have their own.
using PaletteParts = std::tuple<Numbers, std::vector<std::string>, Table, Table, Table, Table, bool,
                                SurfaceNumbers, Numbers, std::optional<StreamsParts>, Numbers>;
/// The theory of a palette by streams, tabulated once.
struct StreamsTheory {
  std::shared_ptr<const pigment::FilmTheory> theory;
};

SurfaceNumbers numbers_of(const pigment::Surface& s) { return {s.seen, s.through, s.k2}; }
pigment::Surface surface_of(const SurfaceNumbers& s) {
  return {std::get<0>(s), std::get<1>(s), std::get<2>(s)};
}

pigment::Specular specular_called(const std::string& name) {
  return name == "included" ? pigment::Specular::included : pigment::Specular::excluded;
}

PaletteParts parts_of(const pigment::Palette& p) {
  Table k, s, k_error, s_error;
  for (const pigment::Pigment& one : p.pigments) {
    k.push_back(one.k), s.push_back(one.s);
    k_error.push_back(one.k_error), s_error.push_back(one.s_error);
  }
  Numbers densities;
  if (p.by_volume)
    for (const pigment::Pigment& one : p.pigments) densities.push_back(one.density);
  std::optional<StreamsParts> streams;
  if (const auto& by = p.streams)
    streams.emplace(by->index, by->g, std::string(pigment::name_of(by->geometry)),
                    std::string(pigment::name_of(by->specular)));
  Numbers cosines;
  if (streams && std::any_of(p.pigments.begin(), p.pigments.end(),
                             [](const pigment::Pigment& one) { return one.g.has_value(); }))
    for (const pigment::Pigment& one : p.pigments) cosines.push_back(one.g.value_or(p.streams->g));
  return {p.nm,      p.names(), k,      s, k_error, s_error, p.relative, numbers_of(p.surface),
          densities, streams,   cosines};
}

pigment::Palette palette_of(const PaletteParts& parts) {
  const auto& [nm, names, k, s, k_error, s_error, relative, surface, densities, streams, cosines] = parts;
  pigment::Palette p;
  p.nm = nm, p.relative = relative, p.surface = surface_of(surface);
  for (std::size_t i = 0; i < names.size(); ++i)
    p.pigments.push_back(
        {.name = names[i], .k = k.at(i), .s = s.at(i), .density = densities.empty() ? 0 : densities.at(i)});
  p.by_volume = !densities.empty();
  if (streams) {
    const auto& [index, g, geometry, specular] = *streams;
    p.streams = {.index = index,
                 .g = g,
                 .geometry = pigment::geometry_called(geometry),
                 .specular = specular_called(specular)};
    for (std::size_t i = 0; i < cosines.size(); ++i) p.pigments.at(i).g = cosines[i];
  }
  return p;
}

StreamsTheory streams_theory(double index, double g, const std::string& geometry, const std::string& specular,
                             bool varies_g) {
  const Unlocked release;
  return naming("streams", [&] {
    return StreamsTheory{pigment::streams_theory({.index = index,
                                                  .g = g,
                                                  .geometry = pigment::geometry_called(geometry),
                                                  .specular = specular_called(specular),
                                                  .varies_g = varies_g},
                                                 for_ranges)};
  });
}

/// Outer reflectance of a layer by streams, over a substrate for each wavelength.
void streams_reflectance(const StreamsTheory& by, const Reals& k, const Reals& s, const Reals& g_shift,
                         double thickness, const Reals& substrate, const Array<double>& result) {
  const std::size_t n = k.size();
  require_size(s.size() == n && g_shift.size() == n && substrate.size() == n && result.size() == n,
               "streams_reflectance");
  for_each(n, [&](std::size_t i) {
    result.data()[i] = pigment::light_of(*by.theory, {k.data()[i], s.data()[i]}, g_shift.data()[i], thickness)
                           .over(substrate.data()[i]);
  });
}

/// Rows of `result`: reflectance, transmittance of a free film by streams.
void streams_free_film(const StreamsTheory& by, const Reals& k, const Reals& s, const Reals& g_shift,
                       double thickness, const Array<double, 2>& result) {
  const std::size_t n = k.size();
  require_size(s.size() == n && g_shift.size() == n && result.shape(0) == 2 && result.shape(1) == n,
               "streams_free_film");
  for (std::size_t i = 0; i < n; ++i) {
    const pigment::LayerTransfer t =
        pigment::free_film_of(*by.theory, {k.data()[i], s.data()[i]}, g_shift.data()[i], thickness);
    result.data()[i] = t.reflectance, result.data()[n + i] = t.transmittance;
  }
}

/// Rows of `result`: reflectance, transmittance of a free film under equal interfaces.
void free_film(const Reals& k, const Reals& s, double thickness, const SurfaceNumbers& surface,
               const Array<double, 2>& result) {
  const std::size_t n = k.size();
  require_size(s.size() == n && result.shape(0) == 2 && result.shape(1) == n, "free_film");
  for (std::size_t i = 0; i < n; ++i) {
    const pigment::LayerTransfer t =
        pigment::outer_transfer(surface_of(surface), pigment::layer({k.data()[i], s.data()[i]}, thickness));
    result.data()[i] = t.reflectance, result.data()[n + i] = t.transmittance;
  }
}

/// Rows of `result`: reflectance, transmittance.
void layer(const Reals& k, const Reals& s, const Reals& thickness, const Array<double, 2>& result) {
  const std::size_t n = k.size();
  require_size(s.size() == n && thickness.size() == n && result.shape(0) == 2 && result.shape(1) == n,
               "layer");
  double* to = result.data();
  for_each(n, [&](std::size_t i) {
    const pigment::LayerTransfer t = pigment::layer({k.data()[i], s.data()[i]}, thickness.data()[i]);
    to[i] = t.reflectance, to[n + i] = t.transmittance;
  });
}

/// Rows of `result`: K, S.
void pigment_coefficients(const Reals& r, const Reals& t, const Reals& thickness,
                          const Array<double, 2>& result) {
  const std::size_t n = r.size();
  require_size(t.size() == n && thickness.size() == n && result.shape(0) == 2 && result.shape(1) == n,
               "coefficients");
  double* to = result.data();
  naming("reflectance", [&] {
    for_each(n, [&](std::size_t i) {
      const pigment::Coefficients c =
          pigment::coefficients_of_transfer({r.data()[i], t.data()[i]}, thickness.data()[i]);
      to[i] = c.k, to[n + i] = c.s;
    });
  });
}

/// Differences of rows L*, a*, b* by a formula; other names than these are CIEDE2000; l and c are those of CMC.
void difference(const Array<const double, 2>& a, const Array<const double, 2>& b, const std::string& formula,
                double l, double c, const Array<double>& result) {
  using pigment::Lab;
  const std::size_t n = result.size();
  require_size(a.shape(0) == n && b.shape(0) == n && a.shape(1) == 3 && b.shape(1) == 3, "difference");
  pigment::DifferenceFormula by = pigment::ciede2000;
  if (formula == "cie1976") by = pigment::cie1976;
  if (formula == "cmc") by = [=](const Lab& p, const Lab& q) { return pigment::cmc(p, q, l, c); };
  if (formula == "cie94") by = [](const Lab& p, const Lab& q) { return pigment::cie94(p, q); };
  if (formula == "cie94_textiles")
    by = [](const Lab& p, const Lab& q) { return pigment::cie94(p, q, pigment::Cie94::textiles); };
  if (formula == "din99o") by = pigment::din99o;
  for_each(n, [&](std::size_t i) {
    const double *p = a.data() + 3 * i, *q = b.data() + 3 * i;
    result.data()[i] = by({p[0], p[1], p[2]}, {q[0], q[1], q[2]});
  });
}

/// Rows of `result`: downward flux, upward flux.
void fluxes(const Reals& k, const Reals& s, const Reals& thickness, const Reals& substrate,
            const Reals& depth, const Array<double, 2>& result) {
  const std::size_t n = k.size();
  require_size(s.size() == n && thickness.size() == n && substrate.size() == n && depth.size() == n &&
                   result.shape(0) == 2 && result.shape(1) == n,
               "fluxes_within");
  double* to = result.data();
  naming("depth", [&] {
    for_each(n, [&](std::size_t i) {
      const pigment::Fluxes f = pigment::fluxes_within({k.data()[i], s.data()[i]}, thickness.data()[i],
                                                       substrate.data()[i], depth.data()[i]);
      to[i] = f.down, to[n + i] = f.up;
    });
  });
}

/// Rows of `result`: K, S by a convention.
void transport(const Reals& sigma_a, const Reals& sigma_s, const Reals& g, const std::string& convention,
               const Array<double, 2>& result) {
  const std::size_t n = sigma_a.size();
  require_size(sigma_s.size() == n && g.size() == n && result.shape(0) == 2 && result.shape(1) == n,
               "coefficients_of_transport");
  double* to = result.data();
  naming("transport", [&] {
    const pigment::Convention named = pigment::convention_named(convention);
    for_each(n, [&](std::size_t i) {
      const pigment::Coefficients c =
          pigment::coefficients_of_transport(sigma_a.data()[i], sigma_s.data()[i], g.data()[i], named);
      to[i] = c.k, to[n + i] = c.s;
    });
  });
}

/// n + i k of a material of grains; throws for an unknown name.
void grain_index(const std::string& material, const Reals& nm, const Array<Complex>& result) {
  require_size(result.size() == nm.size(), "grain_index");
  const auto found = pigment::find_grain_index(material);
  if (!found)
    throw Error("material: unknown name \"" + material + "\"" +
                did_you_mean_or_all(material, pigment::grain_index_names()));
  for (std::size_t i = 0; i < nm.size(); ++i) result.data()[i] = found->index(nm.data()[i]);
}

/// A function through the values at increasing wavelengths.
optics::SpectralFunction function_of(const Reals& nm, const std::function<double(std::size_t)>& value) {
  std::vector<optics::SpectralPoint> points;
  for (std::size_t i = 0; i < nm.size(); ++i) points.push_back({nm.data()[i], value(i)});
  return optics::spectral_table(points);
}

/// Rows of `result`: K, S in 1/m of spheres whose radii are log-normal.
void grains(const Reals& nm, const Complexes& index, const Reals& binder, double radius, double spread,
            bool by_volume, double fraction, bool hard_spheres, const std::string& convention,
            const Array<double, 2>& result) {
  const std::size_t n = nm.size();
  require_size(
      n > 0 && index.size() == n && binder.size() == n && result.shape(0) == 2 && result.shape(1) == n,
      "paint_of_grains");
  naming("grains", [&] {
    const pigment::Convention named = pigment::convention_named(convention);
    const optics::SpectralFunction real =
                                       function_of(nm, [&](std::size_t i) { return index.data()[i].real(); }),
                                   imaginary =
                                       function_of(nm, [&](std::size_t i) { return index.data()[i].imag(); });
    const optics::Ingredient spheres{.name = "grains",
                                     .particles = optics::sphere_kind([=](double lambda_nm) {
                                       return Complex(real(lambda_nm), imaginary(lambda_nm));
                                     }),
                                     .radii = log_normal_radii(radius, spread, by_volume),
                                     .amount = {optics::Amount::Kind::volume, fraction},
                                     .density = 0,
                                     .hard_spheres = hard_spheres};
    const optics::Suspension suspension(
        {.index = function_of(nm, [&](std::size_t i) { return binder.data()[i]; })}, {spheres});
    SignalCheck signals;
    const Unlocked release;
    // Ctrl-C is looked for between wavelengths, by the thread that called.
    for (std::size_t i = 0; i < n; ++i) {
      const pigment::Coefficients c =
          pigment::paint_of_grains(suspension, std::span(nm.data() + i, 1), named, for_ranges)[0];
      result.data()[i] = c.k, result.data()[n + i] = c.s;
      signals();
    }
  });
}

/// Rows of `result`: R, its error, L*, its error. NaN where two fluxes say nothing.
void two_flux_error(const Reals& albedo, const Reals& thickness, const Reals& g, double index,
                    double substrate, const std::string& convention, const Array<double, 2>& result) {
  const std::size_t n = albedo.size();
  require_size(thickness.size() == n && g.size() == n && result.shape(0) == 4 && result.shape(1) == n,
               "two_flux_error");
  const pigment::Convention named = pigment::convention_named(convention);
  double* to = result.data();
  naming("layer", [&] {
    for_each(n, [&](std::size_t i) {
      const pigment::TwoFluxError e = pigment::two_flux_error(
          {albedo.data()[i], thickness.data()[i], g.data()[i], index, substrate}, named);
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      to[i] = e.reflectance, to[n + i] = e.error.value_or(nothing);
      to[2 * n + i] = e.lightness, to[3 * n + i] = e.lightness_error.value_or(nothing);
    });
  });
}

SurfaceNumbers interface_of(const std::string& geometry, const std::string& specular, double index,
                            double alpha) {
  const auto light = specular == "included" ? pigment::Specular::included : pigment::Specular::excluded;
  return naming("index", [&] {
    if (geometry == "diffuse" && alpha > 0) return numbers_of(pigment::rough_surface(index, alpha, light));
    return numbers_of(pigment::smooth_surface(index, pigment::geometry_called(geometry), light));
  });
}

SurfaceNumbers saunderson(double k1, double k2, const std::string& specular) {
  return naming("k1, k2", [&] {
    return numbers_of(pigment::saunderson_surface(
        k1, k2, specular == "included" ? pigment::Specular::included : pigment::Specular::excluded));
  });
}

using Names = std::vector<std::string>;

/// Notes that the interface of the geometry that a file states is taken off.
std::string interface_note(const pigment::Instrument& by, double index, const std::string& remedy) {
  return "was measured at the geometry " + by.geometry +
         (by.specular.empty() ? "" : ", specular " + by.specular) + ": the interface of index " +
         pigment::number_text(index) + " is taken off; " + remedy;
}

/// Adds what the aperture that a table states means for its fit, in words.
void add_aperture(const pigment::SampleTable& table, const pigment::Palette& palette, Names& notes) {
  if (table.instrument.aperture.empty()) return;
  notes.push_back(aperture_text(table, palette, observe("D65", palette.nm)));
}

/// The palette, and what reading the files assumed. Without a surface that of the geometry that they state, for an
/// index of 1.5, or none.
std::tuple<PaletteParts, Names> fit(const Names& files, const std::string& white,
                                    const std::optional<SurfaceNumbers>& surface) {
  const Unlocked release;
  const pigment::SampleTable table = read_sample_files(files);
  Names notes = table.notes;
  pigment::Surface seen;
  if (surface) {
    seen = surface_of(*surface);
  } else if (const pigment::Instrument& by = table.instrument; !by.geometry.empty()) {
    seen = pigment::smooth_surface(1.5, pigment::geometry_called(by.geometry), specular_called(by.specular));
    notes.push_back(interface_note(by, 1.5, "surface=Surface() takes none off"));
  }
  const pigment::Palette palette = fit_file(files.front(), table, {.surface = seen, .white = white}).palette;
  add_aperture(table, palette, notes);
  return {parts_of(palette), notes};
}

/// Name, rms, weight, thickness and its error, and for each paint of a mixture: name, factor, error.
using SpecimenParts = std::tuple<std::string, double, double, double, double,
                                 std::vector<std::tuple<std::string, double, double>>>;
/// Name, names of the samples, measured and predicted values and their errors by sample, reason of no prediction.
using HeldOutParts = std::tuple<std::string, Names, Table, Table, Table, std::string>;

/// Name of a theory, sum of squares, medians and largest of the specimens' rms, mean CIEDE2000 of the specimens kept back (NaN
/// without them), fraction of their values within 90 % intervals (as well), and whether the palette is this theory's.
using TheoryParts = std::tuple<std::string, double, double, double, double, double, bool>;
/// The rms of the residuals in units of the stated noise (0: too few degrees of freedom), degrees of freedom, values, and
/// errors of ln K, ln S and ln(K/S) by the residuals (empty: too few degrees of freedom).
using ResidualParts = std::tuple<double, double, double, Table, Table, Table>;

/// One theory's fit, and what it predicts of specimens kept back.
struct Fitted {
  std::unique_ptr<pigment::FilmTheory> theory;
  std::unique_ptr<pigment::JointFit> fit;
  std::vector<pigment::HeldOut> held;
  double difference = std::numeric_limits<double>::quiet_NaN();
};

TheoryParts parts_of(const pigment::SampleTable& table, const Fitted& f, bool is_written) {
  Numbers rms;
  for (const pigment::SpecimenReport& r : f.fit->specimens()) rms.push_back(r.rms);
  std::sort(rms.begin(), rms.end());
  const double median = 0.5 * (rms[(rms.size() - 1) / 2] + rms[rms.size() / 2]);
  const double covered =
      f.held.empty() ? std::numeric_limits<double>::quiet_NaN() : pigment::interval_coverage(table, f.held);
  return {f.theory->name(), f.fit->cost(), median, rms.back(), f.difference, covered, is_written};
}

/// The palette, errors of ln(K/S), mean cosines of the paints with their errors, specimens, specimens kept back, notes
/// on the data, the theories and the residuals. `hold_out` has names of specimens, or "each", or a number of groups. Without
/// a geometry that of the files is taken; an empty `geometry` or `specular` is none that was given. `by` is "two-flux",
/// "streams" or "best": that of both which predicts specimens kept back better, else two fluxes.
std::tuple<PaletteParts, Table, std::vector<std::pair<double, double>>, std::vector<SpecimenParts>,
           std::vector<HeldOutParts>, Names, std::vector<TheoryParts>, ResidualParts>
joint_fit(const Names& files, const std::optional<SurfaceNumbers>& surface, const std::string& by_theory,
          double index, double g, double g_error, std::string geometry, std::string specular, double noise,
          double relative_noise, double thickness, double amount, const Names& hold_out) {
  const Unlocked release;
  const pigment::SampleTable table = read_sample_files(files);
  return located_in(files.front(), table, [&] {
    pigment::JointSettings settings;
    settings.noise = noise, settings.noise_relative = relative_noise;
    settings.thickness = thickness, settings.dose = amount, settings.g = g_error;
    Names notes = table.notes;
    const pigment::Instrument& by = table.instrument;
    const bool states = !by.geometry.empty(), takes_geometry = states && geometry.empty() && !surface;
    if (takes_geometry) {
      geometry = by.geometry;
      if (specular.empty()) specular = by.specular;
      notes.push_back(interface_note(by, index, "geometry and specular say otherwise"));
    } else if (states && ((!geometry.empty() && geometry != by.geometry) ||
                          (!specular.empty() && !by.specular.empty() && specular != by.specular))) {
      notes.push_back("states the geometry " + by.geometry +
                      (by.specular.empty() ? "" : ", specular " + by.specular) +
                      "; the arguments, which differ, are taken");
    }
    const bool has_interface = surface || !geometry.empty();
    if (!has_interface)
      notes.push_back("no interface is taken off the reflectances; geometry or surface state one");
    const double binder = has_interface ? index : 1;  // of streams
    const auto how = pigment::geometry_called(geometry.empty() ? "d8" : geometry);
    const auto light = specular_called(specular);
    const pigment::Surface interface = surface            ? surface_of(*surface)
                                       : geometry.empty() ? pigment::Surface()
                                                          : pigment::smooth_surface(index, how, light);
    std::vector<Fitted> fitted;
    const auto add = [&](std::unique_ptr<pigment::FilmTheory> theory) {
      Fitted& f = fitted.emplace_back();
      f.theory = std::move(theory);
      f.fit = std::make_unique<pigment::JointFit>(table, *f.theory, settings);
      if (hold_out.empty()) return;
      f.held = pigment::hold_out(table, *f.theory, settings, pigment::hold_out_groups(table, hold_out),
                                 *f.fit, true, for_ranges);
      const auto differences = pigment::held_out_differences(table, f.held, observe("D65", table.nm));
      double sum = 0;
      for (const auto& [name, difference] : differences) sum += difference;
      if (!differences.empty()) f.difference = sum / double(differences.size());
    };
    if (by_theory != "streams") add(pigment::two_flux_theory(interface));
    if (by_theory != "two-flux")
      add(pigment::streams_theory(
          {.index = binder, .g = g, .geometry = how, .specular = light, .varies_g = g_error > 0},
          for_ranges));
    const Fitted& best = *std::min_element(
        fitted.begin(), fitted.end(),
        [](const Fitted& a, const Fitted& b) { return a.difference < b.difference; });  // of NaN the first
    std::vector<HeldOutParts> held;
    for (const pigment::HeldOut& h : best.held) {
      Names names;
      Table measured, predicted, errors;
      for (const std::size_t s : h.samples)
        names.push_back(table.samples[s].name), measured.push_back(table.samples[s].values);
      for (const pigment::JointPrediction& p : h.predictions)
        predicted.push_back(p.values), errors.push_back(p.error);
      held.emplace_back(h.specimen, names, measured, predicted, errors, h.reason);
    }
    pigment::JointFit& fit = *best.fit;
    fit.with_errors();
    std::vector<SpecimenParts> specimens;
    for (const pigment::SpecimenReport& r : fit.specimens(true)) {
      std::vector<std::tuple<std::string, double, double>> doses;
      for (const auto& d : r.doses) doses.emplace_back(d.paint, d.factor, d.error);
      specimens.emplace_back(r.name, r.rms, r.weight, r.thickness, r.thickness_error, doses);
    }
    pigment::Palette palette = fit.palette();
    palette.surface = !palette.streams ? interface
                      : has_interface  ? pigment::smooth_surface(index, how, light)
                                       : pigment::Surface();
    std::vector<std::pair<double, double>> cosines;
    for (const pigment::MeanCosine& c : fit.mean_cosines()) cosines.emplace_back(c.g, c.error);
    for (const std::string& note : pigment::joint_notes(fit)) notes.push_back(note);
    add_aperture(table, palette, notes);
    std::vector<TheoryParts> theories;
    for (const Fitted& f : fitted) theories.push_back(parts_of(table, f, &f == &best));
    const pigment::ResidualReport r = fit.residuals();
    Table ln_k, ln_s, ln_ratio;
    if (r.relative > 0)
      for (const pigment::PaintErrors& e : fit.errors(r.relative))
        ln_k.push_back(e.k), ln_s.push_back(e.s), ln_ratio.push_back(e.ratio);
    return std::tuple(parts_of(palette), fit.ratio_error(), cosines, specimens, held, notes, theories,
                      ResidualParts{r.relative, r.freedom, r.values, ln_k, ln_s, ln_ratio});
  });
}

/// X, Y, Z, then L*, a*, b*, whiteness, tint and yellowness, NaN where they are not defined, and whether the
/// reflectance is a white.
std::tuple<Numbers, bool> figures(const Numbers& nm, const Numbers& reflectance, const std::string& viewing) {
  const ColourFigures f = naming("reflectance", [&] { return colour_figures(nm, reflectance, viewing); });
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  return {{f.xyz[0], f.xyz[1], f.xyz[2], f.lab.l, f.lab.a, f.lab.b,
           f.whiteness ? f.whiteness->whiteness : nothing, f.whiteness ? f.whiteness->tint : nothing,
           f.yellowness.value_or(nothing)},
          f.whiteness && f.whiteness->is_valid};
}

/// Differences in L*, a*, b*, C*, H*; the five formulas; strength at the maximum, its wavelength, summed, weighted;
/// differences of the tint tone in L*, C*, H* and CIEDE2000, NaN without a strength; the metamerism indices; and why
/// there is no strength.
std::tuple<Numbers, Numbers, std::string> compare(const Numbers& nm, const Numbers& standard,
                                                  const Numbers& sample, const std::string& viewing,
                                                  const std::vector<std::string>& others, double cmc_l,
                                                  double cmc_c, bool textiles, const Numbers& white,
                                                  const SurfaceNumbers& surface) {
  const ColourSettings settings{.viewing = viewing,
                                .others = others,
                                .cmc_l = cmc_l,
                                .cmc_c = cmc_c,
                                .cie94 = textiles ? pigment::Cie94::textiles : pigment::Cie94::graphic_arts,
                                .strength = {surface_of(surface), white}};
  const ColourComparison c =
      naming("sample", [&] { return compare_colours(nm, standard, sample, settings); });
  Numbers all{c.lab.l, c.lab.a, c.lab.b, c.lch.c, c.lch.h, c.cie1976, c.cmc, c.cie94, c.ciede2000, c.din99o};
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  if (c.strength)
    all.insert(all.end(), {c.strength->at_maximum, c.strength->nm, c.strength->summed, c.strength->weighted,
                           c.tone.l, c.tone.c, c.tone.h, c.tone_ciede2000});
  else
    all.insert(all.end(), 8, nothing);
  return {all, c.metamerism, c.no_strength};
}

/// L*, a*, b* of reflectances, a row each.
Table lab(const Numbers& nm, const Table& reflectances, const std::string& illuminant) {
  const pigment::Observation lamp = observe(illuminant, nm);
  Table rows;
  for (const Numbers& r : reflectances) {
    const pigment::Lab c = naming("reflectance", [&] { return lamp.lab(r); });
    rows.push_back({c.l, c.a, c.b});
  }
  return rows;
}

/// Fractions, difference, differences under other lamps, rms and reflectance of each solution, its cost, contrast ratio
/// and colour differences of 1 % more of each paint and of all.
using Solution = std::tuple<Numbers, double, Numbers, double, Numbers, double, double, Numbers, double>;

std::vector<Solution> match(const PaletteParts& parts, const Numbers& target_lab, const Numbers& target,
                            int paints, int solutions, const std::string& illuminant,
                            const std::vector<std::string>& others, const Numbers& least, const Numbers& most,
                            const std::string& by, const Numbers& price,
                            const std::vector<std::pair<std::size_t, std::size_t>>& apart, double smallest,
                            double thickness, const Numbers& substrate, double opacity, bool trade_offs,
                            double within, const StreamsTheory* theory) {
  const Unlocked release;
  const pigment::Palette palette = palette_of(parts);
  const pigment::Observation lamp = observe(illuminant, palette.nm);
  std::vector<pigment::Observation> lamps;
  for (const std::string& name : others) lamps.push_back(observe(name, palette.nm));
  pigment::MatchTarget wanted;
  wanted.reflectance = target;
  const pigment::MatchSettings settings{.max_paints = paints,
                                        .solutions = solutions,
                                        .least = least,
                                        .most = most,
                                        .thickness = thickness,
                                        .substrate = substrate,
                                        .by = by == "lamps"      ? pigment::MatchBy::lamps
                                              : by == "spectrum" ? pigment::MatchBy::spectrum
                                                                 : pigment::MatchBy::colour,
                                        .forbidden = apart,
                                        .smallest = smallest,
                                        .price = price,
                                        .least_contrast = opacity,
                                        .trade_offs = trade_offs,
                                        .within = within};
  return naming("match", [&] {
    wanted.lab = target.empty() ? pigment::Lab{target_lab.at(0), target_lab.at(1), target_lab.at(2)}
                                : lamp.lab(target);
    std::vector<Solution> all;
    const auto threads = [](std::size_t n, const auto& body, std::size_t grain) {
      for_ranges(n, body, grain);
    };
    for (const pigment::Match& m :
         pigment::match(palette, wanted, lamp, lamps, settings, threads, theory ? theory->theory : nullptr))
      all.emplace_back(m.fractions, m.difference, m.differences, m.rms, m.reflectance, m.cost, m.contrast,
                       m.dosing, m.dosing_error);
    return all;
  });
}

}  // namespace

void bind_pigment(nb::module_& m) {
  using nb::arg;
  nb::class_<StreamsTheory>(m, "StreamsTheory", "Tabulated transport in films of paint.");
  m.def("pigment_streams_theory", &streams_theory, arg("index"), arg("g"), arg("geometry"), arg("specular"),
        arg("varies_g"));
  m.def("pigment_streams_reflectance", &streams_reflectance, arg("theory"), arg("k"), arg("s"),
        arg("g_shift"), arg("thickness"), arg("substrate"), arg("result").noconvert());
  m.def("pigment_streams_free_film", &streams_free_film, arg("theory"), arg("k"), arg("s"), arg("g_shift"),
        arg("thickness"), arg("result").noconvert());
  m.def("pigment_free_film", &free_film, arg("k"), arg("s"), arg("thickness"), arg("surface"),
        arg("result").noconvert());
  m.def("pigment_layer", &layer, arg("k"), arg("s"), arg("thickness"), arg("result").noconvert());
  m.def("pigment_fluxes", &fluxes, arg("k"), arg("s"), arg("thickness"), arg("substrate"), arg("depth"),
        arg("result").noconvert());
  m.def("pigment_transport", &transport, arg("sigma_a"), arg("sigma_s"), arg("g"), arg("convention"),
        arg("result").noconvert());
  m.def("pigment_grain_index", &grain_index, arg("material"), arg("nm"), arg("result").noconvert());
  m.def("pigment_grain_names", &pigment::grain_index_names);
  m.def("pigment_grains", &grains, arg("nm"), arg("index"), arg("binder"), arg("radius"), arg("spread"),
        arg("by_volume"), arg("fraction"), arg("hard_spheres"), arg("convention"), arg("result").noconvert());
  m.def("pigment_coefficients", &pigment_coefficients, arg("reflectance"), arg("transmittance"),
        arg("thickness"), arg("result").noconvert());
  m.def(
      "pigment_opaque_reflectance",
      [](const Reals& k_over_s, const Array<double>& result) {
        map_numbers("k_over_s", k_over_s, result, [](double x) { return pigment::opaque_reflectance(x); });
      },
      arg("k_over_s"), arg("result").noconvert());
  m.def(
      "pigment_k_over_s",
      [](const Reals& reflectance, const Array<double>& result) {
        map_numbers("reflectance", reflectance, result, [](double x) { return pigment::k_over_s(x); });
      },
      arg("reflectance"), arg("result").noconvert());
  m.def(
      "pigment_outer",
      [](const SurfaceNumbers& s, const Reals& inner, const Array<double>& result) {
        map_numbers("inner", inner, result,
                    [&](double x) { return pigment::outer_reflectance(surface_of(s), x); });
      },
      arg("surface"), arg("inner"), arg("result").noconvert());
  m.def(
      "pigment_inner",
      [](const SurfaceNumbers& s, const Reals& outer, const Array<double>& result) {
        map_numbers("outer", outer, result,
                    [&](double x) { return pigment::inner_reflectance(surface_of(s), x); });
      },
      arg("surface"), arg("outer"), arg("result").noconvert());
  m.def("pigment_difference", &difference, arg("a"), arg("b"), arg("formula"), arg("l"), arg("c"),
        arg("result").noconvert());
  m.def("pigment_two_flux_error", &two_flux_error, arg("albedo"), arg("thickness"), arg("g"), arg("index"),
        arg("substrate"), arg("convention"), arg("result").noconvert());
  m.def("pigment_conventions", &pigment::convention_names);
  m.def("pigment_interface", &interface_of, arg("geometry"), arg("specular"), arg("index"), arg("alpha"));
  m.def(
      "pigment_hiding_thickness",
      [](const std::function<double(double)>& contrast, double start, double target) {
        return pigment::hiding_thickness(contrast, start, target);
      },
      arg("contrast"), arg("start"), arg("target"));
  m.def("pigment_saunderson", &saunderson, arg("k1"), arg("k2"), arg("specular"));
  m.def("pigment_fit", &fit, arg("files"), arg("white"), arg("surface").none());
  m.def("pigment_joint_fit", &joint_fit, arg("files"), arg("surface").none(), arg("theory"), arg("index"),
        arg("g"), arg("g_error"), arg("geometry"), arg("specular"), arg("noise"), arg("relative_noise"),
        arg("thickness"), arg("amount"), arg("hold_out"));
  m.def("pigment_kimera_surface", [] { return numbers_of(pigment::kimera_surface()); });
  m.def(
      "pigment_palette", [](const std::string& file) { return parts_of(read_palette_file(file)); },
      arg("file"));
  m.def(
      "pigment_recipe",
      [](const PaletteParts& palette, const std::string& recipe) {
        return recipe_fractions(palette_of(palette), recipe, false, "recipe");
      },
      arg("palette"), arg("recipe"));
  m.def("pigment_figures", &figures, arg("nm"), arg("reflectance"), arg("viewing"));
  m.def("pigment_compare", &compare, arg("nm"), arg("standard"), arg("sample"), arg("viewing"), arg("others"),
        arg("cmc_l"), arg("cmc_c"), arg("textiles"), arg("white"), arg("surface"));
  m.def("pigment_lab", &lab, arg("nm"), arg("reflectances"), arg("illuminant"));
  m.def("pigment_match", &match, arg("palette"), arg("lab"), arg("reflectance"), arg("paints"),
        arg("solutions"), arg("illuminant"), arg("others"), arg("least"), arg("most"), arg("by"),
        arg("price"), arg("apart"), arg("smallest"), arg("thickness"), arg("substrate"), arg("opacity"),
        arg("trade_offs"), arg("within"), arg("theory").none());
}

}  // namespace aureole::python
