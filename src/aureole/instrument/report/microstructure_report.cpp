// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/microstructure_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "aureole/instrument/report/svg_plot.h"
#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLargestSphereSpread = 0.7;  // largest spread that `correlated_spheres` accepts
constexpr double kMinSpread = 0.02;  // smallest relative deviation of radii that a picture can resolve

Json as_json(const Estimate& e, double unit = 1) {
  return {{"value", e.value / unit}, {"low", e.low / unit}, {"high", e.high / unit}};
}

Json as_json(const Microstructure::Curve& c, double confidence) {
  Json low = Json::array(), high = Json::array();
  for (size_t i = 0; i < c.x.size(); ++i) {
    low.push_back(std::max(c.value[i] - confidence * c.error[i], 0.0));
    high.push_back(c.value[i] + confidence * c.error[i]);
  }
  return {{"x", c.x}, {"value", c.value}, {"error", c.error}, {"low", low}, {"high", high}};
}

std::string curve_text(const Microstructure::Curve& c, const std::string& head) {
  std::string out = "# " + head + "\n";
  for (size_t i = 0; i < c.x.size(); ++i)
    out += fmt::format("{:.6g} {:.6g} {:.3g}\n", c.x[i], c.value[i], c.error[i]);
  return out;
}

std::string name_of(ScattererKind kind) {
  return kind == ScattererKind::spheres ? "spheres" : kind == ScattererKind::discs ? "discs" : "apertures";
}

Json result(const Microstructure& m) {
  Json j;
  j["confidence"] = 0.95;
  j["area_fraction"] = as_json(m.area_fraction);
  j["covered_fraction"] = as_json(m.shape_fraction);
  j["number_density_per_mm2"] = as_json(m.density, 1e6);
  j["correlation_radius_um"] = as_json(m.correlation_radius, 1e-6);
  j["correlation_radius_given"] = m.correlation_radius_given;
  j["onset_width"] = m.onset_width, j["onset_height"] = m.onset_height;
  Json r;
  r["mean_um"] = as_json(m.mean_radius, 1e-6), r["deviation_um"] = as_json(m.deviation, 1e-6);
  r["log_normal_sigma"] = as_json(m.log_deviation);
  for (size_t i = 0; i < m.quantiles.size(); ++i)
    r["quantiles_um"][fmt::format("{:.2f}", kQuantiles[i])] = as_json(m.quantiles[i], 1e-6);
  j["radius"] = r;
  j["shape"] = {{"round", m.round},         {"circularity", m.circularity},     {"aspect", m.aspect},
                {"alignment", m.alignment}, {"orientation_deg", m.orientation}, {"symmetry", m.symmetry}};
  Json fields = Json::array();
  for (const FieldReport& f : m.fields)
    fields.push_back({{"name", f.name},
                      {"width", f.width},
                      {"height", f.height},
                      {"pixel_um", f.pixel_m * 1e6},
                      {"seen_mm2", f.seen_m2 * 1e6},
                      {"whole", f.whole},
                      {"cut", f.cut},
                      {"too_small", f.too_small},
                      {"polarity", f.bright ? "bright" : "dark"},
                      {"polarity_score", f.polarity_score},
                      {"noise", f.noise},
                      {"blur_pixels", f.blur}});
  j["fields"] = fields;
  j["blocks"] = m.blocks;
  j["pair_correlation"] = as_json(m.pair_correlation, 1.96);
  j["structure_factor"] = as_json(m.structure_factor, 1.96);
  j["scatterer"] = name_of(m.scatterer);
  j["choices"] = m.choices;
  j["notes"] = m.notes;
  for (const std::string& note : measured_material(m).notes) j["notes"].push_back(note);
  j["rules"] = {
      {"sizes",
       "particles whose bounding square lies inside the window, weighted by 1/(area of places where it "
       "would)"},
      {"number_density", "the sum of those weights (Miles-Lantuejoul)"},
      {"covered_fraction", "grey-level area of all particles over the area seen"},
      {"positions", "centres at least the largest half bounding square away from what is not seen"},
      {"intervals", "bootstrap of square blocks of the fields, Student's t; curves: 1.96 standard errors"}};
  return j;
}

