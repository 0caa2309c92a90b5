// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/spectrophotometer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/keyed_random.h"
#include "aureole/instrument/laboratory/lateral_spread.h"
#include "aureole/instrument/laboratory/spectrophotometer_scene.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/math/vec.h"

namespace aureole {
namespace {

using End = MeasuringGeometry::End;
using Method = SpectrophotometerSettings::Method;
using Reads = SpectrophotometerScenes::Reads;

/// A number of the standard normal distribution (G. E. P. Box, M. E. Muller 1958).
double normal_number(KeyedRandom& random) {
  const double u = 1 - double(random.next()), v = double(random.next());
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPiD * v);
}

/// The standard error of a mean of values with these deviations.
double error_of(const std::vector<double>& deviations) {
  const double n = double(deviations.size());
  double squares = 0;
  for (const double d : deviations) squares += d * d;
  return n > 1 ? std::sqrt(squares / (n * (n - 1))) : INFINITY;
}

/// The errors of the values of all bands by their deviations.
std::vector<double> tracing_errors(const std::vector<std::vector<double>>& deviations, std::size_t bands) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < bands; ++i) {
    std::vector<double> of_band;
    for (const auto& replicate : deviations) of_band.push_back(replicate[i]);
    errors.push_back(error_of(of_band));
  }
  return errors;
}

/// Measured means over triangles of the width w exceed the spectrum by w^2/12 times its second derivative; this subtracts it
/// (E. I. Stearns, R. E. Stearns, Color Res. Appl. 13(4), 1988; their 0.083 is 1/12 for a width of one step).
void correct_bandwidth(const Bands& bands, MeasuredSpectrum& m) {
  const std::vector<double>& nm = bands.nm;
  const std::size_t n = nm.size();
  if (n < 2) {
    m.notes.push_back("the bandwidth is not corrected: that needs neighbours");
    return;
  }
  const double step = nm[1] - nm[0];
  for (std::size_t i = 1; i < n; ++i)
    if (std::abs(nm[i] - nm[i - 1] - step) > 1e-6 * step) {
      m.notes.push_back("the bandwidth is not corrected: that needs equal steps of wavelength");
      return;
    }
  const double a = bands.width_nm * bands.width_nm / (12 * step * step);
  const auto corrected = [&](const std::vector<double>& x) {
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double low = i > 0 ? x[i - 1] : x[i], high = i + 1 < n ? x[i + 1] : x[i];
      y[i] = (1 + 2 * a) * x[i] - a * (low + high);
    }
    return y;
  };
  m.values = corrected(m.values);
  // Bands share the paths of a replicate; the noise of the detector is that of each band alone.
  for (auto& replicate : m.deviations) replicate = corrected(replicate);
  for (MeasuredSpectrum::Cause& cause : m.causes) {
    if (cause.name == "tracing") cause.errors = tracing_errors(m.deviations, n);
    if (cause.name != "detector") continue;
    const std::vector<double> before = cause.errors;
    for (std::size_t i = 0; i < n; ++i) {
      const bool has_low = i > 0, has_high = i + 1 < n;
      cause.errors[i] = std::hypot((1 + a * (int(has_low) + int(has_high))) * before[i],
                                   a * std::hypot(has_low ? before[i - 1] : 0, has_high ? before[i + 1] : 0));
    }
  }
}

/// Adds the noise of the detector to the values, and the uncertainties of detector, standard and wavelengths.
void add_errors(const Bench& bench, const SpectrophotometerSettings& s, double standard,
                MeasuredSpectrum& m) {
  const std::vector<double>& nm = m.nm;
  const std::size_t n = nm.size();
  std::vector<double> detector(n), of_standard(n), wavelength(n);
  const std::vector<double> noiseless = m.values;
  for (std::size_t i = 0; i < n; ++i) {
    const double signal = noiseless[i] / standard;
    // The sample's reading has the root of the signal for noise, as counted light has; the standard's reading is relative.
    const double sample2 = s.noise * s.noise * std::max(signal, 0.0) + s.dark_noise * s.dark_noise;
    const double standard2 = (s.noise * s.noise + s.dark_noise * s.dark_noise) * signal * signal;
    detector[i] = standard * std::sqrt(sample2 + standard2);
    of_standard[i] = std::abs(noiseless[i]) * s.standard_error;
    if (n > 1) {
      const std::size_t a = i > 0 ? i - 1 : i, b = i + 1 < n ? i + 1 : i;
      wavelength[i] = std::abs((noiseless[b] - noiseless[a]) / (nm[b] - nm[a])) * s.wavelength_error_nm;
    }
    KeyedRandom random(std::uint32_t(mix_bits(bench.settings().seed * 0x9e3779b97f4a7c15u + i) >> 16));
    if (detector[i] > 0) m.values[i] += detector[i] * normal_number(random);
  }
  m.causes.push_back({"detector", detector});
  if (standard != 1 || s.standard_error > 0) m.causes.push_back({"standard", of_standard});
  m.causes.push_back({"wavelength", wavelength});
}

