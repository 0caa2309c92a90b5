// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_edge_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "aureole/instrument/report/svg_plot.h"
#include "aureole/optics/diffraction/diffraction_integral.h"
#include "aureole/optics/diffraction/edge_power.h"
#include "aureole/optics/diffraction/edge_wave.h"
#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/optics/faddeeva.h"

namespace aureole {
namespace {

using Complex = std::complex<double>;
using optics::DiffractingEdge;
using optics::PlanePoint;
using std::numbers::pi;

constexpr const char* kColors[] = {"#2b5d8f", "#b0413e", "#3d8b40", "#8a6d1f"};

/// Integrates over [begin, end] by the midpoint rule.
Complex integrate(double begin, double end, int steps, const std::function<Complex(double)>& f) {
  Complex sum = 0;
  const double h = (end - begin) / steps;
  for (int i = 0; i < steps; ++i) sum += f(begin + (i + 0.5) * h);
  return sum * h;
}

PlotSeries line(const std::string& label, int color) {
  PlotSeries s;
  s.label = label, s.color = kColors[color];
  return s;
}

}  // namespace

namespace {

/// Power |u|^2 of the field diffracted by an edge of length 1, at canonical coordinates x along and y
/// perpendicular to the edge.
using WavePower = std::function<double(double, double)>;

/// Returns the integral of the power over the plane without the lobe chi: by rings, and with a 1/r^2 tail
/// beyond the last one.
double power_without_lobe(const WavePower& wave, double sigma) {
  const double first = 1e-3, last = 400;
  const int rings = 400;
  const double step = std::log(last / first) / rings;
  double sum = 0, per_radius = 0;
  for (int i = 0; i < rings; ++i) {
    const double r = first * std::exp((i + 0.5) * step), left = -std::expm1(-r * r / (2 * sigma * sigma));
    // Number of steps over a quarter of each ring, since fields are even in both coordinates.
    const int steps = 40 + int(4 * r);
    double mean = 0;
    for (int j = 0; j < steps; ++j) {
      const double phi = 0.5 * pi * (j + 0.5) / steps;
      mean += wave(r * std::cos(phi), r * std::sin(phi)) / steps;
    }
    per_radius = 2 * pi * r * left * mean;
    sum += per_radius * r * step;
  }
  return sum + per_radius * last;
}

}  // namespace

EdgeMap edge_wave_map(double a, double b, double extent, double inset) {
  const auto size = [a, b](double x, double y) {
    return std::abs(Complex((a - b) * optics::edge_alpha1(x, y), 0.5 * (a + b) * optics::edge_alpha2(x, y)));
  };
  // The reference is the integral of the amplitude along the edge, by quadrature.
  double worst = 0, most = 0;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      const double x = extent * (i - 5.7) / 6, y = extent * (j - 5.3) / 6;
      const Complex sum = integrate(
          -0.5, 0.5, 4000, [&](double t) { return (a + (b - a) * (t + 0.5)) * std::polar(1.0, -x * t); });
      const double expected = std::abs(sum * y) / (2 * pi * (x * x + y * y));
      worst = std::max(worst, std::abs(size(x, y) - expected)), most = std::max(most, expected);
    }
  std::string caption = fmt::format(
      "a = {:g}, b = {:g}; canonical coordinates to {:g}; off the integral along the edge by {:.1e} of its largest value",
      a, b, extent, worst / most);
  // Scale of the picture, sampled away from 0, since the pole there would dominate it.
  const double top = size(0.08 * extent, 0.08 * extent) + size(0, 0.1 * extent);
  const auto shade = [=](double x, double y) { return std::sqrt(size(x, y) / top); };
  if (!(inset > 0)) return {[=](double u, double v) { return shade(extent * u, extent * v); }, caption};
  // The published lobe chi of an edge has the standard deviation sqrt(3).
  const double sigma = std::numbers::sqrt3;
  const optics::EdgeConstants constants = optics::edge_constants(sigma);
  const double power = (a - b) * (a - b) * constants.alpha1 + 0.25 * (a + b) * (a + b) * constants.alpha2;
  const double found = power_without_lobe([&](double x, double y) { return std::pow(size(x, y), 2); }, sigma);
  caption += fmt::format(
      "; inset to {:g}: the 0th-order lobe removed, whose power {:.6f} is {:.1e} of itself off a quadrature over the plane",
      inset, power, std::abs(found / power - 1));
  return {[=](double u, double v) {
            const double begin = 0.26, frame = 0.02;
            if (u < begin || v > -begin) return shade(extent * u, extent * v);
            if (u < begin + frame || v > -begin - frame) return 1.0;
            const double half = 0.5 * (1 - begin - frame), x = inset * ((u - 1 + half) / half),
                         y = inset * ((v + 1 - half) / half), r2 = x * x + y * y;
            return r2 > 0 ? std::sqrt(std::sqrt(-std::expm1(-r2 / (2 * sigma * sigma)))) * shade(x, y) : 0.0;
          },
          caption};
}

