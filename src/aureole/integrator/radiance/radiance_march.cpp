// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/radiance/radiance_march.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/core/random.h"
#include "aureole/integrator/dvr/cell_roots.h"
#include "aureole/integrator/splat/blended_light.h"

namespace aureole {

namespace {

/// A polynomial of degree 3 of s in [0, 1].
struct Cubic {
  double c[4] = {0, 0, 0, 0};

  /// From its values at s = 0, 1/3, 2/3 and 1.
  static Cubic through(const double f[4]) {
    return {{f[0], 0.5 * (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]),
             4.5 * (2 * f[0] - 5 * f[1] + 4 * f[2] - f[3]), 4.5 * (-f[0] + 3 * f[1] - 3 * f[2] + f[3])}};
  }
  double at(double s) const { return ((c[3] * s + c[2]) * s + c[1]) * s + c[0]; }
  double integral(double s) const { return (((c[3] / 4 * s + c[2] / 3) * s + c[1] / 2) * s + c[0]) * s; }
};

/// Five points of Gauss and Legendre in [0, 1].
constexpr double kGaussPoints[5] = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                    0.953089922969332};
constexpr double kGaussWeights[5] = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                     0.239314335249683, 0.118463442528095};

class RadianceMarch {
public:
  RadianceMarch(const RadianceMedium& medium, const RadianceSettings& settings, const Ray& ray)
      : field_(medium.field()),
        settings_(settings),
        decodes_(medium.is_encoded() && settings.blends_linear),
        ray_(ray),
        view_(field_.view_along(ray.d)),
        per_length_(field_.extinction_along(ray.d)) {
    for (int axis = 0; axis < 3; ++axis) last_[axis] = float(field_.voxels().size[std::size_t(axis)]) - 0.5f;
  }

  RadianceResult follow(std::uint64_t key) {
    const auto crossing = field_.cross_box(ray_);
    if (!crossing) return {};
    begin_ = (*crossing)[0], end_ = (*crossing)[1];
    if (settings_.method == RadianceSettings::Method::nerf)
      add_steps(key);
    else
      integrate();
    for (int k = 0; k < 3; ++k) result_.color[k] = float(color_[k]);
    result_.transmittance = passed_ < double(settings_.termination) ? 0.f : float(passed_);
    return result_;
  }

private:
  /// The voxels around a point of the ray; those of the border where rounding leads out of the box.
  bool find(double t, RadianceField::Cell& cell) const {
    Vec3 index = field_.index_of(ray_.o + ray_.d * float(t));
    for (int axis = 0; axis < 3; ++axis) index[axis] = std::clamp(index[axis], -0.5f, last_[axis]);
    return field_.find_cell(index, cell);
  }
  double shown(double color) const {
    const double positive = std::max(0., color);
    return decodes_ ? double(srgb_decode(float(positive))) : positive;
  }
  void pass(double factor, double t) {
    if (passed_ > 0.5 && passed_ * factor <= 0.5) result_.depth = float(t);
    passed_ *= factor;
  }