/// A scene of the instrument with its detectors' mean.
Readings read(const Bench& bench, const InstrumentScene& scene) {
  const Readings all = bench.trace(scene.content, scene.given, scene.detectors, scene.integrator);
  return all.detectors() > 1 ? all.averaged() : all;
}

/// Readings of the sample and of what it is compared with, and the factor by band that makes a reflectance of their quotient.
struct ReadingPair {
  Readings over, under;
  std::vector<double> scale;
};

ReadingPair read_pair(const Bench& bench, const Specimen& specimen, const SpectrophotometerSettings& s,
                      const SpectrophotometerScenes& scenes, bool by_theory,
                      std::vector<std::string>& notes) {
  const MeasuringGeometry& g = s.geometry;
  const std::size_t n = bench.bands().nm.size();
  const bool is_diffuse = g.light >= End::sphere && g.view >= End::sphere;
  // A beam into a collecting sphere is compared with itself on the wall, whose reflectance is known (A. H. Taylor 1935).
  const bool by_wall =
      s.method == Method::absolute && !by_theory && !g.transmits && !is_diffuse && g.view >= End::sphere;
  const double reference = by_wall ? s.wall : s.standard;
  const Specimen standard = g.transmits ? open_port() : lambertian_standard(reference);
  double scale = g.transmits ? 1 : reference;
  const bool is_absolute = s.method == Method::absolute && !g.transmits && !by_wall;
  if (is_absolute) scale = is_diffuse || !g.has_sphere() ? 1 : kPiD;
  const bool beside =
      (s.method == Method::comparison || by_wall) && g.has_sphere() && !g.transmits && !is_diffuse;
  // The open port is measured with the specular port closed, which would take all of its light. The sphere is brighter then.
  SpectrophotometerSettings of_standard = s;
  if (g.transmits && (by_theory || !scenes.has_reference_beam()) &&
      (g.light == End::sphere_without_specular || g.view == End::sphere_without_specular)) {
    of_standard.geometry = measuring_geometry(g.light < End::sphere ? "0:di" : "di:0", true);
    const SpectrophotometerScenes closed(bench, of_standard);
    if (!by_theory) scale *= closed.sphere().throughput(0) / scenes.sphere().throughput(0);
  }
  const SpectrophotometerScenes standard_scenes(bench, of_standard);
  if (by_theory) {
    ReadingPair pair{read(bench, scenes.in_even_light(specimen, Reads::sample)),
                     read(bench, is_absolute ? scenes.in_even_light(specimen, Reads::irradiance)
                                             : standard_scenes.in_even_light(standard, Reads::sample)),
                     std::vector<double>(n, scale)};
    if (g.view >= End::sphere && g.light < End::sphere)
      notes.push_back(
          fmt::format("{} by theory is measured with light and detector exchanged (Helmholtz)", g.name));
    if (s.method == Method::substitution) {
      const IntegratingSphere sphere = scenes.sphere();
      const Readings of_sample = read(bench, scenes.diffuse_reflection(specimen));
      const Readings of_white = read(bench, scenes.diffuse_reflection(lambertian_standard(1)));
      for (std::size_t i = 0; i < n; ++i) {
        const double diffuse = ratio_of(of_sample, 0, of_white, 0, i).value;
        pair.scale[i] *= sphere.throughput(diffuse) / sphere.throughput(g.transmits ? 0 : s.standard);
      }
    }
    return pair;
  }
  const std::vector<double> scales(n, scale);
  if (is_absolute) {
    // Rays of a cosine receiver find even light; that of a lamp is told by a perfect diffuser, which has it over pi for radiance.
    return {read(bench, scenes.instrument(specimen, nullptr, Reads::sample)),
            read(bench, g.has_sphere() ? scenes.instrument(specimen, nullptr, Reads::irradiance)
                                       : scenes.instrument(lambertian_standard(1), nullptr, Reads::sample)),
            scales};
  }
  if (beside)
    return {read(bench, scenes.instrument(specimen, &standard, Reads::sample)),
            read(bench, scenes.instrument(specimen, &standard, Reads::standard_beside)), scales};
  if (scenes.has_reference_beam())
    return {read(bench, scenes.instrument(specimen, nullptr, Reads::sample)),
            read(bench, scenes.instrument(specimen, nullptr, Reads::reference_beam)),
            std::vector<double>(n, scenes.reference_flux())};
  if (s.method == Method::comparison && g.has_sphere())
    notes.push_back(fmt::format("{} has one port: sample and {} take turns (substitution)", g.name,
                                g.transmits ? "open port" : "standard"));
  if (s.method == Method::absolute)
    notes.push_back(fmt::format(
        "{}, absolute: the open port has the incident flux, to which the transmitted one is compared",
        g.name));
  return {read(bench, scenes.instrument(specimen, nullptr, Reads::sample)),
          read(bench, standard_scenes.instrument(standard, nullptr, Reads::sample)), scales};
}