EdgeCurves edge_amplitude(double a, double b, double ratio) {
  // An edge of length 1 in a beam whose amplitude has the standard deviation 1/ratio.
  const auto gauss = [&](double t) { return std::exp(-0.5 * std::pow(ratio * t, 2)); };
  const double ends = gauss(0.5), from = a * ends, to = b * ends;
  PlotSeries series[] = {line("exact", 0), line("linear amplitude", 1), line("constant amplitude", 2)};
  double errors[2] = {}, sum = 0;
  for (int i = 0; i <= 360; ++i) {
    const double theta = pi * (i / 360.0 - 0.5), radius = 4 * pi, x = radius * std::sin(theta),
                 y = radius * std::cos(theta);
    const Complex along = integrate(-0.5, 0.5, 2000, [&](double t) {
      return (0.5 * (a + b) + (b - a) * t) * gauss(t) * std::polar(1.0, -x * t);
    });
    const Complex exact = along * y / (2 * pi * radius * radius),
                  even = 0.5 * (from + to) * optics::edge_alpha2(x, y),
                  linear = even - Complex(0, 1) * (from - to) * optics::edge_alpha1(x, y);
    const Complex values[] = {exact, linear, even};
    for (int k = 0; k < 3; ++k)
      series[k].x.push_back(180 * theta / pi), series[k].y.push_back(std::abs(values[k]));
    for (int k = 0; k < 2; ++k) errors[k] += std::norm(values[k + 1] - exact);
    sum += std::norm(exact);
  }
  return {
      svg_plot({fmt::format("An edge of {:.3g} sigma, amplitudes {:g} and {:g}", ratio, a, b),
                "direction about the light / degrees",
                "root of the intensity",
                {series[0], series[1], series[2]},
                false}),
      fmt::format(
          "two fringes from the middle; off the integral along the edge, by quadrature, by {:.2g} (linear) and "
          "{:.2g} (constant) of its root mean square",
          std::sqrt(errors[0] / sum), std::sqrt(errors[1] / sum))};
}

EdgeCurves edge_profile(double width, int pieces) {
  const double half = 0.5 * width;  // half of the width, in units of sigma of the intensity
  const auto amplitude = [](double x) { return std::exp(-0.25 * x * x); };
  const auto exact = [&](PlanePoint q) {
    const auto along = [&](double k) {
      return integrate(-half, half, 2000, [&](double x) { return amplitude(x) * std::polar(1.0, -k * x); });
    };
    return along(q.x) * along(q.y);
  };
  const auto edges_of = [&](int count, bool constant) {
    const PlanePoint corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
    std::vector<DiffractingEdge> edges;
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < count; ++i) {
        const auto at = [&](double t) {
          const PlanePoint &p = corners[side], &r = corners[(side + 1) % 4];
          return PlanePoint{p.x + t * (r.x - p.x), p.y + t * (r.y - p.y)};
        };
        const PlanePoint from = at(double(i) / count), to = at((i + 1.0) / count),
                         middle = at((i + 0.5) / count);
        const auto value = [&](PlanePoint p) { return Complex(amplitude(p.x) * amplitude(p.y)); };
        edges.push_back({from, to, value(constant ? middle : from), value(constant ? middle : to)});
      }
    return edges;
  };
  const auto constant = edges_of(pieces, true), linear = edges_of(pieces, false);
  PlotSeries series[] = {line("exact", 0), line("linear amplitude", 1), line("constant amplitude", 2)};
  double error[2] = {}, sum = 0, tail[2] = {}, tail_sum = 0;
  for (int i = 0; i <= 240; ++i) {
    // Directions on a circle around the beam, as in figure 3 of Steinberg et al. 2024; 90 degrees is
    // perpendicular to a side.
    const double theta = pi * i / 240, radius = 4 * pi / width;
    const PlanePoint q{radius * std::cos(theta), radius * std::sin(theta)};
    const double values[] = {std::abs(exact(q)), std::abs(optics::edge_field(linear, q)),
                             std::abs(optics::edge_field(constant, q))};
    for (int k = 0; k < 3; ++k) series[k].x.push_back(180 * theta / pi), series[k].y.push_back(values[k]);
    const PlanePoint far{8 * q.x, 8 * q.y};
    const Complex f = exact(far);
    for (int k = 0; k < 2; ++k) {
      error[k] += std::pow(values[k + 1] - values[0], 2);
      tail[k] += std::norm(optics::edge_field(k ? constant : linear, far) - f);
    }
    sum += values[0] * values[0], tail_sum += std::norm(f);
  }
  return {
      svg_plot({fmt::format("A square of {:g} sigma, {} pieces to a side", width, pieces),
                "direction about the beam / degrees",
                "|F| / sigma^2",
                {series[0], series[1], series[2]},
                false}),
      fmt::format(
          "|q| = 2 fringes of the square. Off the exact transform (by quadrature) by {:.2g} (linear) and {:.2g} (constant) of its root "
          "mean square there, and by {:.2g} and {:.2g} at eight times that angle",
          std::sqrt(error[0] / sum), std::sqrt(error[1] / sum), std::sqrt(tail[0] / tail_sum),
          std::sqrt(tail[1] / tail_sum))};
}