  /// Sums steps up from front to back: C = sum c_i alpha_i prod_{j < i} (1 - alpha_j), alpha = 1 - exp(-sigma delta)
  /// (Mildenhall and others 2020, equation 3; Max 1995). Cells without density are passed over, where alpha is 0.
  void add_steps(std::uint64_t key) {
    const double step = double(settings_.step) / double(length(field_.index_vector(ray_.d)));
    constexpr double kMostSteps = 1e9;
    // A step that begins within the rounding of the end is none.
    constexpr double kRounding = 1e-4;
    const double count =
        std::clamp(std::ceil((double(end_) - double(begin_)) / step - kRounding), 1., kMostSteps);
    const auto place = [&](double i) {
      double within = 0;
      if (settings_.samples == RadianceSettings::Samples::middle) within = 0.5;
      if (settings_.samples == RadianceSettings::Samples::jittered)
        within = double(combine_bits(key, std::uint64_t(i)) >> 40) * 0x1p-24;
      return double(begin_) + (i + within) * step;
    };
    const bool ends_at_surface = end_ == ray_.t_max;
    MajorantGrid::Walk walk(field_.grid(), ray_, end_);
    MajorantGrid::Piece piece;
    double i = 0;
    while (i < count && walk.next(piece)) {
      i = std::max(i, std::floor((double(piece.begin) - double(begin_)) / step) - 1);
      for (double t; i < count && (t = place(i)) < double(piece.end); ++i) {
        if (t < double(piece.begin)) continue;
        RadianceField::Cell cell;
        if (!find(t, cell)) continue;
        const double density = double(field_.raw_density(cell));
        if (!(density > double(settings_.density_limit))) continue;
        double delta = settings_.samples == RadianceSettings::Samples::jittered ? place(i + 1) - t : step;
        if (ends_at_surface) delta = std::min(delta, double(end_) - t);
        const bool is_last = i + 1 >= count;
        const double left =
            is_last && settings_.last_is_opaque ? 0 : std::exp(-density * double(per_length_) * delta);
        const Vec3 color = field_.raw_color(cell, view_);
        for (int k = 0; k < 3; ++k) color_[k] += passed_ * (1 - left) * shown(double(color[k]));
        pass(left, t);
        if (passed_ < double(settings_.termination)) return;
      }
    }
  }

  /// Integrates cell by cell. Along a ray the trilinear density and the colours are cubics of the distance: the optical
  /// thickness has a closed form, and the light of a piece between their roots is smooth, for Gauss's rule.
  void integrate() {
    MajorantGrid::Walk walk(field_.grid(), ray_, end_);
    MajorantGrid::Piece piece;
    std::vector<double> breaks;
    while (walk.next(piece)) {
      const double a = std::max(double(piece.begin), double(begin_)),
                   b = std::min(double(piece.end), double(end_));
      if (!(b > a)) continue;
      RadianceField::Cell cells[4];
      double density[4];
      bool found[4], any = false;
      for (int k = 0; k < 4; ++k) {
        found[k] = find(a + (b - a) * k / 3, cells[k]);
        density[k] = found[k] ? double(field_.raw_density(cells[k])) : 0;
        any |= density[k] > 0;
      }
      if (!any) continue;
      const Cubic sigma = Cubic::through(density);
      double colors[3][4];
      for (int k = 0; k < 4; ++k) {
        const Vec3 c = found[k] ? field_.raw_color(cells[k], view_) : Vec3{0.5f, 0.5f, 0.5f};
        for (int channel = 0; channel < 3; ++channel) colors[channel][k] = double(c[channel]);
      }
      breaks.assign({0, 1});
      const auto add_root = [&](double s) { breaks.push_back(s); };
      visit_cubic_roots(density, 0, add_root);
      Cubic color[3];
      for (int channel = 0; channel < 3; ++channel) {
        color[channel] = Cubic::through(colors[channel]);
        visit_cubic_roots(colors[channel], 0, add_root);
      }
      std::sort(breaks.begin(), breaks.end());
      for (std::size_t k = 1; k < breaks.size(); ++k)
        if (!add_piece(sigma, color, breaks[k - 1], breaks[k], a, b - a)) return;
    }
  }