/// Values of a traced sphere by its theory as a control: traced over theoretical readings are fitted by c0 + c1 x, where x is the
/// theoretical value less its mean, and multiply the theoretical values. Errors are those of the jackknife over the replicates, which
/// leaves out one after the other in all readings (B. Efron, The Jackknife, the Bootstrap and Other Resampling Plans, 1982).
void pool(const ReadingPair& traced, const ReadingPair& theory, std::vector<double>& values,
          std::vector<std::vector<double>>& deviations) {
  const std::size_t n = traced.scale.size(), replicates = traced.over.replicates();
  const auto mean_without = [&](const Readings& r, std::size_t left_out, std::size_t band) {
    double sum = 0;
    for (std::size_t k = 0; k < replicates; ++k)
      if (k != left_out) sum += r.at(k, 0, band);
    return sum;
  };
  const auto values_without = [&](std::size_t left_out) {
    std::vector<double> x(n), out(n);
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double under = mean_without(theory.under, left_out, i);
      x[i] = theory.scale[i] * (under != 0 ? mean_without(theory.over, left_out, i) / under : 0);
      mean += x[i] / double(n);
    }
    // The sample's traced readings t are c(x) times what theory makes of the standard's, a. Two moments of t - a c(x), whose weights have
    // no noise of the traced readings, are zero: squares of noisy readings would bias the fit.
    double spread = 0, a0 = 0, a1 = 0, a2 = 0, t0 = 0, t1 = 0;
    for (std::size_t i = 0; i < n; ++i) spread += (x[i] - mean) * (x[i] - mean) / double(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (!(x[i] > 0)) continue;
      const double d = x[i] - mean, weight = 1 / x[i], t = mean_without(traced.over, left_out, i),
                   a = x[i] / traced.scale[i] * mean_without(traced.under, left_out, i);
      a0 += weight * a, a1 += weight * a * d, a2 += weight * a * d * d, t0 += weight * t,
          t1 += weight * d * t;
    }
    // Without contrast between the bands a line has no slope.
    const bool has_slope = std::sqrt(spread) > 0.02 * std::abs(mean);
    double c0 = a0 > 0 ? t0 / a0 : 1, c1 = 0;
    if (const double determinant = a0 * a2 - a1 * a1; has_slope && determinant > 0)
      c0 = (t0 * a2 - t1 * a1) / determinant, c1 = (t1 * a0 - t0 * a1) / determinant;
    for (std::size_t i = 0; i < n; ++i) out[i] = x[i] * (c0 + c1 * (x[i] - mean));
    return out;
  };
  values = values_without(replicates);
  std::vector<std::vector<double>> parts;
  for (std::size_t k = 0; k < replicates; ++k) parts.push_back(values_without(k));
  deviations.assign(replicates, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    double mean = 0;
    for (const auto& p : parts) mean += p[i] / double(replicates);
    for (std::size_t k = 0; k < replicates; ++k)
      deviations[k][i] = double(replicates - 1) * (parts[k][i] - mean);
  }
}

