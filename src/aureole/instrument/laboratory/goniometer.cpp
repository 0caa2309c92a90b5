// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/goniometer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "aureole/bsdf/measured/scattered_table.h"
#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/keyed_random.h"
#include "aureole/instrument/laboratory/goniometer_scene.h"
#include "aureole/math/vec.h"
#include "aureole/pigment/text_table.h"

namespace aureole {
namespace {

constexpr double kHighest = 89;  ///< angles of lamp and detectors [degrees]

double normal_deviate(KeyedRandom& random) {
  const double u = 1 - double(random.next()), v = double(random.next());
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPiD * v);
}

void check_sizes(const GoniometerSettings& s) {
  const auto require = [](const char* what, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw Error(fmt::format("{} of {:g}: {:g} to {:g} is expected", what, value, low, high));
  };
  require("a lamp's half-angle in degrees", s.lamp_angle, 0.001, 20);
  require("a detector's half-angle in degrees", s.detector_angle, 0.001, 20);
  require("a distance in mm", s.distance_m * 1e3, 1, 1e6);
  require("a viewed diameter in mm", s.viewed_m * 1e3, 1e-6, 1e4);
  require("a lit diameter in mm", s.lit_m * 1e3, 1e-6, 1e4);
  require("a standard's reflectance", s.standard, 1e-3, 1);
  require("noise", s.noise, 0, 1);
  require("dark noise in 1/sr", s.dark_noise, 0, 1e6);
  require("an error of angles in degrees", s.angle_error, 0, 10);
  if (s.sample_m < std::max(s.viewed_m, s.lit_m))
    throw Error(fmt::format("the sample of {:g} mm is smaller than the spot of {:g} mm on it",
                            s.sample_m * 1e3, std::max(s.viewed_m, s.lit_m) * 1e3));
}

/// A reading of the detectors as f: radiance over irradiance, or by comparison with the standard.
class Calibration {
public:
  Calibration(const Bench& bench, const GoniometerSettings& s, double theta,
              const std::vector<std::array<double, 2>>& directions)
      : s_(s) {
    GonioScenes scene(bench, s);
    scene.add_lamp(theta, s.lamp_angle);
    if (s.by_reference) {
      scene.add_specimen(lambertian_standard(s.standard));
      // A standard reflects only. Detectors below the sample are compared with their mirror images above.
      std::vector<std::array<double, 2>> above = directions;
      for (auto& d : above) d[0] = std::min(d[0], 180 - d[0]);
      scene.add_detectors(above);
    } else {
      scene.add_diffuser();
    }
    readings_ = scene.read();
  }
  Ratio f(const Readings& sample, std::size_t detector, std::size_t band) const {
    Ratio q = ratio_of(sample, detector, *readings_, s_.by_reference ? detector : 0, band);
    const double scale = (s_.by_reference ? s_.standard : 1) / kPiD;
    q.value *= scale, q.error *= scale;
    return q;
  }

private:
  const GoniometerSettings& s_;
  std::optional<Readings> readings_;
};

/// Directions where readings vary most: candidates of a finer lattice, scored by the spread of the logarithm of the nearest
/// readings, which the distance to the nearest one limits.
std::vector<std::array<double, 2>> steepest_directions(const std::vector<std::array<double, 2>>& known,
                                                       const std::vector<double>& values, int count) {
  const std::vector<std::array<double, 2>> candidates =
      outgoing_directions(GonioPlan::Kind::hemispherical, 6 * (int(known.size()) + count));
  const auto distance = [](const std::array<double, 2>& a, const std::array<double, 2>& b) {
    const auto u = gonio_direction(a[0], a[1]), v = gonio_direction(b[0], b[1]);
    return std::acos(std::clamp(u[0] * v[0] + u[1] * v[1] + u[2] * v[2], -1.0, 1.0));
  };
  const double largest = *std::max_element(values.begin(), values.end());
  const auto level = [&](double v) { return std::log(std::max(v, 1e-4 * largest) + 1e-30); };
  std::vector<std::pair<double, std::array<double, 2>>> scored;
  for (const auto& c : candidates) {
    std::vector<std::pair<double, double>> near;
    for (std::size_t k = 0; k < known.size(); ++k) near.emplace_back(distance(c, known[k]), level(values[k]));
    const std::size_t n = std::min<std::size_t>(5, near.size());
    std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(n), near.end());
    double low = near[0].second, high = low;
    for (std::size_t k = 1; k < n; ++k)
      low = std::min(low, near[k].second), high = std::max(high, near[k].second);
    scored.emplace_back((high - low + 0.02) * near[0].first, c);
  }
  std::vector<std::array<double, 2>> chosen;
  while (int(chosen.size()) < count && !scored.empty()) {
    const auto best = std::max_element(scored.begin(), scored.end());
    const auto c = best->second;
    if (!(best->first > 1e-4)) break;
    chosen.push_back(c);
    // A new direction is near to its neighbours from now on.
    for (auto& [score, other] : scored) score *= std::min(1.0, distance(c, other) / 0.1 + 1e-9);
  }
  return chosen;
}