std::string particle_table(const Microstructure& m) {
  std::string out = "field,x_um,y_um,radius_um,area_um2,circularity,aspect,angle_deg,cut,touching,weight\n";
  for (size_t i = 0; i < m.particles.size(); ++i) {
    const Particle& p = m.particles[i];
    const double um = m.fields[size_t(p.field)].pixel_m * 1e6;
    out += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.5g},{:.4f},{:.4f},{:.1f},{:d},{:d},{:.5g}\n", p.field,
                       p.x * um, p.y * um, p.radius * um, p.area * um * um, p.circularity, p.aspect, p.angle,
                       p.cut, p.touching, m.weights[i]);
  }
  return out;
}

struct Bin {
  double size = 0, count = 0;
  double middle = 0;  ///< centre of the bin
};

/// Histogram of uncut particles by radius/mean radius.
std::vector<Bin> size_bins(const Microstructure& m, double* width = nullptr) {
  std::vector<Bin> all;
  double least = INFINITY, most = 0;
  size_t whole = 0;
  for (size_t i = 0; i < m.particles.size(); ++i) {
    if (!(m.weights[i] > 0)) continue;
    const Particle& p = m.particles[i];
    all.push_back({p.radius * m.fields[size_t(p.field)].pixel_m / m.mean_radius.value, m.weights[i], 0});
    least = std::min(least, all.back().size), most = std::max(most, all.back().size), ++whole;
  }
  const int bins = std::clamp(int(std::sqrt(double(whole))), 4, 24);
  const double step = std::max((most - least) / bins, 1e-6);
  std::vector<Bin> out(size_t(bins), Bin{});
  for (int i = 0; i < bins; ++i) out[size_t(i)].middle = least + (i + 0.5) * step;
  for (const Bin& b : all) {
    Bin& to = out[size_t(std::clamp(int((b.size - least) / step), 0, bins - 1))];
    to.size += b.size * b.count, to.count += b.count;
  }
  std::erase_if(out, [](const Bin& b) { return !(b.count > 0); });
  for (Bin& b : out) b.size /= b.count, b.count *= double(whole);
  if (width) *width = step;
  return out;
}

Plot plot_of(const Microstructure::Curve& c, PlotSeries::Kind kind) {
  PlotSeries s{kind, c.x, c.value, {}, {}, 0};
  for (size_t i = 0; i < c.x.size(); ++i) {
    s.low.push_back(std::max(c.value[i] - 1.96 * c.error[i], 0.0));
    s.high.push_back(c.value[i] + 1.96 * c.error[i]);
  }
  Plot p;
  p.series = {s};
  return p;
}

/// Returns an area fraction within the range of the models of positions, with a note if that changed it.
double limited_fraction(double fraction, std::vector<std::string>& notes) {
  if (fraction <= optics::kMaxAreaFraction) return fraction;
  notes.push_back(
      fmt::format("the area fraction {:.4g} is above what the model of positions covers and is cut to {}",
                  fraction, optics::kMaxAreaFraction));
  return optics::kMaxAreaFraction;
}