/// The deviations of a quotient of readings, of which `ratio_of` makes its error.
std::vector<std::vector<double>> deviations_of(const ReadingPair& pair, const std::vector<double>& values) {
  std::vector<std::vector<double>> deviations(pair.over.replicates(), std::vector<double>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double under = pair.under.mean(0, i);
    for (std::size_t k = 0; k < deviations.size(); ++k)
      if (under != 0)
        deviations[k][i] =
            (pair.scale[i] * pair.over.at(k, 0, i) - values[i] * pair.under.at(k, 0, i)) / under;
  }
  return deviations;
}

}  // namespace

std::vector<MeasuringGeometry> measuring_geometries(bool transmission) {
  constexpr End kSpecular = End::sphere, kDiffuse = End::sphere_without_specular;
  if (transmission)
    return {{"0:0", true, End::normal, End::normal}, {"di:0", true, kSpecular, End::normal},
            {"de:0", true, kDiffuse, End::normal},   {"0:di", true, End::normal, kSpecular},
            {"0:de", true, End::normal, kDiffuse},   {"d:d", true, kSpecular, kSpecular}};
  return {{"45a:0", false, End::ring, End::normal}, {"45x:0", false, End::forty_five, End::normal},
          {"0:45a", false, End::normal, End::ring}, {"0:45x", false, End::normal, End::forty_five},
          {"di:8", false, kSpecular, End::eight},   {"de:8", false, kDiffuse, End::eight},
          {"8:di", false, End::eight, kSpecular},   {"8:de", false, End::eight, kDiffuse},
          {"d:0", false, kDiffuse, End::normal},    {"d:d", false, kSpecular, kSpecular}};
}

MeasuringGeometry measuring_geometry(const std::string& name, bool transmission) {
  std::vector<std::string> names;
  for (const MeasuringGeometry& g : measuring_geometries(transmission)) {
    if (g.name == name) return g;
    names.push_back(g.name);
  }
  std::string message = fmt::format("\"{}\" is no geometry of {}{}; there are {}", name,
                                    transmission ? "transmission" : "reflection", did_you_mean(name, names),
                                    fmt::join(names, ", "));
  for (const MeasuringGeometry& g : measuring_geometries(!transmission))
    if (g.name == name)
      message += transmission ? "; without --transmission it is one" : "; with --transmission it is one";
  throw Error(message);
}

double MeasuredSpectrum::error(std::size_t band) const {
  double squares = 0;
  for (const Cause& cause : causes) squares += cause.errors[band] * cause.errors[band];
  return std::sqrt(squares);
}

double MeasuredSpectrum::error_of_sum(const std::vector<double>& weights) const {
  std::vector<double> sums;
  for (const auto& replicate : deviations) {
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * replicate[i];
    sums.push_back(sum);
  }
  double squares = std::pow(error_of(sums), 2);
  for (const Cause& cause : causes) {
    if (cause.name == "tracing") continue;
    // Bands have noise of their own, and the standard and the scale of wavelengths in common.
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum +=
          cause.name == "detector" ? std::pow(weights[i] * cause.errors[i], 2) : weights[i] * cause.errors[i];
    squares += cause.name == "detector" ? sum : sum * sum;
  }
  return std::sqrt(squares);
}