namespace {

/// Returns the exact field of a plane wave at a metallic wedge, with the electric field along the edge
/// (Bowman, Senior & Uslenghi 1969, Electromagnetic and Acoustic Scattering by Simple Shapes, chapter 6).
Complex wedge_series(double n, double k_rho, double phi, double phi_i) {
  Complex sum = 0;
  const int terms = int(n * (k_rho + 30 + 6 * std::cbrt(k_rho)));
  for (int m = 1; m <= terms; ++m) {
    const double nu = m / n;
    sum += boost::math::cyl_bessel_j(nu, k_rho) * std::polar(1.0, -0.5 * pi * nu) * std::sin(nu * phi) *
           std::sin(nu * phi_i);
  }
  return 4 / n * sum;
}

}  // namespace

EdgeMap wedge_map(double n, double phi_i, double wavelengths) {
  const double k = 2 * pi, outside = n * pi;
  const auto field = [=](double x, double y) -> Complex {
    double phi = std::atan2(y, x);
    if (phi < 0) phi += 2 * pi;
    if (phi > outside) return 0;
    const double rho = std::max(std::hypot(x, y), 0.02);
    return optics::Wedge(n).plane_wave_field(k, rho, phi, phi_i, optics::kSoftMetal);
  };
  std::string error;
  if (n < 2) {
    error = "off the exact series of Bessel functions, in parts of the incident field at most:";
    for (const double rho : {0.5, 2.0, 0.5 * wavelengths}) {
      double worst = 0;
      for (int i = 0; i < 120; ++i) {
        const double phi = outside * (i + 0.37) / 120;
        worst = std::max(worst,
                         std::abs(optics::Wedge(n).plane_wave_field(k, rho, phi, phi_i, optics::kSoftMetal) -
                                  wedge_series(n, k * rho, phi, phi_i)));
      }
      error += fmt::format(" {:.1e} at {:g},", worst, rho);
    }
    error.back() = ' ';
    error += "wavelengths from the edge";
  } else {
    // Reference by Sommerfeld 1896: u = U(phi - phi') - U(phi + phi'), with Fresnel integrals.
    double worst = 0;
    for (int i = 0; i < 400; ++i) {
      const double phi = 2 * pi * (i + 0.37) / 400, rho = 0.3 + 0.02 * i;
      const auto part = [&](double angle) {
        // Fresnel parameter, with rho in wavelengths
        const double v = 2 * std::sqrt(2 * rho) * std::cos(0.5 * angle);
        return std::polar(1.0, -k * rho * std::cos(angle)) * optics::knife_edge_field(v);
      };
      worst =
          std::max(worst, std::abs(optics::Wedge(n).plane_wave_field(k, rho, phi, phi_i, optics::kSoftMetal) -
                                   (part(phi - phi_i) - part(phi + phi_i))));
    }
    error = fmt::format("off Sommerfeld's exact solution by {:.1e} of the incident field at most", worst);
  }
  return {[=](double u, double v) {
            return 0.25 * std::norm(field(0.5 * wavelengths * u, 0.5 * wavelengths * v));
          },
          fmt::format(
              "n = {:g}, light from {:g} degrees, {:g} wavelengths wide, electric field along the edge; {}",
              n, 180 * phi_i / pi, wavelengths, error)};
}

