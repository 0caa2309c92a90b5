// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_laboratory_plots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/laboratory/brdf_fit.h"
#include "aureole/instrument/laboratory/goniometer.h"
#include "aureole/instrument/laboratory/spectrophotometer.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/math/vec.h"

namespace aureole {
namespace {

constexpr const char* kLaboratoryColours[] = {"#2050c0", "#208030", "#c03020",
                                              "#806020", "#802080", "#208080"};

Bench gallery_bench(std::int64_t paths, const std::atomic<bool>& stop) {
  TraceSettings trace;
  trace.paths = paths, trace.stop = &stop;
  return {SpectralGrid::over(360, 830), 1, {{550}, 10}, trace};
}

/// Fresnel's reflectance of unpolarised light from outside.
double reflectance_of(double cosine, double n) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
  const double s = (cosine - n * t) / (cosine + n * t), p = (n * cosine - t) / (n * cosine + t);
  return 0.5 * (s * s + p * p);
}

/// The reflectance factor of a Lambertian base under a smooth interface (J. L. Saunderson 1942), viewed and lit in one direction
/// each; without `lit` by even light.
double saunderson(double base, double n, double viewed, const double* lit) {
  double outside = 0;  // the mean reflectance of diffuse light from outside
  constexpr int kNodes = 4000;
  for (int i = 0; i < kNodes; ++i) {
    const double cosine = (i + 0.5) / kNodes;
    outside += 2 * cosine * reflectance_of(cosine, n) / kNodes;
  }
  const double inside = 1 - (1 - outside) / (n * n);
  const double in = lit ? 1 - reflectance_of(*lit, n) : 1 - outside;
  return in * (1 - reflectance_of(viewed, n)) / (n * n) * base / (1 - base * inside);
}

/// f of a fitted model in the plane of incidence as a curve.
PlotSeries fitted_lobe(const BrdfFit& fit, double incident, bool is_named, const char* colour) {
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const auto bsdf = std::dynamic_pointer_cast<const Bsdf>(
      load_object_from_string("<scene version=\"3.0.0\">" + fit.bsdf + "</scene>", "fit", grid).object);
  const Wavelengths w = Wavelengths::at(grid, Spectrum(550.f));
  const SurfacePoint point;
  const auto direction = [](double angle) {
    return Vec3{float(std::sin(angle * kDegree)), 0, float(std::cos(angle * kDegree))};
  };
  PlotSeries curve;
  curve.color = colour;
  if (is_named) curve.label = "fitted " + fit.model;
  const Vec3 lamp = direction(-incident);
  for (double angle = -85; angle <= 85; angle += 1) {
    curve.x.push_back(angle);
    curve.y.push_back(double(bsdf->eval(direction(angle), lamp, {w, point})[0] / lamp.z));
  }
  return curve;
}

}  // namespace

LaboratoryCurves five_instruments(double base, double ior, std::int64_t paths,
                                  const std::atomic<bool>& stop) {
  const Bench bench = gallery_bench(paths, stop);
  const Specimen coated{
      .name = "coated",
      .element = fmt::format("<bsdf type=\"plastic\"><float name=\"diffuse_reflectance\" value=\"{:.9g}\"/>"
                             "<boolean name=\"nonlinear\" value=\"true\"/><float name=\"int_ior\" "
                             "value=\"{:.9g}\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>",
                             base, ior)};
  const double normal = 1, eight = std::cos(8 * kDegree), forty_five = std::cos(45 * kDegree);
  const double at_45 = saunderson(base, ior, normal, &forty_five),
               diffuse = saunderson(base, ior, eight, nullptr);
  const double mirrored = reflectance_of(eight, ior);
  Plot plot{"One coated surface by five instruments", "instrument", "reflectance factor", {}, false};
  PlotSeries traced{.kind = PlotSeries::Kind::points, .x = {}, .y = {}, .low = {}, .high = {}};
  traced.label = "traced, with two standard errors", traced.color = kLaboratoryColours[0];
  PlotSeries theory = traced;
  theory.label = "Saunderson's closed form", theory.color = kLaboratoryColours[2];
  std::vector<std::string> numbers;
  double k = 1;
  for (const auto& [name, expected] : {std::pair("45a:0", at_45),
                                       {"0:45x", at_45},
                                       {"de:8", diffuse},
                                       {"di:8", diffuse + mirrored},
                                       {"8:di", diffuse + mirrored}}) {
    SpectrophotometerSettings s;
    s.geometry = measuring_geometry(name, false);
    const MeasuredSpectrum m = measure_spectrum(bench, coated, s);
    traced.x.push_back(k), traced.y.push_back(m.values[0]);
    traced.low.push_back(m.values[0] - 2 * m.error(0)), traced.high.push_back(m.values[0] + 2 * m.error(0));
    theory.x.push_back(k), theory.y.push_back(expected), k += 1;
    plot.names.push_back(name);
    numbers.push_back(fmt::format("{} {:.5f} ({:.5f})", name, m.values[0], expected));
  }
  plot.series = {traced, theory};
  // The values lie close together: the axis begins a little below them.
  const double least = std::min(*std::min_element(traced.low.begin(), traced.low.end()),
                                *std::min_element(theory.y.begin(), theory.y.end()));
  plot.y_from = std::max(0.0, std::floor(50 * least) / 50);
  return {svg_plot(plot),
          fmt::format("A base of {:g} under an index of {:g}: {}; in brackets the closed form.", base, ior,
                      fmt::join(numbers, ", "))};
}

