// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <span>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/aperture/polygon_aperture.h"
#include "aureole/optics/aperture/round_aperture.h"
#include "aureole/optics/arrangement/pair_statistics.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "gallery/gallery_edge_plots.h"
#include "gallery/gallery_field_plots.h"
#include "gallery/gallery_laboratory_plots.h"
#include "gallery/gallery_light_plots.h"
#include "gallery/gallery_volume_plots.h"

namespace aureole {
namespace {

using Json = nlohmann::json;
using std::numbers::pi;

double number(const GalleryPlot& plot, const char* name) { return plot.parameters.at(name).get<double>(); }
std::vector<double> numbers(const GalleryPlot& plot, const char* name) {
  return plot.parameters.at(name).get<std::vector<double>>();
}

class Output {
public:
  Output(const GalleryPlot& plot, std::filesystem::path folder, PlotResult& result,
         const std::atomic<bool>& stop)
      : plot_(plot), folder_(std::move(folder)), result_(result), stop_(stop) {}
  bool is_stopped() const { return stop_; }
  const std::atomic<bool>& stop() const { return stop_; }
  void svg(const std::string& text, const std::string& caption) {
    const std::string name = next(".svg", caption);
    write_file_atomically(folder_ / name, text);
  }
  /// Writes a picture that is encoded for display.
  void picture(const LightPicture& p) { write_png(folder_ / next(".png", p.caption), p.picture); }
  /// Writes a picture; `value` returns the value in [0, 1] of a pixel.
  void map(int width, int height, const std::function<double(int, int)>& value, const std::string& caption);

private:
  std::string next(const char* extension, const std::string& caption) {
    const std::string name = fmt::format("{}-{}{}", plot_.name, result_.files.size() + 1, extension);
    result_.files.push_back({name, caption});
    return name;
  }
  const GalleryPlot& plot_;
  std::filesystem::path folder_;
  PlotResult& result_;
  const std::atomic<bool>& stop_;
};

/// Returns a colour of the map from dark violet over blue and green to yellow, in equal steps of lightness: a
/// line in Oklab's lightness and hue (B. Ottosson, A perceptual color space for image processing, 2020).
std::array<float, 3> ramp(double t) {
  t = std::clamp(t, 0.0, 1.0);
  const double lightness = 0.12 + 0.83 * t, hue = (305 - 200 * t) * pi / 180;
  for (double chroma = 0.06 + 0.11 * std::sin(pi * (0.15 + 0.75 * t));; chroma *= 0.97) {
    const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
    const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3),
                 m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3),
                 s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    const std::array<double, 3> c{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                                  -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                                  -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
    const auto [low, high] = std::minmax_element(c.begin(), c.end());
    if ((*low >= 0 && *high <= 1) || chroma < 1e-3) {
      std::array<float, 3> out{};
      for (std::size_t k = 0; k < 3; ++k) out[k] = srgb_encode(float(std::clamp(c[k], 0.0, 1.0)));
      return out;
    }
  }
}

void Output::map(int width, int height, const std::function<double(int, int)>& value,
                 const std::string& caption) {
  Image image{width, height, {"R", "G", "B"}, {}, true};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto c = ramp(value(x, y));
      image.pixels.insert(image.pixels.end(), c.begin(), c.end());
    }
  write_png(folder_ / next(".png", caption), image);
}

std::string discs_svg(const optics::HardDiscs& discs, double side) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 420\" width=\"640\" "
      "height=\"420\">\n<rect "
      "width=\"640\" height=\"420\" fill=\"white\"/>\n<svg x=\"120\" y=\"10\" width=\"400\" height=\"400\" "
      "viewBox=\"0 0 {0:.3f} {0:.3f}\"><rect width=\"100%\" height=\"100%\" fill=\"#eef3f8\"/>\n",
      side);
  for (int i = 0; i < discs.size(); ++i)
    if (discs.x[std::size_t(i)] < side + 1 && discs.y[std::size_t(i)] < side + 1)
      out += fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3f}\" fill=\"#2b5d8f\"/>\n",
                         discs.x[std::size_t(i)], discs.y[std::size_t(i)], discs.radius[std::size_t(i)]);
  return out + "</svg>\n</svg>\n";
}