namespace {

/// Returns the field by the uniform theory of diffraction (UTD) behind straight edges that run
/// counter-clockwise around an aperture. Each edge contributes at the point that satisfies Keller's
/// condition. A plane wave arrives along z.
Complex utd_field(const std::vector<std::pair<PlanePoint, PlanePoint>>& edges, PlanePoint at, double z,
                  double k, bool is_lit) {
  Complex sum = is_lit ? std::polar(1.0, k * z) : Complex(0);
  for (const auto& [a, b] : edges) {
    const double size = std::hypot(b.x - a.x, b.y - a.y), ex = (b.x - a.x) / size, ey = (b.y - a.y) / size;
    const double along = (at.x - a.x) * ex + (at.y - a.y) * ey;
    if (along < 0 || along > size) continue;
    // distance across the edge, positive over the aperture, to the left of the edge
    const double across = (at.y - a.y) * ex - (at.x - a.x) * ey;
    const double s = std::hypot(across, z);
    // Angle from the screen's irradiated side: the wave arrives from pi/2, the undeviated direction is 3
    // pi/2, the aperture is at pi.
    const double phi = 1.5 * pi - std::atan2(across, z);
    sum +=
        optics::Wedge(2).coefficient(k, s, 1, phi, 0.5 * pi, {0, 0}) / std::sqrt(s) * std::polar(1.0, k * s);
  }
  return sum;
}

}  // namespace

EdgeCurves opening_profile(const std::string& shape, double wavelengths, double fresnel) {
  const double k = 2 * pi, half = 0.5 * wavelengths, distance = half * half / fresnel;
  std::vector<optics::Ring> rings;
  const auto rectangle = [&](double x0, double x1, double y) {
    rings.push_back({{x0, -y}, {x1, -y}, {x1, y}, {x0, y}});
  };
  const auto circle = [&](double r, bool forwards) {
    optics::Ring ring;
    for (int i = 0; i < 32; ++i) {
      const double t = 2 * pi * (forwards ? i : 32 - i) / 32;
      ring.push_back({r * std::cos(t), r * std::sin(t)});
    }
    rings.push_back(ring);
  };
  if (shape == "square") rectangle(-half, half, half);
  if (shape == "slits") rectangle(-half, -0.5 * half, half), rectangle(0.5 * half, half, half);
  if (shape == "ring") circle(half, true), circle(0.6 * half, false);
  const auto region = optics::PolygonRegion::even_odd(rings);
  const auto opening = optics::FlatOpening::polygon(region);
  const auto edges = optics::region_edges(region);
  std::vector<std::pair<PlanePoint, PlanePoint>> sides;
  for (const DiffractingEdge& e : edges) sides.push_back({e.from, e.to});

  PlotSeries series[] = {line("Rayleigh-Sommerfeld", 0), line("edge waves", 1), line("Fraunhofer", 2),
                         line("UTD", 3)};
  const double first = 1 / wavelengths;  // sine of the angle of the first fringe
  double errors[3] = {}, sum = 0;
  const int count = 160;
  for (int i = 1; i <= count; ++i) {
    const double sine = 6 * first * i / count, x = distance * sine / std::sqrt(1 - sine * sine);
    const double r = std::hypot(x, distance);
    const Complex exact = optics::rayleigh_sommerfeld(opening, optics::ScreenSource::plane_wave({0, 0, 1}),
                                                      {x, 0.013 * half, distance}, k);
    // Scale of U = k/(2 pi i) exp(i k R)/R F; the Rayleigh integral has the additional factor z/r.
    const double scale = std::pow(k / (2 * pi * r) * distance / r, 2);
    const PlanePoint q{k * sine, k * 0.013 * half / r};
    bool lit = x < half && shape == "square";
    if (shape == "slits") lit = x > 0.5 * half && x < half;
    if (shape == "ring")
      lit =
          std::hypot(x, 0.013 * half) < half * std::cos(pi / 32) && std::hypot(x, 0.013 * half) > 0.6 * half;
    const double values[] = {std::norm(exact), scale * std::norm(optics::edge_field(edges, q)),
                             scale * std::norm(optics::fraunhofer(opening, q)),
                             std::norm(utd_field(sides, {x, 0.013 * half}, distance, k, lit))};
    for (int s = 0; s < 4; ++s) {
      series[s].x.push_back(180 * std::asin(sine) / pi);
      series[s].y.push_back(std::max(values[s], 1e-8));
      if (s > 0) errors[s - 1] += std::pow(std::sqrt(values[s]) - std::sqrt(values[0]), 2);
    }
    sum += values[0];
  }
  return {
      svg_plot({fmt::format("{} of {:g} wavelengths, {:.0f} wavelengths behind (Fresnel number {:g})", shape,
                            wavelengths, distance, fresnel),
                "angle / degrees",
                "|U|^2",
                {series[0], series[1], series[2], series[3]},
                true}),
      fmt::format(
          "root mean square of the error of |U| over that of Rayleigh and Sommerfeld's: edge waves {:.2g}, Fraunhofer {:.2g}, UTD {:.2g}",
          std::sqrt(errors[0] / sum), std::sqrt(errors[1] / sum), std::sqrt(errors[2] / sum))};
}