MeasuredSpectrum measure_spectrum(const Bench& bench, const Specimen& specimen,
                                  const SpectrophotometerSettings& s) {
  const SpectrophotometerScenes scenes(bench, s);
  const MeasuringGeometry& g = s.geometry;
  const std::size_t n = bench.bands().nm.size();
  if (const double index = specimen.index_behind(bench.grid()); g.transmits && index != 1)
    throw Error(fmt::format(
        "\"{}\" is the surface of a body of index {:.4g}, in which transmitted light would go on: name a shape with "
        "thickness, which becomes a slab, or take `thindielectric`",
        specimen.name, index));
  MeasuredSpectrum m;
  m.nm = bench.bands().nm, m.notes = bench.notes();
  if (s.is_pooled && !s.by_theory && g.has_sphere()) {
    const ReadingPair traced = read_pair(bench, specimen, s, scenes, false, m.notes);
    std::vector<std::string> of_theory;
    const ReadingPair theory = read_pair(bench, specimen, s, scenes, true, of_theory);
    pool(traced, theory, m.values, m.deviations);
  } else {
    if (s.is_pooled)
      m.notes.push_back("readings are pooled where a sphere is traced; here that has no effect");
    const ReadingPair pair = read_pair(bench, specimen, s, scenes, s.by_theory, m.notes);
    for (std::size_t i = 0; i < n; ++i) {
      const Ratio q = ratio_of(pair.over, 0, pair.under, 0, i);
      m.values.push_back(pair.scale[i] * q.value);
    }
    m.deviations = deviations_of(pair, m.values);
  }
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(m.values[i]))
      throw Error(fmt::format("{}: the instrument receives no light of its {} at {:g} nm", g.name,
                              s.method == Method::absolute ? "lamp"
                              : g.transmits                ? "open port"
                                                           : "standard",
                              m.nm[i]));
  if (!g.transmits) {
    // Where a sphere lights or collects, its port bounds the light; the other end, viewed or lit, is a disc within it.
    const bool collects = g.view >= End::sphere && g.light < End::sphere;
    const double outer = 0.5 * (g.has_sphere() ? s.port_m : s.lit_m),
                 inner = 0.5 * (collects                ? s.lit_m
                                : g.view >= End::sphere ? s.port_m
                                                        : s.viewed_m);
    for (const double nm : m.nm)
      if (const auto diffusion = diffusion_of(specimen, bench.grid(), bench.length_unit_m(), nm))
        m.edge_loss.push_back(1 - optics::port_part(*diffusion, inner, outer));
    if (!m.edge_loss.empty()) {
      const auto [low, high] = std::minmax_element(m.edge_loss.begin(), m.edge_loss.end());
      m.notes.push_back(fmt::format(
          "edge loss: diffusion predicts that {:.2g} to {:.2g} % of the light that a wide port would read leaves the "
          "sample beside the {} of {:g} mm",
          100 * *low, 100 * *high, g.has_sphere() ? "port" : "lit area", 2e3 * outer));
    }
  }
  m.causes.push_back({"tracing", tracing_errors(m.deviations, n)});
  add_errors(bench, s, s.method == Method::absolute ? 1 : g.transmits ? 1 : s.standard, m);
  if (s.correct_bandwidth) correct_bandwidth(bench.bands(), m);
  return m;
}

std::vector<double> luminance_weights(const std::vector<double>& nm) {
  if (nm.size() == 1) return {1};
  std::vector<double> weights;
  double sum = 0;
  const pigment::Observation observer = observe("C", nm);
  for (const pigment::Xyz& w : observer.weights()) weights.push_back(w[1]), sum += w[1];
  for (double& w : weights) w /= sum;
  return weights;
}

void use_beam_of_haze(SpectrophotometerSettings& s) {
  s.lamp_angle = 0.1, s.viewed_m = s.lit_m = 2e-3, s.distance_m = 1;
}

void set_beam(SpectrophotometerSettings& s, const StatedBeam& stated) {
  s.lamp_angle = stated.lamp_angle.value_or(s.lamp_angle);
  if (!stated.viewed_m && !stated.lit_m) return;
  s.viewed_m = stated.viewed_m.value_or(SpectrophotometerSettings{}.viewed_m);
  s.lit_m = stated.lit_m.value_or(s.viewed_m + 4e-3);
}

