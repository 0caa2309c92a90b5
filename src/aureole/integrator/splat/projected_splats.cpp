// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/projected_splats.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/integrator/splat/depth_sort.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

struct Vec3d {
  double x = 0, y = 0, z = 0;
};
double dot3(const Vec3d& a, const Vec3d& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3d times(const Transform::Matrix& m, const Vec3d& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

/// A symmetric 2 x 2 matrix.
struct Covariance {
  double xx = 0, xy = 0, yy = 0;
  double determinant() const { return xx * yy - xy * xy; }
};

/// The part of the picture that a footprint can reach [pixels].
struct Reach {
  double x0, x1, y0, y1;
};

/// The reach of the curve |(A, B)| = k D relative to the centre, with the rows of A and B and the gradient d
/// of D. The curve is an ellipse where the dual conic C has C33 < 0; the lines x = t and y = t that touch it
/// are the roots of C_ii - 2 t C_i3 + t^2 C33. Returns false where it is no ellipse.
bool ellipse_reach(const SplatFootprint& f, double k, Reach& reach) {
  const double a0 = double(f.a0), a1 = double(f.a1), b0 = double(f.b0), b1 = double(f.b1), d0 = double(f.d0),
               d1 = double(f.d1);
  const double det = a0 * b1 - a1 * b0;
  // G = M^-1 M^-T of M = [[a0, a1], [b0, b1]].
  const double gxx = (b1 * b1 + a1 * a1) / (det * det), gyy = (b0 * b0 + a0 * a0) / (det * det),
               gxy = -(b1 * b0 + a1 * a0) / (det * det);
  const double gx = gxx * d0 + gxy * d1, gy = gxy * d0 + gyy * d1, c33 = d0 * gx + d1 * gy - 1 / (k * k);
  if (!(c33 < 0)) return false;
  const auto roots = [&](double gii, double gi, double& low, double& high) {
    const double root = std::sqrt(std::max(0., gi * gi - gii * c33));
    low = (-gi + root) / c33, high = (-gi - root) / c33;
  };
  roots(gxx, gx, reach.x0, reach.x1);
  roots(gyy, gy, reach.y0, reach.y1);
  return std::isfinite(reach.x0) && std::isfinite(reach.x1) && std::isfinite(reach.y0) &&
         std::isfinite(reach.y1);
}

/// Projects the splats of one medium.
struct SplatProjector {
  const SplatCloud& cloud;
  const SplatSettings& settings;
  const SplatConventions& conventions;
  const PinholeView& view;
  Transform::Matrix to_camera;  ///< matrix from the axes of the cloud to the camera
  Transform::Matrix turn;       ///< the rotation of the world to the axes of the cloud
  Vec3d eye;                    ///< position of the camera in world space
  Transform::Matrix to_world;
  double near, cutoff;
  bool compensates;
  double lower_x, upper_x, lower_y, upper_y;  ///< limits of x / z and y / z of the linearisation

  SplatProjector(const SplatMedium& medium, const SplatSettings& s, const SplatConventions& c,
                 const PinholeView& v, const FilmPart& part, float film_height)
      : cloud(medium.cloud()), settings(s), conventions(c), view(v) {
    to_camera = (view.to_camera * medium.to_world()).matrix();
    turn = medium.to_world().orthogonal_part().inverse().matrix();
    to_world = medium.to_world().matrix();
    const auto back = view.to_camera.inverse().matrix();
    eye = {back[0][3], back[1][3], back[2][3]};
    near = double(std::max(s.near, view.near));
    const float by_format = cloud.hints.cutoff > 0 ? cloud.hints.cutoff : 10.f / 3;
    cutoff = double(s.cutoff > 0 ? s.cutoff : s.blends() ? by_format : 1.f);
    compensates = s.compensation == SplatSettings::Compensation::on ||
                  (s.compensation == SplatSettings::Compensation::file && cloud.hints.antialiased);
    // Tangents at the borders of the picture, with a margin of the picture's own half width (as in gsplat, for any centre).
    const double f = double(view.focal), margin = double(s.jacobian_limit) - 1;
    const double half_x = 0.5 * double(part.width) / f, half_y = 0.5 * double(film_height) / f;
    lower_x = -(double(view.center.x) - double(part.left)) / f - margin * half_x;
    upper_x = (double(part.left) + double(part.width) - double(view.center.x)) / f + margin * half_x;
    lower_y = -double(view.center.y) / f - margin * half_y;
    upper_y = (double(film_height) - double(view.center.y)) / f + margin * half_y;
  }

  /// Sets the quadratic form of a footprint by the inverse of a covariance. Returns false if it has no area.
  static bool set_form(const Covariance& c, double sx, double sy, double tx, double ty, SplatFootprint& f) {
    // (u, v) = (sx dx + sy dy, tx dx + ty dy); the exponent is that of the Cholesky factor of the inverse.
    const double det = c.determinant();
    if (!(det > 0) || !std::isfinite(det)) return false;
    const double a = c.yy / det, b = -c.xy / det, root = std::sqrt(a), rest = std::sqrt(1 / c.yy);
    const double v = b / root;
    f.a0 = float(root * sx + v * tx), f.a1 = float(root * sy + v * ty);
    f.b0 = float(rest * tx), f.b1 = float(rest * ty);
    return std::isfinite(f.a0) && std::isfinite(f.a1) && std::isfinite(f.b0) && std::isfinite(f.b1);
  }

  enum class Outcome { outside, no_area, visible };

  Outcome project(std::size_t i, SplatFootprint& f, float& depth, Reach& reach) const {
    using Footprint = SplatSettings::Footprint;
    const Vec3 q = cloud.positions[i];
    const Vec3d object{double(q.x), double(q.y), double(q.z)};
    Vec3d p = times(to_camera, object);
    p = {p.x + to_camera[0][3], p.y + to_camera[1][3], p.z + to_camera[2][3]};
    if (!(p.z > near && p.z < double(view.far))) return Outcome::outside;
    const double focal = double(view.focal), distance = std::sqrt(dot3(p, p));
    f.x = float(double(view.center.x) + focal * p.x / p.z),
    f.y = float(double(view.center.y) + focal * p.y / p.z);
    if (!std::isfinite(f.x) || !std::isfinite(f.y) || !std::isfinite(float(distance)))
      return Outcome::outside;
    f.distance = float(distance);
    depth = conventions.sorting == SplatHints::Sorting::camera_distance ? f.distance : float(p.z);
    f.d0 = f.d1 = 0;
    f.weight = cloud.opacities[i];
    const Vec3 s = cloud.scales[i];

    // Columns of the matrix that maps the unit sphere to the splat in camera space.
    const auto& r = cloud.rotations[i];
    const double w = double(r[0]), x = double(r[1]), y = double(r[2]), z = double(r[3]);
    Vec3d axes[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                     {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                     {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const double scale = double(s[k]);
      const Vec3d a = times(to_camera, axes[k]);
      axes[k] = {a.x * scale, a.y * scale, a.z * scale};
      longest = std::max(longest, std::sqrt(dot3(axes[k], axes[k])));
    }
    f.range = float(double(settings.depth_range) * longest);

    if (settings.footprint == Footprint::point) {
      f.x = std::floor(f.x) + 0.5f, f.y = std::floor(f.y) + 0.5f;
      f.a0 = f.a1 = f.b0 = f.b1 = 0, f.weight = 1, f.min_exponent = 0;
      reach = {-0.5, 0.5, -0.5, 0.5};
    } else {
      Covariance c;
      const auto add_axes = [&](const Vec3d& row_x, const Vec3d& row_y) {
        for (const Vec3d& a : axes) {
          const double u = dot3(row_x, a), v = dot3(row_y, a);
          c.xx += u * u, c.xy += u * v, c.yy += v * v;
        }
      };
      bool has_form;
      double area_ratio = 1;
      const auto dilate = [&](double variance) {
        const double before = std::max(0., c.determinant());
        c.xx += variance, c.yy += variance;
        area_ratio = std::sqrt(before / c.determinant());
      };
      if (conventions.projection == SplatHints::Projection::tangential) {
        const Vec3d n{p.x / distance, p.y / distance, p.z / distance};
        const Frame frame = Frame::from_normal({float(n.x), float(n.y), float(n.z)});
        const Vec3d e{double(frame.s.x), double(frame.s.y), double(frame.s.z)},
            g{double(frame.t.x), double(frame.t.y), double(frame.t.z)};
        add_axes(e, g);
        dilate(double(settings.dilation) * distance * distance / (focal * focal));
        const double unit = p.z / focal, slope = p.z / (focal * distance);
        has_form = set_form(c, unit * e.x, unit * e.y, unit * g.x, unit * g.y, f);
        f.d0 = float(n.x * slope), f.d1 = float(n.y * slope);
      } else if (settings.footprint == Footprint::gaussian) {
        const double deviation = longest * focal / p.z;
        c.xx = c.yy = deviation * deviation;
        has_form = set_form(c, 1, 0, 0, 1, f);
      } else {
        const double tx = std::clamp(p.x / p.z, lower_x, upper_x),
                     ty = std::clamp(p.y / p.z, lower_y, upper_y), scale = focal / p.z;
        add_axes({scale, 0, -scale * tx}, {0, scale, -scale * ty});
        dilate(double(settings.dilation));
        has_form = set_form(c, 1, 0, 0, 1, f);
      }
      if (!has_form) return Outcome::no_area;
      double k = cutoff;
      if (settings.blends()) {
        if (compensates) f.weight *= float(area_ratio);
        if (!(f.weight > 0) || f.weight < settings.opacity_limit) return Outcome::outside;
        if (settings.opacity_limit > 0)
          k = std::min(k, std::sqrt(2 * std::log(double(f.weight) / double(settings.opacity_limit))));
      } else if (settings.footprint == Footprint::ewa) {
        // height of the convolution of a Gaussian of height 1 with one of area 1
        f.weight = float(area_ratio);
      } else {
        f.weight = 1;
        if (settings.footprint == Footprint::disc) k = 1;
      }
      f.min_exponent = float(-0.5 * k * k);
      constexpr double kEverywhere = 1e9;
      if (!(k > 0)) k = 1e-3;
      if (!ellipse_reach(f, k * (1 + 1e-5), reach))
        reach = {-kEverywhere, kEverywhere, -kEverywhere, kEverywhere};
    }
    f.reach_y = float(std::max(-reach.y0, reach.y1) * (1 + 1e-6));
    return Outcome::visible;
  }

  void set_color(std::size_t i, SplatFootprint& f) const {
    const Vec3 q = cloud.positions[i];
    const Vec3d object{double(q.x), double(q.y), double(q.z)};
    Vec3d p = times(to_world, object);
    p = {p.x + to_world[0][3] - eye.x, p.y + to_world[1][3] - eye.y, p.z + to_world[2][3] - eye.z};
    const Vec3d d = times(turn, p);
    const double scale = 1 / std::sqrt(dot3(d, d));
    float functions[16];
    eval_harmonics(cloud.degree, {float(d.x * scale), float(d.y * scale), float(d.z * scale)}, functions);
    const Vec3 c = harmonic_color(cloud.harmonics_of(i), functions, cloud.coefficients());
    for (int k = 0; k < 3; ++k) {
      f.color[k] = std::max(0.f, c[k]);
      // Interpolation of points is linear in light.
      if (!settings.blends() && conventions.colors == SplatHints::Colors::srgb)
        f.color[k] = srgb_decode(f.color[k]);
    }
  }
};

}  // namespace

SplatConventions SplatConventions::of(std::span<const SplatMedium* const> media,
                                      const SplatSettings& settings, const Properties& properties) {
  const SplatHints& first = media.front()->cloud().hints;
  for (const SplatMedium* medium : media) {
    const SplatHints& h = medium->cloud().hints;
    const auto require = [&](bool same, const char* name) {
      if (!same)
        throw properties.error(name, "the files of splats differ in it: state which one they are blended by");
    };
    require(settings.sorting || h.sorting == first.sorting, "sorting");
    require(settings.projection || h.projection == first.projection, "projection");
    require(settings.colors || h.colors == first.colors, "color_space");
  }
  SplatConventions c{settings.sorting.value_or(first.sorting), settings.projection.value_or(first.projection),
                     settings.colors.value_or(first.colors)};
  if (!settings.blends()) c.projection = SplatHints::Projection::perspective;
  return c;
}

/// Footprints of a range of splats.
struct ProjectedSplats::Found {
  std::vector<SplatFootprint> footprints;
  std::vector<float> depths;
  std::vector<TileRange> ranges;
  std::size_t without_area = 0;
};

ProjectedSplats::ProjectedSplats(std::span<const SplatMedium* const> media, const SplatSettings& settings,
                                 const SplatConventions& conventions, const PinholeView& view,
                                 const FilmPart& part, int corner_x, int corner_y)
    : conventions_(conventions), part_(part) {
  const auto tiles_before = [](float from, int corner) {
    return int(std::ceil((float(corner) - from) / kTile));
  };
  left_ = corner_x - kTile * std::max(0, tiles_before(part.lower.x, corner_x));
  top_ = corner_y - kTile * std::max(0, tiles_before(part.lower.y, corner_y));
  columns_ = std::max(1, int(std::ceil((part.upper.x - float(left_)) / kTile)));
  rows_ = std::max(1, int(std::ceil((part.upper.y - float(top_)) / kTile)));
  std::vector<Found> parts;
  for (const SplatMedium* medium : media) project(*medium, settings, view, parts);

  std::vector<std::size_t> begins;
  std::size_t n = 0;
  for (const Found& found : parts) {
    begins.push_back(n);
    n += found.depths.size(), without_area_ += found.without_area;
  }
  UnfilledVector<float> depths(n);
  UnfilledVector<const SplatFootprint*> where(n);
  UnfilledVector<const TileRange*> range_of(n);
  for_ranges(
      parts.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          for (std::size_t i = 0; i < parts[k].depths.size(); ++i) {
            depths[begins[k] + i] = parts[k].depths[i];
            where[begins[k] + i] = &parts[k].footprints[i];
            range_of[begins[k] + i] = &parts[k].ranges[i];
          }
      },
      1);
  const UnfilledVector<std::uint32_t> order = sort_by_depth(depths);
  footprints_.resize(n);
  UnfilledVector<TileRange> ranges(n);
  for_ranges(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      footprints_[i] = *where[order[i]], ranges[i] = *range_of[order[i]];
  });
  list_by_tiles(ranges);
}

void ProjectedSplats::project(const SplatMedium& medium, const SplatSettings& settings,
                              const PinholeView& view, std::vector<Found>& parts) {
  constexpr std::size_t kPart = 4096;
  const SplatProjector projector(medium, settings, conventions_, view, part_, part_.height);
  const std::size_t n = medium.cloud().size(), first = parts.size(), count = (n + kPart - 1) / kPart;
  parts.resize(first + count);
  for_ranges(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Found& found = parts[first + k];
          for (std::size_t i = k * kPart; i < std::min(n, (k + 1) * kPart); ++i) {
            SplatFootprint f;
            float depth;
            Reach reach;
            const auto outcome = projector.project(i, f, depth, reach);
            found.without_area += outcome == SplatProjector::Outcome::no_area;
            if (outcome != SplatProjector::Outcome::visible) continue;
            const double x0 = double(f.x) + reach.x0, x1 = double(f.x) + reach.x1,
                         y0 = double(f.y) + reach.y0, y1 = double(f.y) + reach.y1;
            if (!(x1 >= double(part_.lower.x) && x0 <= double(part_.upper.x) && y1 >= double(part_.lower.y) &&
                  y0 <= double(part_.upper.y)))
              continue;
            const auto tile = [](double at, int corner, int tiles) {
              return int(std::clamp(std::floor((at - corner) / kTile), 0., double(tiles - 1)));
            };
            found.ranges.push_back({tile(x0, left_, columns_), tile(y0, top_, rows_),
                                    tile(x1, left_, columns_), tile(y1, top_, rows_)});
            projector.set_color(i, f);
            found.footprints.push_back(f);
            found.depths.push_back(depth);
          }
        }
      },
      1);
}