Ratio mean_of(const Readings& over, const Readings& under, double scale) {
  Readings a(over.replicates(), 1, 1), b(under.replicates(), 1, 1);
  for (std::size_t r = 0; r < over.replicates(); ++r)
    for (std::size_t k = 0; k < over.bands(); ++k)
      a.at(r, 0, 0) += over.at(r, 0, k), b.at(r, 0, 0) += under.at(r, 0, k);
  Ratio q = ratio_of(a, 0, b, 0, 0);
  q.value *= scale, q.error *= scale;
  return q;
}

/// A map over the sphere of a radiance that is stated by the angle from the normal, or the picture of a file.
Image light_map(const std::string& text) {
  if (text.find_first_not_of("0123456789.:,+-eE ") != text.npos) {
    Image map = read_image(text);
    if (map.srgb_encoded)
      throw Error({text, 0, 0},
                  "radiances are expected, as in files of EXR, HDR or PFM, not values encoded for a screen");
    return map;
  }
  std::vector<std::pair<double, double>> points;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    std::string_view one = rest.substr(0, end);
    while (one.starts_with(' ')) one.remove_prefix(1);
    const std::size_t colon = one.find(':');
    const auto angle = pigment::finite_number(std::string(one.substr(0, colon))),
               radiance = colon == one.npos ? std::nullopt
                                            : pigment::finite_number(std::string(one.substr(colon + 1)));
    if (!angle || !radiance || !(*angle >= 0 && *angle <= 90) || !(*radiance >= 0 && *radiance <= 1e6) ||
        (!points.empty() && !(*angle > points.back().first)))
      throw Error(fmt::format(
          "--incident-light \"{}\": increasing angles from 0 to 90 degrees and radiances are expected, as in 0:1,60:0.5,90:0.1",
          text));
    points.emplace_back(*angle, *radiance);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  constexpr int kRows = 1024;
  Image map;
  map.width = 4, map.height = kRows, map.channels = {"Y"}, map.pixels.resize(4 * kRows);
  for (int y = 0; y < kRows; ++y) {
    // The first and the last row are the poles.
    const double angle = 180.0 * y / (kRows - 1);
    double value = 0;
    if (angle <= 90) {
      const auto after = std::upper_bound(points.begin(), points.end(), std::pair(angle, double(INFINITY)));
      if (after == points.begin())
        value = points.front().second;
      else if (after == points.end())
        value = points.back().second;
      else
        value = std::lerp(after[-1].second, after->second,
                          (angle - after[-1].first) / (after->first - after[-1].first));
    }
    for (int x = 0; x < 4; ++x) map.at(x, y, 0) = float(value);
  }
  return map;
}