/// Returns g(r) of Percus and Yevick by the inverse Hankel transform of S' - 1, multiplied by a Hann window
/// that ends at u = 300. The step at contact is 0.01 wide.
std::vector<double> pair_correlation(double area_fraction, const std::vector<double>& r) {
  constexpr double kEnd = 300, kStep = 0.05;
  std::vector<double> g(r.size(), 1);
  for (double u = kStep / 2; u < kEnd; u += kStep) {
    const double w = (optics::hard_disc_structure_factor(u, area_fraction) - 1) * u * kStep * 0.5 *
                     (1 + std::cos(pi * u / kEnd)) / (2 * area_fraction);
    for (std::size_t i = 0; i < r.size(); ++i) g[i] += w * ::j0(u * r[i]);
  }
  return g;
}

void plot_hard_discs(const GalleryPlot& plot, GallerySize size, Output& out) {
  const int discs = size == kFullSize ? 2000 : 1000, snapshots = size == kFullSize ? 1600 : 300;
  for (const double fa : numbers(plot, "area_fractions")) {
    optics::HardDiscSimulation simulation(discs, fa, 1);
    simulation.advance(simulation.equilibration_sweeps());
    std::vector<double> edges;
    const double box = simulation.state().box_x;
    // Edges of rings that are as narrow as the wave vectors of the periodic box allow.
    for (double u = 1.1 * 2 * pi / box; u < 16; u += 1.1 * 2 * pi / box) edges.push_back(u);
    optics::RingStructureFactor structure(box, simulation.state().box_y, edges, 24);
    optics::PairHistogram pairs(10, 200);
    out.svg(discs_svg(simulation.state(), 24), fmt::format("Fa = {:g}: one arrangement, 24 radii wide", fa));
    for (int i = 0; i < snapshots; ++i) {
      if (out.is_stopped()) return;
      simulation.advance(simulation.decorrelation_sweeps());
      structure.add(simulation.state());
      pairs.add(simulation.state());
    }
    PlotSeries points{PlotSeries::Kind::points, {}, {}, {}, {}, 0, "simulated", ""}, line;
    line.label = "Percus-Yevick";
    for (int i = 0; i < pairs.bins(); ++i) {
      points.x.push_back(pairs.r(i)), points.y.push_back(pairs.g(i).mean());
      if (pairs.r(i) >= 2) line.x.push_back(pairs.r(i));
    }
    line.y = pair_correlation(fa, line.x);
    out.svg(svg_plot({"Pair correlation", "r/a", "g", {line, points}, false}), fmt::format("Fa = {:g}", fa));
    points.x.clear(), points.y.clear(), line.x.clear(), line.y.clear();
    for (int i = 0; i < structure.rings(); ++i)
      points.x.push_back(structure.q(i)), points.y.push_back(structure.total(i).mean());
    for (double u = 0; u <= 16; u += 0.04)
      line.x.push_back(u), line.y.push_back(optics::hard_disc_structure_factor(u, fa));
    out.svg(svg_plot({"Structure factor", "u = q a", "S'", {line, points}, false}),
            fmt::format("Fa = {:g}", fa));
  }
}

