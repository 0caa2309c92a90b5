// SPDX-License-Identifier: Apache-2.0
// Instruments of the laboratory. The public interface is in aureole/_laboratory.py, _goniometer.py and _colours.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <atomic>
#include <future>
#include <memory>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/laboratory/brdf_fit.h"
#include "aureole/instrument/laboratory/goniometer.h"
#include "aureole/instrument/laboratory/lateral_spread.h"
#include "aureole/instrument/laboratory/spectrophotometer.h"
#include "aureole/instrument/laboratory/spectrum_files.h"
#include "aureole/instrument/measured/bsdf_conversion.h"
#include "aureole/instrument/paint/colour_description.h"
#include "aureole/instrument/photometry/array_reading.h"
#include "bindings.h"
#include "current_tables.h"
#include "loading_signals.h"
#include "object_arrays.h"
#include "text.h"

namespace aureole::python {
namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

nb::list decoded_list(const std::vector<std::string>& texts) {
  nb::list list;
  for (const std::string& text : texts) list.append(decoded(text));
  return list;
}

/// Options of an instrument by name, as its public function has checked them.
class Options {
public:
  explicit Options(const nb::dict& options) : options_(options) {}
  std::string text(const char* key) const { return get<std::string>(key); }
  double number(const char* key) const { return get<double>(key); }
  std::int64_t integer(const char* key) const { return get<std::int64_t>(key); }
  bool flag(const char* key) const { return get<bool>(key); }
  std::vector<double> numbers(const char* key) const { return get<std::vector<double>>(key); }
  std::vector<std::string> texts(const char* key) const { return get<std::vector<std::string>>(key); }

private:
  template <class T>
  T get(const char* key) const {
    if (!options_.contains(key)) throw Error(std::string("options: \"") + key + "\" is missing");
    try {
      return nb::cast<T>(options_[key]);
    } catch (const nb::cast_error&) {
      throw Error(std::string("options: \"") + key + "\" has another type");
    }
  }
  nb::dict options_;
};

/// Runs f(stop) in a thread of its own, without Python's lock. A signal whose handler raises sets `stop`, at which f has to throw.
template <class F>
auto stoppable(const F& f) {
  const Unlocked release;
  std::atomic<bool> stop{false};
  SignalCheck check;
  auto result = std::async(std::launch::async, [&] { return f(stop); });
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    if (check.raised()) {
      stop = true;
      result.wait();
    }
  check.rethrow();
  return result.get();
}

/// The specimen of a measurement: a material of a file, or a BSDF of the program.
struct Measured {
  Specimen specimen;
  SpectralGrid grid;
  double length_unit_m = 1;
  std::vector<std::string> notes;
};

std::string text_of_target(const nb::object& target) {
  if (!nb::isinstance<nb::str>(target)) throw nb::type_error("target: expected a Bsdf or a string");
  return nb::cast<std::string>(target);
}

Measured measured_of(const nb::object& target, const Defines& defines, double thickness_m) {
  if (nb::isinstance<Bsdf>(target)) {
    const auto bsdf = nb::cast<std::shared_ptr<Bsdf>>(target);
    require_standalone(*bsdf);
    if (thickness_m > 0)
      throw Error(
          "thickness: a BSDF has no medium inside; name a shape of a file with an interior medium or a BSSRDF");
    Measured m{{.name = bsdf->properties().type()}, bsdf->properties().context().grid, 1, {}};
    m.specimen.bsdf = bsdf;
    return m;
  }
  const std::string name = text_of_target(target);
  const Unlocked release;
  const LoadingSignals signals;
  LoadOptions options;
  options.defines = defines, options.tables = current_tables();
  options.progress = signals.progress();
  LoadedSpecimen loaded = signals.run([&] { return load_specimen_called(name, options, thickness_m); });
  return {std::move(loaded.specimen), loaded.grid, loaded.length_unit_m, std::move(loaded.notes)};
}

TraceSettings trace_of(const Options& o, int replicates) {
  TraceSettings t;
  t.paths = o.integer("paths"), t.seed = std::uint64_t(o.integer("seed")),
  t.threads = int(o.integer("threads"));
  t.replicates = replicates;
  return t;
}

/// The beam that the options state: numbers that are not NaN.
StatedBeam beam_of(const Options& o) {
  const auto given = [&](const char* name) {
    const double number = o.number(name);
    return std::isnan(number) ? std::optional<double>() : number;
  };
  return {given("lamp_angle"), given("aperture"), given("lit")};
}

SpectrophotometerSettings spectrophotometer_settings(const Options& o) {
  SpectrophotometerSettings s;
  s.geometry = measuring_geometry(o.text("geometry"), o.flag("transmission"));
  using Method = SpectrophotometerSettings::Method;
  const std::string method = o.text("method");
  if (method != "comparison" && method != "substitution" && method != "absolute")
    throw Error("method: expected \"comparison\", \"substitution\" or \"absolute\"");
  s.method = method == "substitution" ? Method::substitution
             : method == "absolute"   ? Method::absolute
                                      : Method::comparison;
  s.is_pooled = o.flag("pooled");
  s.by_theory = o.flag("theory"), s.correct_bandwidth = o.flag("correct_bandwidth");
  set_beam(s, beam_of(o));
  s.sample_m = o.number("sample_size");
  s.sphere_m = o.number("sphere"), s.port_m = o.number("port"), s.wall = o.number("wall");
  s.specular_angle = o.number("specular_port");
  s.detector_angle = o.number("detector_angle"), s.azimuth = o.number("azimuth");
  s.standard = o.number("standard"), s.standard_error = o.number("standard_error");
  s.noise = o.number("noise"), s.dark_noise = o.number("dark_noise");
  s.wavelength_error_nm = o.number("wavelength_error");
  return s;
}

nb::dict spectrum_dict(const MeasuredSpectrum& m, const std::vector<std::string>& notes) {
  nb::dict d, causes;
  for (const auto& cause : m.causes) causes[cause.name.c_str()] = cause.errors;
  std::vector<std::string> all = notes;
  all.insert(all.end(), m.notes.begin(), m.notes.end());
  d["edge_loss"] = m.edge_loss;
  d["nm"] = m.nm, d["values"] = m.values, d["uncertainty"] = causes, d["notes"] = decoded_list(all);
  return d;
}

nb::dict spectrophotometer(const nb::object& target, const Defines& defines, const nb::dict& options) {
  const Options o(options);
  const SpectrophotometerSettings s = spectrophotometer_settings(o);
  const Measured m = measured_of(target, defines, o.number("thickness"));
  const Bands bands = bands_over(o.numbers("range"), m.grid, o.number("step"), 10, o.number("bandwidth"));
  TraceSettings trace = trace_of(o, 16);
  MeasuredSpectrum found;
  std::vector<std::array<double, 3>> gloss;
  Haze haze;
  const std::vector<double> gloss_angles = o.numbers("gloss");
  const double haze_angle = o.number("haze");
  const bool is_spectrum = gloss_angles.empty() && haze_angle == 0;
  stoppable([&](const std::atomic<bool>& stop) {
    trace.stop = &stop;
    const Bench bench(m.grid, m.length_unit_m, bands, trace);
    if (is_spectrum) {
      found = measure_spectrum(bench, m.specimen, s);
      return 0;
    }
    const std::vector<double> weights = luminance_weights(bands.nm);
    for (const double angle : gloss_angles) {
      const Ratio g = measure_gloss(bench, m.specimen, angle, s, weights);
      gloss.push_back({angle, g.value, g.error});
    }
    if (haze_angle > 0) {
      SpectrophotometerSettings of_haze = s;
      use_beam_of_haze(of_haze), set_beam(of_haze, beam_of(o));
      haze = measure_haze(bench, m.specimen, of_haze, haze_angle, weights);
    }
    return 0;
  });
  nb::dict d = spectrum_dict(found, m.notes);
  nb::list rows;
  for (const auto& g : gloss) rows.append(nb::make_tuple(g[0], g[1], g[2]));
  d["gloss"] = rows;
  d["haze"] = nb::make_tuple(haze.total, haze.total_error, haze.haze, haze.haze_error);
  return d;
}

nb::dict table_dict(const GonioTable& t, const std::vector<std::string>& notes) {
  std::vector<double> angles[4], f, error;
  for (const GonioReading& r : t.readings) {
    const double all[4] = {r.theta_i, r.phi_i, r.theta_o, r.phi_o};
    for (int k = 0; k < 4; ++k) angles[k].push_back(all[k]);
    f.insert(f.end(), r.f.begin(), r.f.end()), error.insert(error.end(), r.error.begin(), r.error.end());
  }
  std::vector<std::string> all_notes = notes;
  all_notes.insert(all_notes.end(), t.notes.begin(), t.notes.end());
  nb::dict d;
  d["nm"] = t.nm, d["theta_i"] = angles[0], d["phi_i"] = angles[1], d["theta_o"] = angles[2];
  d["phi_o"] = angles[3], d["f"] = f, d["error"] = error, d["notes"] = decoded_list(all_notes);
  return d;
}

GonioTable table_of(const Options& o) {
  GonioTable t;
  t.nm = o.numbers("nm");
  const std::vector<double> theta_i = o.numbers("theta_i"), phi_i = o.numbers("phi_i"),
                            theta_o = o.numbers("theta_o"), phi_o = o.numbers("phi_o"), f = o.numbers("f"),
                            error = o.numbers("error");
  const std::size_t n = theta_i.size(), bands = t.nm.size();
  if (phi_i.size() != n || theta_o.size() != n || phi_o.size() != n || f.size() != n * bands ||
      error.size() != n * bands || bands == 0)
    throw Error("the table's arrays have different lengths");
  for (std::size_t k = 0; k < n; ++k) {
    const auto from = std::ptrdiff_t(k * bands), to = std::ptrdiff_t((k + 1) * bands);
    t.readings.push_back({theta_i[k],
                          phi_i[k],
                          theta_o[k],
                          phi_o[k],
                          {f.begin() + from, f.begin() + to},
                          {error.begin() + from, error.begin() + to}});
  }
  return t;
}

GoniometerSettings goniometer_settings(const Options& o) {
  GoniometerSettings s;
  s.lamp_angle = o.number("lamp_angle"), s.detector_angle = o.number("detector_angle");
  s.viewed_m = o.number("aperture"), s.lit_m = o.number("lit"), s.sample_m = o.number("sample_size");
  s.by_reference = o.flag("reference"), s.standard = o.number("standard");
  s.noise = o.number("noise"), s.dark_noise = o.number("dark_noise"), s.angle_error = o.number("angle_error");
  return s;
}

nb::dict goniometer(const nb::object& target, const Defines& defines, const nb::dict& options) {
  const Options o(options);
  const GoniometerSettings s = goniometer_settings(o);
  GonioPlan plan;
  const std::string kind = o.text("plan");
  if (kind != "in_plane" && kind != "hemispherical" && kind != "adaptive")
    throw Error("plan: expected \"in_plane\", \"hemispherical\" or \"adaptive\"");
  plan.kind = kind == "in_plane"   ? GonioPlan::Kind::in_plane
              : kind == "adaptive" ? GonioPlan::Kind::adaptive
                                   : GonioPlan::Kind::hemispherical;
  plan.incident = o.numbers("incident"), plan.azimuths = o.numbers("azimuths");
  plan.directions = int(o.integer("directions")), plan.transmits = o.flag("transmission");
  const Measured m = measured_of(target, defines, o.number("thickness"));
  const Bands bands = bands_over(o.numbers("range"), m.grid, o.number("step"), 20, o.number("bandwidth"));
  TraceSettings trace = trace_of(o, 8);
  const GonioTable table = stoppable([&](const std::atomic<bool>& stop) {
    trace.stop = &stop;
    return measure_scattering(Bench(m.grid, m.length_unit_m, bands, trace), m.specimen, s, plan);
  });
  return table_dict(table, m.notes);
}

nb::tuple ratio_tuple(const Ratio& r) { return nb::make_tuple(r.value, r.error); }

nb::dict reflectances(const nb::object& target, const Defines& defines, const nb::dict& options) {
  const Options o(options);
  const GoniometerSettings s = goniometer_settings(o);
  const Measured m = measured_of(target, defines, o.number("thickness"));
  const Bands bands = bands_over(o.numbers("range"), m.grid, o.number("step"), 20, o.number("bandwidth"));
  TraceSettings trace = trace_of(o, 8);
  ReportSettings asked;
  asked.light = o.text("incident_light");
  const std::vector<double> cones = o.numbers("cones");
  for (std::size_t k = 0; k + 3 < cones.size(); k += 4)
    asked.cones.push_back({cones[k], cones[k + 1], cones[k + 2], cones[k + 3]});
  const ReflectanceReport r = stoppable([&](const std::atomic<bool>& stop) {
    trace.stop = &stop;
    return report_reflectances(Bench(m.grid, m.length_unit_m, bands, trace), m.specimen, s, asked);
  });
  nb::dict d;
  nb::list angles, pairs, turns;
  for (const auto& a : r.angles) angles.append(nb::make_tuple(a.angle, ratio_tuple(a.dh), ratio_tuple(a.hd)));
  for (const auto& p : r.pairs)
    pairs.append(nb::make_tuple(p.i, p.o, ratio_tuple(p.forward), ratio_tuple(p.backward)));
  for (const auto& t : r.turns) turns.append(nb::make_tuple(t[0], t[1], t[2]));
  nb::list of_cones;
  for (const auto& c : r.cones)
    of_cones.append(
        nb::make_tuple(c.theta_i, c.half_i, c.theta_o, c.half_o, ratio_tuple(c.reflectance), c.factor));
  d["cones"] = of_cones, d["of_light"] = r.of_light ? nb::object(ratio_tuple(*r.of_light)) : nb::none();
  d["angles"] = angles, d["pairs"] = pairs, d["turns"] = turns, d["rho_hh"] = ratio_tuple(r.hh);
  d["anisotropy"] = r.anisotropy, d["is_isotropic"] = r.is_isotropic, d["notes"] = decoded_list(m.notes);
  return d;
}

nb::dict spread(const nb::object& target, const Defines& defines, const nb::dict& options) {
  const Options o(options);
  SpreadSettings s;
  s.is_line = o.flag("line"), s.at_m = o.numbers("distances"), s.lit_m = o.number("lit"),
  s.receiver_m = o.number("aperture");
  s.lamp_angle = o.number("lamp_angle"), s.sample_m = o.number("sample_size");
  const Measured m = measured_of(target, defines, o.number("thickness"));
  const Bands bands = bands_over(o.numbers("range"), m.grid, o.number("step"), 20, o.number("bandwidth"));
  TraceSettings trace = trace_of(o, 16);
  const SpreadTable t = stoppable([&](const std::atomic<bool>& stop) {
    trace.stop = &stop;
    return measure_spread(Bench(m.grid, m.length_unit_m, bands, trace), m.specimen, s);
  });
  std::vector<double> values, errors, predicted;
  for (const SpreadReading& r : t.readings) {
    for (const Ratio& v : r.values) values.push_back(v.value), errors.push_back(v.error);
    predicted.insert(predicted.end(), r.predicted.begin(), r.predicted.end());
  }
  std::vector<std::string> notes = m.notes;
  notes.insert(notes.end(), t.notes.begin(), t.notes.end());
  nb::dict d;
  d["nm"] = t.nm, d["values"] = values, d["errors"] = errors, d["predicted"] = predicted;
  d["notes"] = decoded_list(notes);
  return d;
}

nb::list fits(const nb::dict& options) {
  const Options o(options);
  const GonioTable table = table_of(o);
  FitSettings s;
  s.models = o.texts("models"), s.lamp_angle = o.number("lamp_angle"),
  s.detector_angle = o.number("detector_angle"), s.viewed_m = o.number("aperture");
  const std::vector<BrdfFit> found = stoppable([&](const std::atomic<bool>& stop) {
    s.stop = &stop;
    return fit_brdfs(table, s);
  });
  nb::list list;
  for (const BrdfFit& f : found) {
    nb::dict one, parameters;
    for (const auto& p : f.parameters) parameters[p.name.c_str()] = nb::make_tuple(p.value, p.low, p.high);
    one["model"] = f.model, one["parameters"] = parameters, one["chi_squared"] = f.chi_squared;
    one["readings"] = f.readings, one["rms"] = f.rms, one["largest"] = f.largest, one["aic"] = f.aic;
    one["bsdf"] = f.bsdf;
    list.append(one);
  }
  return list;
}

nb::dict read_array(const nb::dict& options) {
  const Options o(options);
  ArrayReadingSettings s;
  s.target = o.text("target"), s.pixel = o.numbers("pixel"), s.region = o.numbers("region"),
  s.lines = o.numbers("lines");
  optics::ArraySpectrograph& a = s.array;
  a.first_nm = o.numbers("range").at(0), a.last_nm = o.numbers("range").at(1);
  a.pixels = int(o.integer("pixels")), a.slit_nm = o.number("slit"), a.curvature_nm = o.number("curvature");
  a.scattered = o.number("scattered"), a.halo = o.number("halo"), a.electrons = o.number("electrons");
  a.read_noise = o.number("read_noise");
  s.deconvolution = int(o.integer("deconvolve")), s.seed = std::uint64_t(o.integer("seed"));
  s.keep_stray = o.flag("keep_stray");
  const ArrayReading r = stoppable([&](const std::atomic<bool>&) { return read_by_array(s); });
  nb::dict d;
  d["nm"] = r.nm, d["values"] = r.values, d["truth"] = r.truth;
  d["xy"] = std::array<double, 2>{r.xy.x, r.xy.y},
  d["true_xy"] = std::array<double, 2>{r.true_xy.x, r.true_xy.y};
  d["residual"] = r.scale_residual_nm, d["deviation"] = r.mean_deviation, d["notes"] = decoded_list(r.notes);
  return d;
}

nb::dict colour_dict(const NamedColour& c, const ColourDescription& d) {
  nb::dict out;
  out["name"] = decoded(c.name), out["nm"] = c.nm, out["values"] = c.values, out["xyz"] = d.xyz;
  out["white"] = c.white, out["xy"] = std::array<double, 2>{d.xy.x, d.xy.y};
  out["uv"] = std::array<double, 2>{d.uv.u, d.uv.v},
  out["lab"] = std::array<double, 3>{d.lab.l, d.lab.a, d.lab.b};
  out["luv"] = std::array<double, 3>{d.luv.l, d.luv.u, d.luv.v}, out["screen"] = d.screen;
  out["dominant"] =
      d.dominant ? nb::cast(nb::make_tuple(d.dominant->nm, d.dominant->is_complementary, d.dominant->purity))
                 : nb::none();
  out["whiteness"] =
      d.whiteness ? nb::cast(nb::make_tuple(d.whiteness->whiteness, d.whiteness->tint, d.whiteness->is_valid))
                  : nb::none();
  out["yellowness"] = d.yellowness ? nb::cast(*d.yellowness) : nb::none();
  return out;
}

nb::dict colours(const std::vector<std::string>& targets, const std::string& standard,
                 const std::string& viewing, const std::vector<std::string>& others,
                 const std::array<double, 2>& cmc) {
  std::vector<std::string> notes;
  nb::list list;
  struct One {
    NamedColour colour;
    ColourDescription description;
    ColourDifference difference;
  };
  std::vector<One> all;
  {
    const Unlocked release;
    std::vector<NamedColour> of_standard;
    if (!standard.empty()) of_standard = {colour_called(standard, viewing, "standard", notes)};
    for (const std::string& target : targets)
      for (const NamedColour& c : colours_called(target, viewing, target, notes)) {
        One one{c, describe_colour(c, viewing), {}};
        if (!of_standard.empty())
          one.difference = colour_difference(of_standard[0], c, viewing, {cmc[0], cmc[1]}, others, notes);
        all.push_back(std::move(one));
      }
  }
  for (const One& one : all) {
    nb::dict d = colour_dict(one.colour, one.description);
    if (!standard.empty()) {
      const ColourDifference& f = one.difference;
      nb::dict difference, metamerism;
      difference["lab"] = std::array<double, 3>{f.lab.l, f.lab.a, f.lab.b};
      difference["chroma"] = f.lch.c, difference["hue"] = f.lch.h, difference["cie1976"] = f.cie1976;
      difference["ciede2000"] = f.ciede2000, difference["cmc"] = f.cmc, difference["cie94"] = f.cie94;
      difference["din99o"] = f.din99o;
      for (const auto& [name, index] : f.metamerism) metamerism[decoded(name)] = index;
      difference["metamerism"] = metamerism;
      d["difference"] = difference;
    }
    list.append(d);
  }
  nb::dict out;
  out["colours"] = list, out["notes"] = decoded_list(notes);
  return out;
}

nb::dict convert(const nb::object& target, const std::string& output, const Defines& defines,
                 const nb::dict& options) {
  const Options o(options);
  BsdfConversionSettings s;
  s.format = o.text("format"), s.range = o.numbers("range"), s.step = o.number("step");
  s.angles = int(o.integer("angles")), s.azimuths = int(o.integer("azimuths"));
  s.resolution = int(o.integer("resolution")), s.normals = int(o.integer("normals"));
  s.basis = o.text("basis"), s.samples = int(o.integer("samples")), s.tolerance = o.number("tolerance");
  s.description = o.text("description"), s.make_reciprocal = o.flag("make_reciprocal");
  if (s.format.empty()) s.format = format_of_output(output);
  ConvertibleBsdf material;
  std::string name;
  if (nb::isinstance<Bsdf>(target)) {
    const auto bsdf = nb::cast<std::shared_ptr<Bsdf>>(target);
    require_standalone(*bsdf);
    material = {bsdf, bsdf->properties().context().grid, {}};
    name = bsdf->properties().type();
  } else {
    name = text_of_target(target);
    const Unlocked release;
    const LoadingSignals signals;
    LoadOptions load;
    load.defines = defines, load.tables = current_tables(), load.progress = signals.progress();
    material = signals.run([&] { return load_convertible(name, load, s.range); });
  }
  const ConvertedBsdf found = stoppable([&](const std::atomic<bool>& stop) {
    s.stop = &stop;
    ConvertedBsdf converted = convert_bsdf(material, name, s);
    write_file_atomically(output, converted.content);
    return converted;
  });
  std::vector<double> angles, reflected, transmitted;
  for (const auto& e : found.report.energies)
    angles.push_back(e.angle), reflected.push_back(e.reflected), transmitted.push_back(e.transmitted);
  std::vector<std::string> notes = material.notes;
  notes.insert(notes.end(), found.notes.begin(), found.notes.end());
  nb::dict d;
  d["type"] = found.type, d["format"] = s.format, d["bytes"] = found.content.size();
  d["angle"] = angles, d["reflected"] = reflected, d["transmitted"] = transmitted;
  d["mean_asymmetry"] = found.report.mean_asymmetry, d["largest_asymmetry"] = found.report.largest_asymmetry;
  d["is_isotropic"] = found.report.is_isotropic, d["notes"] = decoded_list(notes);
  return d;
}

}  // namespace