EdgeCurves slits_profile(const SlitsAndSolver& slits) {
  std::vector<optics::Ring> rings;
  const double x = 0.5 * slits.width, y = 0.5 * slits.height;
  for (const double c : {-0.5 * slits.apart, 0.5 * slits.apart})
    rings.push_back({{c - x, -y}, {c + x, -y}, {c + x, y}, {c - x, y}});
  const auto region = optics::PolygonRegion::even_odd(rings);
  const auto opening = optics::FlatOpening::polygon(region);
  const auto edges = optics::region_edges(region);
  const double k = 2 * pi / slits.wavelength, per_area = 1 / std::pow(slits.wavelength, 2);
  const auto waves = [&](double degrees) {
    const double q = k * std::sin(degrees * pi / 180);
    return per_area * (q > 0 ? std::norm(optics::edge_field(edges, {q, 0})) : std::pow(region.area(), 2));
  };
  // In the far field, the Rayleigh-Sommerfeld integral is the Fraunhofer integral times the cosine of the
  // angle.
  const auto integral = [&](double degrees) {
    const double t = degrees * pi / 180;
    return per_area * std::norm(std::cos(t) * optics::fraunhofer(opening, {k * std::sin(t), 0}));
  };
  const auto db = [](double ratio) { return 10 * std::log10(ratio); };
  PlotSeries series[] = {line("wave solver", 1), line("edge waves", 0), line("Rayleigh-Sommerfeld", 2)};
  series[0].kind = PlotSeries::Kind::points;
  const std::vector<double>& solver = slits.solver;
  const double ahead = solver[0], floor = 1e-5 * ahead, end = slits.step_degrees * double(solver.size() - 1);
  for (int i = 0; i <= 600; ++i) {
    const double t = end * i / 600;
    series[1].x.push_back(t), series[1].y.push_back(std::max(waves(t), floor));
    series[2].x.push_back(t), series[2].y.push_back(std::max(integral(t), floor));
  }
  double errors[2] = {}, sum = 0, in_lobes = 0;
  std::size_t outer = 0;  // index of the highest intensity beyond 25 degrees
  for (std::size_t i = 0; i < solver.size(); ++i) {
    const double t = slits.step_degrees * double(i), model = waves(t);
    series[0].x.push_back(t), series[0].y.push_back(std::max(solver[i], floor));
    errors[0] += std::pow(std::sqrt(model) - std::sqrt(solver[i]), 2);
    errors[1] += std::pow(std::sqrt(integral(t)) - std::sqrt(solver[i]), 2);
    sum += solver[i];
    if (t <= 20 && model > 0.02 * ahead) in_lobes = std::max(in_lobes, std::abs(db(model / solver[i])));
    if (t > 25 && (outer == 0 || solver[i] > solver[outer])) outer = i;
  }
  std::string lobe;
  if (outer > 0) {
    const double t = slits.step_degrees * double(outer);
    lobe = fmt::format(", {:+.2f} dB in the lobe at {:g} degrees", db(waves(t) / solver[outer]), t);
  }
  return {
      svg_plot({fmt::format("Two slits of {:.0f} x {:.0f} wavelengths beside a wave solver",
                            slits.width / slits.wavelength, slits.height / slits.wavelength),
                "angle / degrees",
                "intensity / (m^2/sr)",
                {series[1], series[2], series[0]},
                true}),
      fmt::format(
          "edge waves beside the solver: {:+.2f} dB straight on, within {:.2f} dB in the lobes to 20 degrees{}; root mean square of "
          "the error of |U| over that of the solver {:.2g}, of Rayleigh and Sommerfeld's integral {:.2g}",
          db(waves(0) / ahead), in_lobes, lobe, std::sqrt(errors[0] / sum), std::sqrt(errors[1] / sum))};
}

}  // namespace aureole