/// f of one pair of directions, the mean over the bands.
Ratio f_of_pair(const Bench& bench, const Specimen& specimen, const GoniometerSettings& s, double theta_i,
                double theta_o, double azimuth, double turn) {
  GonioScenes scene(bench, s), empty(bench, s);
  scene.add_specimen(specimen, turn), scene.add_lamp(theta_i, s.lamp_angle);
  scene.add_detectors({{theta_o, azimuth}});
  empty.add_lamp(theta_i, s.lamp_angle), empty.add_diffuser();
  return mean_of(scene.read(), empty.read(), 1 / kPiD);
}

}  // namespace

std::vector<std::array<double, 2>> outgoing_directions(GonioPlan::Kind kind, int count) {
  std::vector<std::array<double, 2>> all;
  constexpr double kEdge = 85;
  if (kind == GonioPlan::Kind::in_plane) {
    for (int i = 0; i < count; ++i) {
      const double angle = count > 1 ? -kEdge + 2 * kEdge * i / (count - 1) : 0;
      all.push_back({std::abs(angle), angle < 0 ? 180.0 : 0.0});
    }
    return all;
  }
  // Rings of equal width; the number of azimuths follows from the circumference. The scale is found by bisection.
  const auto rings = [&](int n) {
    std::vector<int> counts{1};
    for (int k = 1; k <= n; ++k)
      counts.push_back(std::max(
          3, int(std::lround(2 * kPiD * std::sin(kEdge * kDegree * k / n) / (kEdge * kDegree / n)))));
    return counts;
  };
  int n = 1;
  const auto total = [&](int k) {
    const std::vector<int> c = rings(k);
    return std::accumulate(c.begin(), c.end(), 0);
  };
  while (n < 400 && total(n + 1) <= std::max(count, 8)) ++n;
  const std::vector<int> counts = rings(n);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j < counts[std::size_t(k)]; ++j)
      // 180 degrees, where mirrors reflect, is among the azimuths.
      all.push_back({kEdge * k / n, k == 0 ? 0 : std::fmod(180 + 360.0 * j / counts[std::size_t(k)], 360.0)});
  return all;
}