void bind_laboratory(nb::module_& m) {
  m.def("spectrophotometer", spectrophotometer, nb::arg("target"), nb::arg("defines"), nb::arg("options"));
  m.def("goniometer", goniometer, nb::arg("target"), nb::arg("defines"), nb::arg("options"));
  m.def("goniometer_report", reflectances, nb::arg("target"), nb::arg("defines"), nb::arg("options"));
  m.def("lateral_spread", spread, nb::arg("target"), nb::arg("defines"), nb::arg("options"));
  m.def(
      "goniometer_table",
      [](const std::string& file) {
        GonioTable table;
        {
          const Unlocked release;
          table = read_gonio_table(file);
        }
        return table_dict(table, {});
      },
      nb::arg("file"));
  m.def(
      "goniometer_text",
      [](const nb::dict& options) { return gonio_table_content(table_of(Options(options))); },
      nb::arg("options"));
  m.def("goniometer_fits", fits, nb::arg("options"));
  m.def("brdf_models", brdf_models);
  m.def(
      "spectrum_file",
      [](const std::string& file, const std::vector<double>& nm, const std::vector<double>& values,
         const std::string& name, bool transmission, const std::string& geometry) {
        require_spectrum_file(file);
        pigment::SampleTable table{nm, {}};
        pigment::Sample& sample = table.samples.emplace_back();
        sample.name = name, sample.paints = {{name, 1}}, sample.values = values;
        if (transmission) sample.quantity = pigment::Sample::Quantity::transmittance;
        if (nm.size() != values.size()) throw Error("values: expected one for each wavelength");
        write_file_atomically(file, spectrum_file_content(file, table, geometry));
      },
      nb::arg("file"), nb::arg("nm"), nb::arg("values"), nb::arg("name"), nb::arg("transmission"),
      nb::arg("geometry"));
  m.def("spectroradiometer", read_array, nb::arg("options"));
  m.def("colours", colours, nb::arg("targets"), nb::arg("standard"), nb::arg("viewing"), nb::arg("others"),
        nb::arg("cmc"));
  m.def("viewed_at", viewed_at, nb::arg("illuminant"), nb::arg("degrees"));
  m.def("convert_bsdf", convert, nb::arg("target"), nb::arg("output"), nb::arg("defines"),
        nb::arg("options"));
}

}  // namespace aureole::python