/// Plots the radiance of a layer for unit irradiance at normal incidence: rho0 |F|^2 S'/lambda^2 for flat
/// discs, rho0 dC/dOmega S'/cos theta for spheres.
void plot_lobes(const GalleryPlot& plot, GallerySize, Output& out) {
  const double fa = number(plot, "area_fraction"), nm = number(plot, "wavelength_nm"),
               index = number(plot, "index"), end = number(plot, "degrees");
  for (const double radius : numbers(plot, "radii_um")) {
    const double a = radius * 1000, k = 2 * pi / nm, density = fa / (pi * a * a);
    const optics::Mie mie(k * a, index);
    PlotSeries flat, sphere;
    flat.label = "Fraunhofer", sphere.label = "Mie", sphere.color = "#b0413e";
    for (int i = 0; i <= 600; ++i) {
      const double degrees = end * i / 600, theta = degrees * pi / 180, q = k * std::sin(theta);
      const double s = optics::hard_disc_structure_factor(q * a, fa);
      flat.x.push_back(degrees), sphere.x.push_back(degrees);
      flat.y.push_back(density * std::pow(optics::circle_aperture_transform(q, a) / nm, 2) * s);
      sphere.y.push_back(density * mie.amplitudes(std::cos(theta)).intensity() / (k * k) * s /
                         std::cos(theta));
    }
    // Largest value, from which the logarithmic axis is limited, since zeros of the disc's transform would
    // extend it indefinitely.
    const double top = *std::max_element(sphere.y.begin(), sphere.y.end());
    for (auto* series : {&flat, &sphere})
      for (double& y : series->y) y = std::max(y, top * 1e-8);
    out.svg(
        svg_plot({fmt::format("a = {:g} um", radius), "theta / degrees", "f / sr^-1", {flat, sphere}, true}),
        "");
  }
}

/// Plots |F|^2/|A| of the shape over direction cosines in (-2, 2)^2, in shades of grey over four decades.
void plot_aperture_map(const GalleryPlot& plot, GallerySize size, Output& out) {
  const double radius = number(plot, "radius_um") * 1000, nm = number(plot, "wavelength_nm"),
               decades = number(plot, "decades");
  std::shared_ptr<const optics::ApertureShape> shape;
  const auto name = plot.parameters.at("shape").get<std::string>();
  const bool round = name == "circle";
  if (round) {
    shape = std::make_shared<optics::EllipseAperture>(radius, radius);
  } else {
    const double c = radius / std::numbers::sqrt2;
    shape = std::make_shared<optics::PolygonAperture>(
        optics::PolygonRegion::even_odd({{{-c, -c}, {c, -c}, {c, c}, {-c, c}}}));
  }
  const int n = size == kFullSize ? 768 : 320;
  out.map(
      n, n,
      [&](int x, int y) {
        const double u = (x + 0.5) / n * 3 - 1.5, v = (y + 0.5) / n * 3 - 1.5;
        return (round ? std::hypot(u, v) < 1 : std::max(std::abs(u), std::abs(v)) < std::numbers::sqrt2 / 2)
                   ? 1.
                   : 0.;
      },
      fmt::format("the {}; its circle has a radius of {:g} um", name, radius / 1000));
  const double k = 2 * pi / nm;
  out.map(
      n, n,
      [&](int x, int y) {
        const double dx = (x + 0.5) / n * 4 - 2, dy = 2 - (y + 0.5) / n * 4;
        const double relative = std::norm(shape->transform(k * dx, k * dy)) / std::pow(shape->area(), 2);
        return 1 + std::log10(std::max(relative, 1e-30)) / decades;
      },
      fmt::format(
          "|F|^2 over the difference of direction cosines, -2 to 2 both ways, at {:g} nm; {:g} decades", nm,
          decades));
}

void plot_structure_map(const GalleryPlot& plot, GallerySize size, Output& out) {
  const double end = number(plot, "u"), top = number(plot, "highest");
  const int width = size == kFullSize ? 1024 : 480, height = width / 2;
  out.map(
      width, height,
      [&](int x, int y) {
        const double fa = optics::kMaxAreaFraction * (1 - (y + 0.5) / height);
        return optics::hard_disc_structure_factor((x + 0.5) / width * end, fa) / top;
      },
      fmt::format(
          "S': u = q a from 0 to {:g} to the right, Fa from 0 to {:g} upwards; black is 0, white {:g}", end,
          optics::kMaxAreaFraction, top));
}