GonioTable measure_scattering(const Bench& bench, const Specimen& specimen, const GoniometerSettings& s,
                              const GonioPlan& plan) {
  check_sizes(s);
  if (plan.directions < 1 || plan.directions > 100000)
    throw Error(fmt::format("{} directions: 1 to 100000 are expected", plan.directions));
  for (const double angle : plan.incident)
    if (!(angle >= 0 && angle <= kHighest))
      throw Error(
          fmt::format("an angle of incidence of {:g} degrees: 0 to {:g} are expected", angle, kHighest));
  for (const double angle : plan.azimuths)
    if (!(angle >= 0 && angle < 360))
      throw Error(fmt::format("an azimuth of {:g} degrees: 0 to below 360 are expected", angle));
  if (plan.incident.empty() || plan.azimuths.empty()) throw Error("there is no direction of incidence");
  GonioTable table;
  table.nm = bench.bands().nm, table.notes = bench.notes();
  KeyedRandom random(std::uint32_t(mix_bits(bench.settings().seed + 0x51ed) >> 16));
  const bool is_adaptive = plan.kind == GonioPlan::Kind::adaptive;
  const std::size_t bands = table.nm.size();
  // The standard deviation of f where the angles of lamp and detector have a normal distribution: f at the angles, and one standard
  // deviation before and after, give its first and second derivatives; the variance of a parabola is slope^2 + curvature^2/2.
  const auto angle_errors = [&](double theta, double phi, const std::vector<std::array<double, 2>>& nominal,
                                int side) {
    const auto f_at = [&](double of_lamp, double of_detector) {
      const auto moved = [](double angle, double by) {
        return std::clamp(std::abs(angle + by), 0.0, kHighest);
      };
      std::vector<std::array<double, 2>> at = nominal;
      for (auto& d : at) d[0] = side == 0 ? moved(d[0], of_detector) : 180 - moved(d[0], of_detector);
      GonioScenes scene(bench, s);
      scene.add_specimen(specimen, phi), scene.add_lamp(moved(theta, of_lamp), s.lamp_angle);
      scene.add_detectors(at);
      const Readings read = scene.read();
      const Calibration calibration(bench, s, moved(theta, of_lamp), at);
      std::vector<double> f;
      for (std::size_t d = 0; d < at.size(); ++d)
        for (std::size_t b = 0; b < bands; ++b) f.push_back(calibration.f(read, d, b).value);
      return f;
    };
    const std::vector<double> middle = f_at(0, 0);
    std::vector<double> variance(middle.size());
    for (const bool is_lamp : {true, false}) {
      const std::vector<double> after = f_at(is_lamp ? s.angle_error : 0, is_lamp ? 0 : s.angle_error),
                                before = f_at(is_lamp ? -s.angle_error : 0, is_lamp ? 0 : -s.angle_error);
      for (std::size_t k = 0; k < variance.size(); ++k) {
        const double slope = 0.5 * (after[k] - before[k]), curvature = after[k] + before[k] - 2 * middle[k];
        variance[k] += slope * slope + 0.5 * curvature * curvature;
      }
    }
    for (double& v : variance) v = std::sqrt(v);
    return variance;
  };
  for (const double phi : plan.azimuths)
    for (const double theta : plan.incident)
      for (int side = 0; side < (plan.transmits ? 2 : 1); ++side) {
        std::vector<std::array<double, 2>> known;
        std::vector<double> means;
        const auto measure = [&](const std::vector<std::array<double, 2>>& nominal) {
          if (nominal.empty()) return;
          // Where lamp and detectors really stand.
          const auto shifted = [&](double angle) {
            if (s.angle_error == 0) return angle;
            return std::clamp(std::abs(angle + s.angle_error * normal_deviate(random)), 0.0, kHighest);
          };
          const double lamp = shifted(theta);
          std::vector<std::array<double, 2>> real = nominal;
          for (auto& d : real) d[0] = side == 0 ? shifted(d[0]) : 180 - shifted(d[0]);
          GonioScenes scene(bench, s);
          scene.add_specimen(specimen, phi);
          scene.add_lamp(lamp, s.lamp_angle);
          scene.add_detectors(real);
          const Readings read = scene.read();
          const Calibration calibration(bench, s, lamp, real);
          const std::vector<double> of_angles = s.angle_error > 0
                                                    ? angle_errors(theta, phi, nominal, side)
                                                    : std::vector<double>(nominal.size() * bands);
          for (std::size_t d = 0; d < nominal.size(); ++d) {
            GonioReading reading{theta,
                                 phi,
                                 side == 0 ? nominal[d][0] : 180 - nominal[d][0],
                                 std::fmod(nominal[d][1] + phi, 360.0),
                                 std::vector<double>(bands),
                                 std::vector<double>(bands)};
            double mean = 0;
            for (std::size_t b = 0; b < bands; ++b) {
              const Ratio f = calibration.f(read, d, b);
              if (!std::isfinite(f.value))
                throw Error(fmt::format("no light of the lamp at {:g} degrees is received at {:g} nm", theta,
                                        table.nm[b]));
              const double detector = std::hypot(s.noise * f.value, s.dark_noise);
              reading.f[b] = f.value + (detector > 0 ? detector * normal_deviate(random) : 0);
              reading.error[b] = std::hypot(f.error, detector, of_angles[d * bands + b]);
              mean += f.value / double(bands);
            }
            known.push_back(nominal[d]), means.push_back(mean);
            table.readings.push_back(std::move(reading));
          }
        };
        if (!is_adaptive) {
          measure(outgoing_directions(plan.kind, plan.directions));
          continue;
        }
        measure(outgoing_directions(GonioPlan::Kind::hemispherical, std::max(8, plan.directions / 2)));
        for (int round = 0; round < 2; ++round) {
          const int left = plan.directions - int(known.size());
          if (left > 0) measure(steepest_directions(known, means, round == 0 ? (left + 1) / 2 : left));
        }
      }
  return table;
}