/// A `correlated_spheres` element: spheres of the particles' projected areas.
std::string sphere_element(const Microstructure& m, std::vector<std::string>& notes) {
  const double um = 1e6, a = m.correlation_radius.value;
  const bool spread = m.deviation.value > kMinSpread * m.mean_radius.value;
  const double radius = spread ? m.median_radius() : m.mean_radius.value;
  if (!m.round) notes.push_back("particles are not round: spheres of their projected areas are written");
  if (std::abs(a / m.mean_radius.value - 1) > 0.05)
    notes.push_back(fmt::format(
        "positions of spheres are those of hard discs of their radius, {:.4g} um; the measured correlation "
        "radius, {:.4g} um, is not used",
        m.mean_radius.value * um, a * um));
  double sigma = m.log_deviation.value;
  if (sigma > kLargestSphereSpread) {
    notes.push_back(
        fmt::format("the log-normal sigma {:.3g} is above what the model of spheres covers and is cut to {}",
                    sigma, kLargestSphereSpread));
    sigma = kLargestSphereSpread;
  }
  std::string out = fmt::format(
      "<bsdf type=\"correlated_spheres\" id=\"measured\">\n    <string name=\"radius\" value=\"{:.7g}um\"/>\n"
      "    <float name=\"area_fraction\" value=\"{:.4g}\"/>\n",
      radius * um, limited_fraction(m.shape_fraction.value, notes));
  if (spread) out += fmt::format("    <float name=\"size_spread\" value=\"{:.4g}\"/>\n", sigma);
  const bool number = m.int_ior.find_first_not_of("0123456789.eE+- ") == std::string::npos;
  return out + fmt::format("    <{} name=\"int_ior\" value=\"{}\"/>\n</bsdf>\n", number ? "float" : "string",
                           m.int_ior);
}

/// A `correlated_scatterers` element: openings or opaque discs.
std::string scatterer_element(const Microstructure& m, std::vector<std::string>& notes) {
  const double r = m.mean_radius.value, a = m.correlation_radius.value, um = 1e6;
  const bool spread = m.deviation.value > kMinSpread * r;
  double largest = 1;
  if (spread)
    for (const Bin& b : size_bins(m)) largest = std::max(largest, b.size);
  // Scatterers must fit into discs of the correlation radius. Radii that are equal within rounding are made
  // equal.
  double fraction = m.area_fraction.value, radius = r;
  if (!spread && r > a && r < 1.03 * a) radius = a;
  double reach = radius;  // reach of a shape of mean size
  if (!m.round) {
    reach = 0;
    for (const auto& p : m.mean_outline) reach = std::max(reach, std::hypot(p[0], p[1]));
  }
  const bool fits = reach * largest <= a;
  if (!fits && spread) {
    // Small particles are closer together than large ones: each gets a disc proportional to its own size.
    fraction = m.shape_fraction.value * (reach / r) * (reach / r);
    notes.push_back(
        "sizes differ by more than the correlation radius leaves room for: they are packed together");
  } else if (!fits) {
    fraction = m.density.value * M_PI * reach * reach;
    notes.push_back(fmt::format(
        "the largest shape needs more than the measured correlation radius, {:.4g} um (area fraction "
        "{:.4g}): its own is used",
        a * um, m.area_fraction.value));
  }
  fraction = limited_fraction(fraction, notes);
  std::string out = fmt::format(
      "<bsdf type=\"correlated_scatterers\" id=\"measured\">\n    <string name=\"scatterer\" value=\"{}\"/>\n",
      name_of(m.scatterer));
  if (m.round && !spread)
    out += fmt::format("    <string name=\"radius\" value=\"{:.7g}um\"/>\n", radius * um);
  if (fits) out += fmt::format("    <string name=\"correlation_radius\" value=\"{:.7g}um\"/>\n", a * um);
  if (!fits && spread) out += "    <string name=\"sizes\" value=\"polydisperse\"/>\n";
  out += fmt::format("    <float name=\"area_fraction\" value=\"{:.4g}\"/>\n", fraction);
  if (m.round && spread) {
    out +=
        fmt::format("    <aperture type=\"circle\">\n        <string name=\"radius\" value=\"{:.7g}um\"/>\n",
                    radius * um);
    out += "        <string name=\"size_histogram\" value=\"sizes.txt\"/>\n    </aperture>\n";
  } else if (!m.round) {
    double left = INFINITY, right = -INFINITY;
    for (const auto& p : m.mean_outline) left = std::min(left, p[0]), right = std::max(right, p[0]);
    out += "    <aperture type=\"polygon\">\n        <string name=\"filename\" value=\"apertures.svg\"/>\n";
    out += fmt::format("        <string name=\"width\" value=\"{:.5g}um\"/>\n", (right - left) * um);
    if (m.alignment < 0.5)
      out += "        <boolean name=\"random_rotation\" value=\"true\"/>\n";
    else
      out += fmt::format("        <float name=\"rotation\" value=\"{:.1f}\"/>\n", m.orientation);
    if (spread) out += "        <string name=\"size_histogram\" value=\"sizes.txt\"/>\n";
    out += "    </aperture>\n";
  }
  return out + "</bsdf>\n";
}

}  // namespace