void draw(const EdgeMap& map, GallerySize size, Output& out) {
  const int n = size == kFullSize ? 512 : 200;
  out.map(
      n, n, [&](int x, int y) { return map.value((x + 0.5) * 2 / n - 1, 1 - (y + 0.5) * 2 / n); },
      map.caption);
}

void plot_edge_waves(const GalleryPlot& plot, GallerySize size, Output& out) {
  for (const double b : numbers(plot, "b"))
    draw(edge_wave_map(number(plot, "a"), b, number(plot, "extent"), number(plot, "inset")), size, out);
}

void plot_edge_amplitude(const GalleryPlot& plot, GallerySize, Output& out) {
  for (const double ratio : numbers(plot, "ratios")) {
    const EdgeCurves curves = edge_amplitude(number(plot, "a"), number(plot, "b"), ratio);
    out.svg(curves.svg, curves.caption);
  }
}

void plot_slits(const GalleryPlot& plot, GallerySize, Output& out) {
  const EdgeCurves curves =
      slits_profile({0.299792458 / number(plot, "GHz"), number(plot, "width_m"), number(plot, "height_m"),
                     number(plot, "apart_m"), number(plot, "step_degrees"), numbers(plot, "solver")});
  out.svg(curves.svg, curves.caption);
}

void plot_edge_profile(const GalleryPlot& plot, GallerySize, Output& out) {
  for (const double pieces : numbers(plot, "pieces")) {
    const EdgeCurves curves = edge_profile(number(plot, "sigmas"), int(pieces));
    out.svg(curves.svg, curves.caption);
  }
}

void plot_wedge(const GalleryPlot& plot, GallerySize size, Output& out) {
  for (const double n : numbers(plot, "n"))
    draw(wedge_map(n, number(plot, "degrees") * pi / 180, number(plot, "wavelengths")), size, out);
}

void plot_opening(const GalleryPlot& plot, GallerySize, Output& out) {
  for (const double fresnel : numbers(plot, "fresnel_numbers")) {
    if (out.is_stopped()) return;
    const EdgeCurves curves =
        opening_profile(plot.parameters.at("shape").get<std::string>(), number(plot, "wavelengths"), fresnel);
    out.svg(curves.svg, curves.caption);
  }
}

FieldScene field_scene(const GalleryPlot& plot) {
  const std::vector<double> corners = numbers(plot, "blocks"), map = numbers(plot, "map"),
                            range = numbers(plot, "range_db");
  if (corners.size() % 4 != 0)
    throw Error("a plot \"field_maps\" needs in \"blocks\" four numbers for each block: x0, y0, x1, y1");
  if (map.size() != 4 || !(map[0] < map[2] && map[1] < map[3]))
    throw Error("a plot \"field_maps\" needs \"map\", the numbers x0, y0, x1, y1 with x0 < x1 and y0 < y1");
  if (range.size() != 2 || !(range[0] < range[1]))
    throw Error("a plot \"field_maps\" needs \"range_db\", two increasing numbers");
  FieldScene scene{{}, number(plot, "degrees"), map[0], map[1], map[2], map[3], range[0], range[1]};
  double around = 0;
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    const MetalBlock b{corners[i], corners[i + 1], corners[i + 2], corners[i + 3]};
    if (!(b.x0 < b.x1 && b.y0 < b.y1))
      throw Error(fmt::format(
          "a plot \"field_maps\" needs blocks with x0 < x1 and y0 < y1; the block {} has not", i / 4 + 1));
    around += 2 * (b.x1 - b.x0 + b.y1 - b.y0);
    scene.blocks.push_back(b);
  }
  constexpr double kMost = 300;
  if (around > kMost)
    throw Error(fmt::format(
        "the outlines of the blocks of a plot \"field_maps\" may be {:g} wavelengths long, not {:g}", kMost,
        around));
  return scene;
}