std::string gonio_table_content(const GonioTable& table) {
  std::string text =
      "# f in 1/sr, without a cosine; angles in degrees from the normal; above 90: below the surface; u(...): standard "
      "uncertainty\n";
  text += fmt::format("theta_i,phi_i,theta_o,phi_o,{}nm,u({}nm)\n", fmt::join(table.nm, "nm,"),
                      fmt::join(table.nm, "nm),u("));
  for (const GonioReading& r : table.readings) {
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}", r.theta_i, r.phi_i, r.theta_o, r.phi_o);
    for (const double v : r.f) text += fmt::format(",{:.6g}", v);
    for (const double v : r.error) text += fmt::format(",{:.3g}", v);
    text += '\n';
  }
  return text;
}

GonioTable read_gonio_table(const std::string& file) {
  const ScatteredMeasurements m = read_scattered_measurements(file, false);
  GonioTable table;
  table.nm = m.nm;
  for (std::size_t k = 0; k < m.directions.size(); ++k) {
    const auto& d = m.directions[k];
    GonioReading r{d.theta_i, d.phi_i, d.theta_o, d.phi_o, {}, std::vector<double>(m.channels)};
    for (std::size_t c = 0; c < m.channels; ++c) {
      r.f.push_back(double(m.values[k * m.channels + c]));
      if (!m.errors.empty()) r.error[c] = double(m.errors[k * m.channels + c]);
    }
    table.readings.push_back(std::move(r));
  }
  if (m.errors.empty())
    table.notes.push_back(file +
                          ": states no uncertainties; those of the fit are taken relative to each reading");
  // A single column holds for all wavelengths; three are red, green and blue.
  if (m.nm.empty())
    table.nm = m.channels == 3 ? std::vector<double>{450, 550, 650} : std::vector<double>(m.channels, 550);
  return table;
}

ReflectanceReport report_reflectances(const Bench& bench, const Specimen& specimen,
                                      const GoniometerSettings& s, const ReportSettings& asked) {
  check_sizes(s);
  for (const auto& c : asked.cones)
    if (!(c[0] >= 0 && c[1] > 0 && c[0] + c[1] <= kHighest && c[2] >= 0 && c[3] > 0 &&
          c[2] + c[3] <= kHighest))
      throw Error(fmt::format(
          "--cones {:g},{:g},{:g},{:g}: cones above the sample are expected, each an angle and a half-angle "
          "whose sum is at most {:g} degrees",
          c[0], c[1], c[2], c[3], kHighest));
  ReflectanceReport report;
  // Even light, of which a cosine receiver gets pi times the radiance.
  GonioScenes light(bench, s);
  light.add_even_light(), light.add_receiver(true);
  const Readings even_light = light.read();
  // A wide lamp, which rays find that smooth surfaces reflect.
  const double lamp_angle = std::max(s.lamp_angle, 2.0);
  for (const double angle : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0}) {
    GonioScenes lit(bench, s), empty(bench, s), even(bench, s);
    lit.add_specimen(specimen), lit.add_lamp(angle, lamp_angle), lit.add_receiver(false);
    empty.add_lamp(angle, lamp_angle), empty.add_diffuser();
    even.add_specimen(specimen), even.add_even_light(), even.add_detectors({{angle, 0}});
    report.angles.push_back(
        {angle, mean_of(lit.read(), empty.read(), 1 / kPiD), mean_of(even.read(), even_light, kPiD)});
  }
  GonioScenes even(bench, s);
  even.add_specimen(specimen), even.add_even_light(), even.add_receiver(false);
  report.hh = mean_of(even.read(), even_light, 1);
  if (!asked.light.empty()) {
    const Image map = light_map(asked.light);
    GonioScenes arriving(bench, s), scattered(bench, s);
    arriving.add_light(map), arriving.add_receiver(true);
    scattered.add_specimen(specimen), scattered.add_light(map), scattered.add_receiver(false);
    const Readings all = arriving.read();
    if (!(all.mean(0, 0) > 0)) throw Error("--incident-light: no light arrives from above the sample");
    report.of_light = mean_of(scattered.read(), all, 1);
  }
  for (const auto& c : asked.cones) {
    GoniometerSettings narrow = s;
    narrow.detector_angle = c[3];
    GonioScenes lit(bench, narrow), empty(bench, narrow);
    lit.add_specimen(specimen), lit.add_lamp(c[0], c[1]), lit.add_detectors({{c[2], 180}});
    empty.add_lamp(c[0], c[1]), empty.add_diffuser();
    // The projected solid angle of a cone above the horizon is pi sin^2(half) cos(axis).
    const double part = std::pow(std::sin(c[3] * kDegree), 2) * std::cos(c[2] * kDegree);
    const Ratio factor = mean_of(lit.read(), empty.read(), 1);
    report.cones.push_back(
        {c[0], c[1], c[2], c[3], {factor.value * part, factor.error * part}, factor.value});
  }
  for (const auto& [i, o] : {std::pair(0.0, 45.0), {15.0, 45.0}, {15.0, 60.0}, {30.0, 60.0}, {45.0, 75.0}})
    report.pairs.push_back(
        {i, o, f_of_pair(bench, specimen, s, i, o, 180, 0), f_of_pair(bench, specimen, s, o, i, 180, 0)});
  double low = INFINITY, high = 0, sum = 0, error = 0;
  for (const double turn : {0.0, 20.0, 45.0, 70.0, 90.0, 135.0}) {
    const Ratio f = f_of_pair(bench, specimen, s, 45, 30, 90, turn);
    report.turns.push_back({turn, f.value, f.error});
    low = std::min(low, f.value), high = std::max(high, f.value), sum += f.value,
    error = std::max(error, f.error);
  }
  const double mean = sum / double(report.turns.size());
  report.anisotropy = mean > 0 ? (high - low) / mean : 0;
  report.is_isotropic = high - low <= 6 * error + 1e-3 * mean;
  return report;
}