  /// Adds the part [s0, s1] of a cell that begins at the distance `a` and is `extent` long. Returns false where the ray ends.
  bool add_piece(const Cubic& sigma, const Cubic color[3], double s0, double s1, double a, double extent) {
    if (!(s1 > s0) || !(sigma.at(0.5 * (s0 + s1)) > 0)) return true;
    const double scale = extent * double(per_length_);
    const double thickness = scale * (sigma.integral(s1) - sigma.integral(s0));
    constexpr double kThicknessOfPart = 0.25, kMostParts = 4096;
    const double parts = std::clamp(std::ceil(thickness / kThicknessOfPart), 1., kMostParts);
    for (double part = 0; part < parts; ++part) {
      const double from = s0 + (s1 - s0) * part / parts, to = s0 + (s1 - s0) * (part + 1) / parts;
      const double start = sigma.integral(from);
      for (int g = 0; g < 5; ++g) {
        const double s = from + (to - from) * kGaussPoints[g];
        const double light = passed_ * kGaussWeights[g] * (to - from) * scale * sigma.at(s) *
                             std::exp(-scale * (sigma.integral(s) - start));
        for (int k = 0; k < 3; ++k) color_[k] += light * shown(color[k].at(s));
      }
      pass(std::exp(-scale * (sigma.integral(to) - start)), a + extent * to);
      if (passed_ < double(settings_.termination)) return false;
    }
    return true;
  }

  const RadianceField& field_;
  const RadianceSettings& settings_;
  const bool decodes_;
  const Ray ray_;
  const RadianceField::View view_;
  const float per_length_;
  float last_[3];
  float begin_ = 0, end_ = 0;
  double color_[3] = {0, 0, 0}, passed_ = 1;
  RadianceResult result_;
};

}  // namespace

RadianceResult march_radiance(const RadianceMedium& medium, const RadianceSettings& settings, const Ray& ray,
                              std::uint64_t key) {
  return RadianceMarch(medium, settings, ray).follow(key);
}

RadianceSettings RadianceSettings::read(const Properties& p) {
  RadianceSettings s;
  s.method = p.get_choice("method", "nerf", {"nerf", "exact"}) == "nerf" ? Method::nerf : Method::exact;
  const std::string samples = p.get_choice("samples", "start", {"start", "middle", "jittered"});
  s.samples = samples == "start" ? Samples::start : samples == "middle" ? Samples::middle : Samples::jittered;
  s.last_is_opaque = p.get_choice("last_step", "step", {"step", "opaque"}) == "opaque";
  s.blends_linear = p.get_choice("color_space", "grid", {"grid", "linear"}) == "linear";
  s.step = float(p.get_float("step", 0.5, {1e-3, 1e6}));
  s.density_limit = float(p.get_float("density_limit", 1e-10, Range::non_negative()));
  s.termination = float(p.get_float("termination", 1e-7, {0, 0.5}));
  s.background = read_background(p);
  if (s.method == Method::exact)
    for (const char* name : {"samples", "last_step", "step", "density_limit"})
      if (p.has(name)) throw p.error(name, "has no effect on the exact integral; it is for \"nerf\"");
  return s;
}

std::vector<ParameterDoc> RadianceSettings::rows() {
  return {
      {"method", "string", "", "nerf",
       "nerf: the sum of colour times opacity times what passes before, each step with the opacity 1 - exp(-sigma delta); exact: "
       "the integral that this sum approximates"},
      {"step", "float", "voxels", "0.5", "length of a step of nerf"},
      {"samples", "string", "", "start",
       "the place of a step at which density and colour are taken: start (Plenoxels), middle, or jittered (NeRF, one random place "
       "in each step, up to the place of the next)"},
      {"last_step", "string", "", "step",
       "length of the last step: step, as the others (Plenoxels), or opaque, infinite (NeRF): what has density there hides what is "
       "behind"},
      {"density_limit", "float", "1/length of the grid", "1e-10", "samples of less density are left out"},
      {"termination", "float", "", "1e-07",
       "the ray ends, opaque, where less of the light behind would pass"},
      {"color_space", "string", "", "grid",
       "of the colours that are blended: grid, as the grid has them, decoded after blending; linear, decoded before: light in a "
       "medium, as other integrators follow it"},
      {"background", "string", "", "none",
       "red, green and blue, blended behind the grid in the colours that are blended; nothing else is seen then"},
      {"integrator", "integrator", "", "path", "what is seen behind the grid and through it"}};
}

}  // namespace aureole