void plot_field_maps(const GalleryPlot& plot, GallerySize size, Output& out) {
  for (const FieldMap& m :
       field_maps(field_scene(plot), size == kFullSize ? 240 : 60, size == kFullSize ? 2 : 1, out.stop()))
    out.map(
        m.width, m.height, [&](int x, int y) { return m.values[std::size_t(y * m.width + x)]; }, m.caption);
}

void plot_instruments(const GalleryPlot& plot, GallerySize size, Output& out) {
  const LaboratoryCurves c = five_instruments(number(plot, "base"), number(plot, "ior"),
                                              size == kFullSize ? 1 << 19 : 1 << 16, out.stop());
  out.svg(c.svg, c.caption);
}

void plot_edge_loss(const GalleryPlot& plot, GallerySize size, Output& out) {
  const LaboratoryCurves c =
      edge_loss(numbers(plot, "ports_mm"), number(plot, "scattering_per_mm"), number(plot, "thickness_mm"),
                size == kFullSize ? 1 << 17 : 1 << 14, out.stop());
  out.svg(c.svg, c.caption);
}

void plot_goniometer_lobes(const GalleryPlot& plot, GallerySize size, Output& out) {
  const LaboratoryCurves c = measured_lobes(number(plot, "alpha"), numbers(plot, "incident"),
                                            size == kFullSize ? 4096 : 512, out.stop());
  out.svg(c.svg, c.caption);
}

std::filesystem::path file_of(const GalleryPlot& plot, const char* name) {
  return plot.folder / plot.parameters.at(name).get<std::string>();
}
LightEffort effort_of(const GalleryPlot& plot, GallerySize size) {
  const auto spp = std::int64_t(number(plot, "spp"));
  return size == kFullSize
             ? LightEffort{1, spp}
             : LightEffort{int(number(plot, "preview_divisor")), std::max<std::int64_t>(16, spp / 4)};
}
void plot_light_photometry(const GalleryPlot& plot, GallerySize size, Output& out) {
  out.picture(measured_picture(file_of(plot, "scene"), numbers(plot, "isolines"), number(plot, "threshold"),
                               effort_of(plot, size), out.stop()));
}
void plot_light_cameras(const GalleryPlot& plot, GallerySize size, Output& out) {
  std::vector<std::filesystem::path> cameras;
  for (const Json& name : plot.parameters.at("cameras"))
    cameras.push_back(plot.folder / name.get<std::string>());
  out.picture(exposed_pictures(file_of(plot, "scene"), cameras, numbers(plot, "exposures"),
                               effort_of(plot, size), out.stop()));
}
void plot_light_field(const GalleryPlot& plot, GallerySize size, Output& out) {
  out.picture(refocused_pictures(file_of(plot, "scene"), number(plot, "diameter"), numbers(plot, "focus"),
                                 effort_of(plot, size), out.stop()));
}
void plot_light_illumination(const GalleryPlot& plot, GallerySize size, Output& out) {
  out.picture(local_and_global(file_of(plot, "scene"), effort_of(plot, size), out.stop()));
}
void plot_light_definition(const GalleryPlot& plot, GallerySize size, Output& out) {
  const std::string which = plot.parameters.at("what").get<std::string>();
  const std::int64_t spp = size == kFullSize ? 4096 : 512;
  const LightCurves c = which == "tilt"      ? tilted_detector(spp, out.stop())
                        : which == "baffle"  ? baffled_detector(spp, out.stop())
                        : which == "lambert" ? lambertian_disc(spp, out.stop())
                                             : coverage_by_scale(size == kFullSize ? 200000 : 50000, 1);
  out.svg(c.svg, c.caption);
}

void plot_step_errors(const GalleryPlot& plot, GallerySize size, Output& out) {
  const int width = size == kFullSize ? 480 : 160;
  const VolumeCurves c =
      steps_against_error(file_of(plot, "scene"), numbers(plot, "steps"), width, width * 5 / 8, out.stop());
  if (!out.is_stopped()) out.svg(c.svg, c.caption);
}