Haze measure_haze(const Bench& bench, const Specimen& specimen, SpectrophotometerSettings s, double angle,
                  const std::vector<double>& weights) {
  if (!(angle > 0 && angle <= 10))
    throw Error(fmt::format("haze beyond {:g} degrees: more than 0 and at most 10 is expected", angle));
  s.specular_angle = angle;
  s.geometry = measuring_geometry("0:di", true);
  const MeasuredSpectrum total = measure_spectrum(bench, specimen, s);
  s.geometry = measuring_geometry("0:de", true);
  const MeasuredSpectrum diffuse = measure_spectrum(bench, specimen, s);
  Haze h;
  double scattered = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    h.total += weights[i] * total.values[i], scattered += weights[i] * diffuse.values[i];
  h.total_error = total.error_of_sum(weights);
  if (!(h.total > 0))
    throw Error(
        "no light through the sample was found, of which haze could be a part; more paths, or the sphere by theory, find more");
  h.haze = scattered / h.total;
  h.haze_error = std::hypot(diffuse.error_of_sum(weights), h.haze * h.total_error) / h.total;
  return h;
}

Ratio measure_gloss(const Bench& bench, const Specimen& specimen, double angle,
                    const SpectrophotometerSettings& s, const std::vector<double>& weights) {
  // Angles of the image of the source and of the receptor's aperture, in the plane of incidence and across (ISO 2813).
  struct Apertures {
    double angle, width, height;
  };
  constexpr Apertures kReceptors[] = {{20, 1.80, 3.6}, {60, 4.4, 11.7}, {85, 4.0, 6.0}};
  constexpr double kSourceWidth = 0.75, kSourceHeight = 2.5;
  const auto* at = std::find_if(std::begin(kReceptors), std::end(kReceptors),
                                [&](const Apertures& a) { return a.angle == angle; });
  if (at == std::end(kReceptors))
    throw Error(fmt::format("gloss at {:g} degrees: ISO 2813 has 20, 60 and 85 degrees", angle));
  // At a distance of many spots the light is as parallel as a lens makes it.
  const double distance = 500 * s.viewed_m, unit = bench.length_unit_m();
  const auto extent = [&](double degrees) { return 2 * distance * std::tan(0.5 * degrees * kDegree); };
  const double t = angle * kDegree;
  const std::array<double, 3> from{std::sin(t) * distance / unit, 0, std::cos(t) * distance / unit};
  const Transform lamp = facing(from, {-std::sin(t), 0, -std::cos(t)});
  if (s.sample_m < 2 * s.viewed_m)
    throw Error(fmt::format("the sample of {:g} mm is smaller than the lit spot of {:g} mm", s.sample_m * 1e3,
                            2e3 * s.viewed_m));
  const auto read_one = [&](const Specimen& sample) {
    InstrumentScene scene;
    scene.content = specimen_shape(
        sample, {.matrix = matrix_text({}), .radius = 0.5 * s.sample_m / unit, .length_unit_m = unit},
        scene.given);
    // The local x axis of `facing` lies in the plane of incidence.
    scene.content += fmt::format(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"{:.9g}\" y=\"{:.9g}\"/><matrix value=\"{}\"/>"
        "</transform><emitter type=\"beam\"><spectrum name=\"radiance\" value=\"1\"/><float name=\"target_radius\" "
        "value=\"{}\"/></emitter></shape>",
        0.5 * extent(kSourceWidth) / unit, 0.5 * extent(kSourceHeight) / unit, matrix_text(lamp),
        bench.length(s.viewed_m));
    scene.content += fmt::format(
        "<sensor type=\"detector\"><string name=\"directions\" value=\"{:g} 180\"/><float name=\"distance\" value=\"{}\"/>"
        "<float name=\"field_radius\" value=\"{}\"/><string name=\"aperture_size\" value=\"{} {}\"/>{}</sensor>",
        angle, bench.length(distance), bench.length(0.5 * s.viewed_m), bench.length(extent(at->width)),
        bench.length(extent(at->height)), bench.film(1));
    return bench.trace(scene.content, scene.given, 1);
  };
  // One band of luminance.
  const auto luminance = [&](const Readings& all) {
    Readings one(all.replicates(), 1, 1);
    for (std::size_t r = 0; r < all.replicates(); ++r)
      for (std::size_t b = 0; b < all.bands(); ++b) one.at(r, 0, 0) += weights[b] * all.at(r, 0, b);
    return one;
  };
  Ratio gloss = ratio_of(luminance(read_one(specimen)), 0, luminance(read_one(black_glass(1.567))), 0, 0);
  gloss.value *= 100, gloss.error *= 100;
  return gloss;
}

}  // namespace aureole