std::string size_histogram(const Microstructure& m) {
  std::string out =
      fmt::format("# size relative to the mean radius {:.6g}um, count\n", m.mean_radius.value * 1e6);
  for (const Bin& b : size_bins(m)) out += fmt::format("{:.6f} {:.4g}\n", b.size, b.count);
  return out;
}

MeasuredMaterial measured_material(const Microstructure& m) {
  MeasuredMaterial made;
  const std::string element = m.scatterer == ScattererKind::spheres ? sphere_element(m, made.notes)
                                                                    : scatterer_element(m, made.notes);
  std::string comment = fmt::format(
      "Measured from {} particles in {} field(s): covered part {:.4g} [{:.4g}, {:.4g}], area fraction "
      "{:.4g} [{:.4g}, {:.4g}].",
      m.particles.size(), m.fields.size(), m.shape_fraction.value, m.shape_fraction.low,
      m.shape_fraction.high, m.area_fraction.value, m.area_fraction.low, m.area_fraction.high);
  for (const auto* notes : {&m.choices, &m.notes, &std::as_const(made.notes)})
    for (const std::string& note : *notes) comment += "\n     Note: " + note + ".";
  // An XML comment must not contain two hyphens in a row.
  for (size_t at; (at = comment.find("--")) != std::string::npos;) comment.erase(at, 2);
  made.scene = "<!-- " + comment + " -->\n<scene version=\"3.0.0\">\n" + element + "</scene>\n";
  return made;
}

void write_microstructure(const Microstructure& m, const OutputFolder& folder) {
  folder.write("result.json", result(m).dump(2) + "\n");
  folder.write("particles.csv", particle_table(m));
  folder.write("sizes.txt", size_histogram(m));
  folder.write("structure_factor.txt",
               curve_text(m.structure_factor, "u = q correlation_radius, S, standard error"));
  folder.write("pair_correlation.txt",
               curve_text(m.pair_correlation, "r/correlation_radius, g, standard error"));
  folder.write("scene.xml", measured_material(m).scene);
  double width = 0;
  PlotSeries bars{PlotSeries::Kind::bars, {}, {}, {}, {}, 0};
  for (const Bin& b : size_bins(m, &width))
    bars.x.push_back(b.middle * m.mean_radius.value * 1e6), bars.y.push_back(b.count);
  bars.bar_width = width * m.mean_radius.value * 1e6;
  folder.write("radii.svg", svg_plot({"Radii of the particles", "radius, um", "number (weighted)", {bars}}));
  Plot g = plot_of(m.pair_correlation, PlotSeries::Kind::line),
       s = plot_of(m.structure_factor, PlotSeries::Kind::points);
  g.title = "Pair correlation", g.x_label = "r / correlation radius", g.y_label = "g(r)";
  s.title = "Structure factor", s.x_label = "u = q correlation radius", s.y_label = "S(q)";
  folder.write("pair_correlation.svg", svg_plot(g));
  folder.write("structure_factor.svg", svg_plot(s));
  if (m.round) return;
  if (!m.mean_outline.empty())
    folder.write("apertures.svg", svg_outline(m.mean_outline, "mean outline of the particles"));
  if (!m.typical_outline.empty())
    folder.write("outline.svg", svg_outline(m.typical_outline, "outline of a typical particle"));
}

}  // namespace aureole