/// A parameter of a plot in the gallery file: a number, a list of numbers, one of a set of words, or the name of a file beside
/// the gallery's or a list of such names.
struct Parameter {
  enum Type { number, list, word, file, files } type;
  const char* name;
  double low = 0, high = 0;
  std::vector<std::string> words = {};
  std::size_t most = 20;  ///< maximal length of a list

  bool is_good(const Json& v) const {
    const auto in_range = [this](const Json& x) {
      return x.is_number() && x.get<double>() >= low && x.get<double>() <= high;
    };
    if (type == number) return in_range(v);
    if (type == list)
      return v.is_array() && !v.empty() && v.size() <= most && std::all_of(v.begin(), v.end(), in_range);
    const auto is_name = [](const Json& x) { return x.is_string() && !x.get<std::string>().empty(); };
    if (type == file) return is_name(v);
    if (type == files)
      return v.is_array() && !v.empty() && v.size() <= most && std::all_of(v.begin(), v.end(), is_name);
    return v.is_string() && std::find(words.begin(), words.end(), v.get<std::string>()) != words.end();
  }
  std::string expected() const {
    if (type == word) return fmt::format("one of {}", fmt::join(words, ", "));
    if (type == file) return "the name of a file";
    if (type == files) return "a list of names of files";
    return fmt::format("{} from {:g} to {:g}",
                       type == list ? fmt::format("a list of 1 to {} numbers", most) : "a number", low, high);
  }
};

struct Kind {
  void (*make)(const GalleryPlot&, GallerySize, Output&);
  int columns;
  std::vector<Parameter> parameters;
};

const std::map<std::string, Kind>& kinds() {
  using P = Parameter;
  static const std::map<std::string, Kind> all{
      {"hard_discs",
       {plot_hard_discs,
        3,
        {{P::list, "area_fractions", 0.02, optics::HardDiscSimulation::kMaxAreaFraction}}}},
      {"lobes",
       {plot_lobes,
        2,
        {{P::list, "radii_um", 0.05, 100},
         {P::number, "area_fraction", 0.01, optics::kMaxAreaFraction},
         {P::number, "wavelength_nm", 100, 10000},
         {P::number, "index", 1.01, 10},
         {P::number, "degrees", 1, 85}}}},
      {"aperture_map",
       {plot_aperture_map,
        2,
        {{P::word, "shape", 0, 0, {"circle", "square"}},
         {P::number, "radius_um", 0.05, 100},
         {P::number, "wavelength_nm", 100, 10000},
         {P::number, "decades", 1, 12}}}},
      {"edge_waves",
       {plot_edge_waves,
        4,
        {{P::number, "a", -10, 10},
         {P::list, "b", -10, 10},
         {P::number, "extent", 1, 200},
         {P::number, "inset", 0, 200}}}},
      {"edge_amplitude",
       {plot_edge_amplitude,
        3,
        {{P::number, "a", -10, 10}, {P::number, "b", -10, 10}, {P::list, "ratios", 0.01, 20}}}},
      {"slits_and_solver",
       {plot_slits,
        1,
        {{P::number, "GHz", 0.1, 1000},
         {P::number, "width_m", 1e-4, 10},
         {P::number, "height_m", 1e-4, 10},
         {P::number, "apart_m", 1e-4, 10},
         {P::number, "step_degrees", 0.1, 10},
         {P::list, "solver", 1e-12, 1e6, {}, 1000}}}},
      {"edge_profile", {plot_edge_profile, 2, {{P::number, "sigmas", 0.5, 12}, {P::list, "pieces", 1, 64}}}},
      {"wedge",
       {plot_wedge,
        2,
        {{P::list, "n", 1.01, 2}, {P::number, "degrees", 1, 179}, {P::number, "wavelengths", 1, 100}}}},
      {"opening",
       {plot_opening,
        2,
        {{P::word, "shape", 0, 0, {"square", "ring", "slits"}},
         {P::number, "wavelengths", 7, 60},
         {P::list, "fresnel_numbers", 0.005, 4}}}},
      {"field_maps",
       {plot_field_maps,
        3,
        {{P::list, "blocks", -100, 100},
         {P::number, "degrees", -360, 360},
         {P::list, "map", -100, 100},
         {P::list, "range_db", -200, 50}}}},
      {"instruments", {plot_instruments, 1, {{P::number, "base", 0.01, 1}, {P::number, "ior", 1.01, 3}}}},
      {"edge_loss",
       {plot_edge_loss,
        1,
        {{P::list, "ports_mm", 1, 80},
         {P::number, "scattering_per_mm", 0.01, 100},
         {P::number, "thickness_mm", 0.01, 100}}}},
      {"goniometer_lobes",
       {plot_goniometer_lobes, 1, {{P::number, "alpha", 0.02, 1}, {P::list, "incident", 0, 80}}}},
      {"light_photometry",
       {plot_light_photometry,
        1,
        {{P::file, "scene"},
         {P::list, "isolines", 0, 1e9},
         {P::number, "threshold", 0, 1e9},
         {P::number, "preview_divisor", 1, 16},
         {P::number, "spp", 1, 65536}}}},
      {"light_cameras",
       {plot_light_cameras,
        1,
        {{P::file, "scene"},
         {P::files, "cameras"},
         {P::list, "exposures", 1e-9, 1e6},
         {P::number, "preview_divisor", 1, 16},
         {P::number, "spp", 1, 65536}}}},
      {"light_field",
       {plot_light_field,
        1,
        {{P::file, "scene"},
         {P::number, "diameter", 0, 1e6},
         {P::list, "focus", 1e-9, 1e9},
         {P::number, "preview_divisor", 1, 16},
         {P::number, "spp", 1, 65536}}}},
      {"light_illumination",
       {plot_light_illumination,
        1,
        {{P::file, "scene"}, {P::number, "preview_divisor", 1, 16}, {P::number, "spp", 1, 65536}}}},
      {"light_definition",
       {plot_light_definition, 1, {{P::word, "what", 0, 0, {"tilt", "baffle", "lambert", "scale"}}}}},
      {"step_errors", {plot_step_errors, 1, {{P::file, "scene"}, {P::list, "steps", 0.05, 64}}}},
      {"structure_map", {plot_structure_map, 1, {{P::number, "u", 1, 200}, {P::number, "highest", 1, 10}}}}};
  return all;
}

}  // namespace