LaboratoryCurves edge_loss(const std::vector<double>& ports_mm, double scattering_per_mm, double thickness_mm,
                           std::int64_t paths, const std::atomic<bool>& stop) {
  const Bench bench = gallery_bench(paths, stop);
  Specimen slab{.name = "slab"};
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  slab.bsdf = std::dynamic_pointer_cast<const Bsdf>(
      load_object_from_string("<scene version=\"3.0.0\"><bsdf type=\"null\"/></scene>", "slab", grid).object);
  slab.medium = std::dynamic_pointer_cast<const Medium>(
      load_object_from_string(
          fmt::format(
              "<scene version=\"3.0.0\"><medium type=\"homogeneous\"><float name=\"sigma_t\" value=\"{:.9g}\"/>"
              "<float name=\"albedo\" value=\"0.999\"/></medium></scene>",
              1e3 * scattering_per_mm),
          "slab", grid)
          .object);
  slab.thickness_m = 1e-3 * thickness_mm;
  Plot plot{"Light lost beside the port", "diameter of the port, mm", "reflectance factor de:8", {}, false};
  std::vector<std::string> numbers;
  int colour = 0;
  PlotSeries predicted;
  predicted.label = "diffusion, scaled to the widest port", predicted.color = kLaboratoryColours[1];
  double widest = 0;
  for (const bool by_theory : {true, false}) {
    PlotSeries series{.kind = by_theory ? PlotSeries::Kind::line : PlotSeries::Kind::points,
                      .x = {},
                      .y = {},
                      .low = {},
                      .high = {}};
    series.label = by_theory ? "even light on the port (theory)" : "traced sphere, two standard errors";
    series.color = kLaboratoryColours[colour], colour += 2;
    for (const double port : ports_mm) {
      SpectrophotometerSettings s;
      s.geometry = measuring_geometry("de:8", false);
      s.by_theory = by_theory, s.port_m = 1e-3 * port, s.viewed_m = std::min(0.6e-3 * port, 12e-3),
      s.lit_m = s.port_m, s.sample_m = 0.2;
      const MeasuredSpectrum m = measure_spectrum(bench, slab, s);
      series.x.push_back(port), series.y.push_back(m.values[0]);
      if (!by_theory)
        series.low.push_back(m.values[0] - 2 * m.error(0)),
            series.high.push_back(m.values[0] + 2 * m.error(0));
      else
        numbers.push_back(fmt::format("{:g} mm {:.4f}", port, m.values[0]));
      if (by_theory && !m.edge_loss.empty()) {
        predicted.x.push_back(port), predicted.y.push_back(1 - m.edge_loss[0]);
        widest = m.values[0] / (1 - m.edge_loss[0]);
      }
    }
    plot.series.push_back(series);
  }
  for (double& y : predicted.y) y *= widest;
  if (!predicted.x.empty()) plot.series.push_back(predicted);
  return {svg_plot(plot),
          fmt::format("A slab of {:g} mm that scatters {:g} times a mm, albedo 0.999, reads {}.",
                      thickness_mm, scattering_per_mm, fmt::join(numbers, ", "))};
}

LaboratoryCurves measured_lobes(double alpha, const std::vector<double>& incident, std::int64_t paths,
                                const std::atomic<bool>& stop) {
  TraceSettings trace;
  trace.paths = paths, trace.replicates = 8, trace.stop = &stop;
  const Bench bench(SpectralGrid::over(360, 830), 1, {{550}, 10}, trace);
  Specimen metal{.name = "metal",
                 .element = fmt::format(
                     "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><string "
                     "name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" value=\"{:.9g}\"/></bsdf>",
                     alpha)};
  GoniometerSettings s;
  s.noise = 0.02;
  GonioPlan plan;
  plan.kind = GonioPlan::Kind::in_plane, plan.incident = incident, plan.directions = 69;
  const GonioTable table = measure_scattering(bench, metal, s, plan);
  FitSettings fit;
  fit.lamp_angle = s.lamp_angle, fit.detector_angle = s.detector_angle;
  fit.viewed_m = s.viewed_m, fit.distance_m = s.distance_m;
  fit.models = {"beckmann", "ggx"};
  const std::vector<BrdfFit> fits = fit_brdfs(table, fit);
  Plot plot{"Lobes of a goniometer", "angle from the normal, degrees", "f, 1/sr", {}, false};
  for (std::size_t k = 0; k < incident.size(); ++k)
    plot.series.push_back(fitted_lobe(fits[0], incident[k], k == 0, kLaboratoryColours[k % 6]));
  for (std::size_t k = 0; k < incident.size(); ++k) {
    PlotSeries series{.kind = PlotSeries::Kind::points, .x = {}, .y = {}, .low = {}, .high = {}};
    series.label = fmt::format("incidence {:g} degrees", incident[k]),
    series.color = kLaboratoryColours[k % 6];
    for (const GonioReading& r : table.readings)
      if (r.theta_i == incident[k]) {
        series.x.push_back(r.phi_o > 90 ? r.theta_o : -r.theta_o), series.y.push_back(r.f[0]);
        series.low.push_back(r.f[0] - 2 * r.error[0]), series.high.push_back(r.f[0] + 2 * r.error[0]);
      }
    plot.series.push_back(series);
  }
  std::string caption = fmt::format("A GGX of alpha {:g}, apertures of 0.5 degrees, noise of 2 %. ", alpha);
  for (const BrdfFit& f : fits)
    for (const FittedParameter& p : f.parameters)
      if (p.name == "alpha")
        caption += fmt::format("Fitted {}: alpha {:.4f} ({:.4f} to {:.4f}), AIC {:.0f}. ", f.model, p.value,
                               p.low, p.high, f.aic);
  return {svg_plot(plot), caption};
}

}  // namespace aureole