void ProjectedSplats::list_by_tiles(const UnfilledVector<TileRange>& ranges) {
  const std::size_t n = ranges.size(), tiles = std::size_t(columns_) * std::size_t(rows_);
  const std::size_t parts = std::clamp<std::size_t>(n >> 13, 1, 16), length = (n + parts - 1) / parts;
  std::vector<std::vector<std::size_t>> next(parts, std::vector<std::size_t>(tiles, 0));
  const auto for_entries = [&](const auto& visit) {
    for_ranges(
        parts,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p)
            for (std::size_t i = std::min(n, p * length); i < std::min(n, (p + 1) * length); ++i)
              for (int y = ranges[i].y0; y <= ranges[i].y1; ++y)
                for (int x = ranges[i].x0; x <= ranges[i].x1; ++x)
                  visit(next[p][std::size_t(y) * std::size_t(columns_) + std::size_t(x)], i);
        },
        1);
  };
  for_entries([](std::size_t& count, std::size_t) { ++count; });
  first_.assign(tiles + 1, 0);
  std::size_t sum = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    first_[t] = sum;
    for (auto& counts : next) {
      const std::size_t here = counts[t];
      counts[t] = sum;
      sum += here;
    }
  }
  first_[tiles] = sum;
  entries_.resize(sum);
  for_entries([&](std::size_t& at, std::size_t i) { entries_[at++] = std::uint32_t(i); });
}

int ProjectedSplats::tile_of(Vec2 film) const {
  const int x = std::clamp(int(std::floor((film.x - float(left_)) / kTile)), 0, columns_ - 1),
            y = std::clamp(int(std::floor((film.y - float(top_)) / kTile)), 0, rows_ - 1);
  return y * columns_ + x;
}

}  // namespace aureole