void check_plot(const GalleryPlot& plot) {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  const auto kind = kinds().find(plot.kind);
  if (kind == kinds().end())
    throw Error(fmt::format("there is no kind of plot \"{}\"{}; kinds: {}", plot.kind,
                            did_you_mean(plot.kind, names), fmt::join(names, ", ")));
  std::vector<std::string> known{"kind", "caption"};
  for (const Parameter& p : kind->second.parameters) {
    known.push_back(p.name);
    if (!plot.parameters.contains(p.name) || !p.is_good(plot.parameters[p.name]))
      throw Error(fmt::format("a plot \"{}\" needs \"{}\", {}", plot.kind, p.name, p.expected()));
    if (p.type == Parameter::file && !std::filesystem::exists(file_of(plot, p.name)))
      throw Error(fmt::format("there is no file {}", file_of(plot, p.name).string()));
  }
  if (plot.kind == "field_maps") field_scene(plot);
  for (const auto& [name, value] : plot.parameters.items())
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(
          fmt::format("a plot \"{}\" has no member \"{}\"{}", plot.kind, name, did_you_mean(name, known)));
}

std::optional<PlotResult> make_plot(const GalleryPlot& plot, GallerySize size,
                                    const std::filesystem::path& folder, const std::atomic<bool>& stop) {
  const Kind& kind = kinds().at(plot.kind);
  PlotResult result{kind.columns, {}};
  Output out(plot, folder, result, stop);
  kind.make(plot, size, out);
  if (stop) return {};
  return result;
}

}  // namespace aureole