std::string report_text(const ReflectanceReport& r) {
  std::string text = "angle    rho_dh               rho_hd\n";
  for (const auto& a : r.angles)
    text += fmt::format("{:>5.0f}    {:.5f} +- {:.5f}    {:.5f} +- {:.5f}\n", a.angle, a.dh.value, a.dh.error,
                        a.hd.value, a.hd.error);
  text += fmt::format("rho_hh   {:.5f} +- {:.5f}\n", r.hh.value, r.hh.error);
  if (r.of_light)
    text += fmt::format("of the stated light {:.5f} +- {:.5f} is scattered\n", r.of_light->value,
                        r.of_light->error);
  for (const auto& c : r.cones)
    text += fmt::format(
        "cone of {:g} degrees at {:g}, viewed in one of {:g} at {:g}: reflectance {:.6g} +- {:.2g}, reflectance factor {:.5f}\n",
        c.half_i, c.theta_i, c.half_o, c.theta_o, c.reflectance.value, c.reflectance.error, c.factor);
  bool gains = r.hh.value > 1 + 4.5 * r.hh.error;
  for (const auto& a : r.angles)
    gains |= a.dh.value > 1 + 4.5 * a.dh.error + 1e-6 || a.hd.value > 1 + 4.5 * a.hd.error + 1e-6;
  text += gains ? "energy: more light is scattered than arrives\n"
                : "energy: no more light is scattered than arrives\n";
  text += "reciprocity     f(i, o), 1/sr            f(o, i), 1/sr\n";
  for (const auto& p : r.pairs) {
    const double apart = std::abs(p.forward.value - p.backward.value),
                 error = std::hypot(p.forward.error, p.backward.error);
    text += fmt::format("{:>3.0f} {:>3.0f} degrees  {:.6g} +- {:.2g}    {:.6g} +- {:.2g}{}\n", p.i, p.o,
                        p.forward.value, p.forward.error, p.backward.value, p.backward.error,
                        apart > 4.5 * error + 2e-3 * p.forward.value ? "  they differ" : "");
  }
  text += fmt::format("isotropy: turning the sample changes f by {:.2f} %: {}\n", 100 * r.anisotropy,
                      r.is_isotropic ? "isotropic within the errors" : "anisotropic");
  return text;
}

}  // namespace aureole
