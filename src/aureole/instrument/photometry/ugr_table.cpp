// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/ugr_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/optics/photometry/box_radiosity.h"
#include "aureole/optics/photometry/glare.h"

namespace aureole {

namespace {

using optics::BoxRadiosity;
using optics::BoxSurface;
using optics::LuminaireVector;

constexpr double kHeight = 2;        ///< height H of the luminaires above the eye [m]
constexpr double kSteepest = 85;     ///< largest gamma of a luminaire that counts [degrees] (CIE 117, 4.5)
constexpr double kMostSideways = 3;  ///< largest T/R of a luminaire that counts (CIE 117, 4.5)
constexpr double kMostIndex = 16;    ///< position index at the edge of the field of vision

/// A direction in the room: across the line of sight to the right, along it, and down.
struct RoomVector {
  double across = 0, along = 0, down = 0;
};

/// Turns directions of a room into those of its luminaires. The local axes are x along the luminaire, z down; C = 0 of
/// EULUMDAT is -y, and C = 90 is -x.
LuminaireVector to_luminaire(const RoomVector& v, int view) {
  return view == 0 ? LuminaireVector{-v.across, v.along, v.down} : LuminaireVector{v.along, v.across, v.down};
}
RoomVector to_room(const LuminaireVector& v, int view) {
  return view == 0 ? RoomVector{-v[0], v[1], v[2]} : RoomVector{v[1], v[0], v[2]};
}

/// The flux of the luminaire in a bundle of directions [lm].
struct FluxBundle {
  LuminaireVector direction;
  double flux = 0;
};

/// Bundles of equal steps of both angles. The flux in each step of gamma is the exact integral, so that no narrow beam is lost.
std::vector<FluxBundle> flux_bundles(const optics::IntensityDistribution& d, int azimuths, int polar_angles) {
  std::vector<FluxBundle> bundles;
  std::vector<double> candela(std::size_t(azimuths), 0.0);
  for (int j = 0; j < polar_angles; ++j) {
    const double step = 180.0 / polar_angles, gamma = (j + 0.5) * step;
    const double flux = d.flux(j * step, (j + 1) * step);
    if (!(flux > 0)) continue;
    const auto azimuth = [&](std::size_t i) { return 360 * (double(i) + 0.5) / azimuths; };
    double sum = 0;
    for (std::size_t i = 0; i < candela.size(); ++i) sum += candela[i] = d.at(azimuth(i), gamma);
    for (std::size_t i = 0; i < candela.size(); ++i) {
      const double part = sum > 0 ? candela[i] / sum : 1.0 / azimuths;
      if (part > 0) bundles.push_back({d.direction(azimuth(i), gamma), flux * part});
    }
  }
  return bundles;
}

/// A row of luminaires along one side of a room, at half of the spacing from both walls.
struct LuminaireRow {
  double length, spacing;  ///< [m]

  int count() const { return std::max(1, int(std::lround(length / spacing))); }
  double position(int i) const { return (i + 0.5) * spacing; }
  /// The fraction of the row whose rays still lie in the room after a displacement.
  double inside(double displacement) const {
    const double n = count();
    return std::clamp(std::floor((length - std::abs(displacement)) / spacing + 0.5), 0.0, n) / n;
  }
};

struct StandardRoom {
  LuminaireRow across, along;

  StandardRoom(const UgrRoom& room, double spacing)
      : across{kHeight * room.x, kHeight * spacing}, along{kHeight * room.y, kHeight * spacing} {}
  int luminaires() const { return across.count() * along.count(); }
  double wall_area() const { return 2 * kHeight * (across.length + along.length); }
};

/// The mean direct flux of a luminaire of the room on the three zones of BoxRadiosity::of_surfaces [lm].
std::vector<double> direct_by_surface(const std::vector<FluxBundle>& bundles, const StandardRoom& room,
                                      int view) {
  double floor = 0, down = 0, up = 0;
  for (const FluxBundle& b : bundles) {
    const RoomVector v = to_room(b.direction, view);
    if (v.down <= 0) {
      up += b.flux;
      continue;
    }
    const double reach = kHeight / v.down;
    down += b.flux;
    floor += b.flux * room.across.inside(reach * v.across) * room.along.inside(reach * v.along);
  }
  return {floor, up, down - floor};
}

/// The index of the patch of `count` equal ones that contains x in [0, length].
std::size_t part_at(double x, double length, std::size_t count) {
  return std::min(count - 1, std::size_t(std::max(0.0, x / length * double(count))));
}

/// As `direct_by_surface`, on the patches of a box with `parts` patches along each axis.
std::vector<double> direct_by_patch(const std::vector<FluxBundle>& bundles, const StandardRoom& room,
                                    int view, const std::array<std::size_t, 3>& parts) {
  const double x_size = room.across.length, y_size = room.along.length;
  const std::size_t plane = parts[0] * parts[1], x_wall = parts[1] * parts[2], y_wall = parts[0] * parts[2];
  std::vector<double> flux(2 * (plane + x_wall + y_wall));
  for (int i = 0; i < room.across.count(); ++i)
    for (int j = 0; j < room.along.count(); ++j) {
      const double x = room.across.position(i), y = room.along.position(j);
      for (const FluxBundle& b : bundles) {
        const RoomVector v = to_room(b.direction, view);
        // The upper plane is that of the luminaires, so that upward light falls on it where they are.
        if (v.down <= 0) {
          flux[plane + part_at(x, x_size, parts[0]) * parts[1] + part_at(y, y_size, parts[1])] += b.flux;
          continue;
        }
        const auto to_wall = [](double at, double size, double step) {
          return step > 0   ? (size - at) / step
                 : step < 0 ? -at / step
                            : std::numeric_limits<double>::infinity();
        };
        const double tx = to_wall(x, x_size, v.across), ty = to_wall(y, y_size, v.along),
                     tz = kHeight / v.down, t = std::min({tx, ty, tz});
        const std::size_t px = part_at(x + t * v.across, x_size, parts[0]),
                          py = part_at(y + t * v.along, y_size, parts[1]),
                          pz = part_at(kHeight - t * v.down, kHeight, parts[2]);
        std::size_t zone = px * parts[1] + py;
        if (t < tz && tx <= ty)
          zone = 2 * plane + (v.across > 0 ? x_wall : 0) + py * parts[2] + pz;
        else if (t < tz)
          zone = 2 * (plane + x_wall) + (v.along > 0 ? y_wall : 0) + px * parts[2] + pz;
        flux[zone] += b.flux;
      }
    }
  for (double& f : flux) f /= room.luminaires();
  return flux;
}

/// A luminaire as the source of the light of rooms.
class RoomLight {
public:
  RoomLight(const Luminaire& luminaire, const UgrOptions& options)
      : options_(options),
        has_patches_(options.background == UgrOptions::Background::patches),
        bundles_(has_patches_ ? flux_bundles(luminaire.distribution, 72, 90)
                              : flux_bundles(luminaire.distribution, 144, 360)) {}

  /// Mean indirect illuminance of the walls over pi [cd/m^2] for all sets of reflectances, crosswise and endwise.
  std::array<std::array<double, 5>, 2> backgrounds(const UgrRoom& size) const {
    const StandardRoom room(size, options_.spacing);
    const double x = room.across.length, y = room.along.length, patch = options_.patch * kHeight;
    const BoxRadiosity box = has_patches_ ? BoxRadiosity::of_patches(x, y, kHeight, patch)
                                          : BoxRadiosity::of_surfaces(x, y, kHeight);
    std::array<std::array<double, 5>, 2> result{};
    for (std::size_t view = 0; view < 2; ++view) {
      const std::vector<double> direct = has_patches_
                                             ? direct_by_patch(bundles_, room, int(view), box.parts())
                                             : direct_by_surface(bundles_, room, int(view));
      for (std::size_t k = 0; k < kUgrReflectances.size(); ++k) {
        const UgrReflectances& rho = kUgrReflectances[k];
        const std::vector<double> flux = box.incident(direct, {rho.plane, rho.ceiling, rho.walls});
        double indirect = 0;
        for (std::size_t i = 0; i < flux.size(); ++i)
          if (box.surface(i) == BoxSurface::wall) indirect += flux[i] - direct[i];
        result[view][k] = room.luminaires() * indirect / room.wall_area() / M_PI;
      }
    }
    return result;
  }

private:
  UgrOptions options_;
  bool has_patches_;
  std::vector<FluxBundle> bundles_;
};

/// The sum L^2 omega/p^2 [cd^2 sr/m^4] of the luminaires before an observer, and the part of it by sources that are smaller or
/// larger than the rating is made for.
struct GlareSum {
  double sum = 0, outside = 0;

  /// Adds a luminaire across and along the line of sight [m].
  void add(const Luminaire& luminaire, double across, double along, int view) {
    const double square = across * across + along * along + kHeight * kHeight, distance = std::sqrt(square);
    if (!(along > 0) || std::abs(across) > kMostSideways * along ||
        kHeight < distance * std::cos(kSteepest * M_PI / 180))
      return;
    const double p = optics::position_index(std::atan2(kHeight, std::hypot(across, along)),
                                            std::atan2(std::abs(across), along));
    if (p >= kMostIndex) return;
    const LuminaireVector to_eye =
        to_luminaire({-across / distance, -along / distance, kHeight / distance}, view);
    const double candela = luminaire.distribution.intensity(to_eye);
    if (!(candela > 0)) return;
    const double area = projected_area(luminaire.opening, to_eye);
    if (!(area > 0))
      throw Error(
          "the luminous opening has no area towards an observer below it, so that the luminance is unknown: state it by --opening");
    const double part = candela * candela / (area * square * p * p), angle = area / square;
    sum += part;
    if (angle < optics::kSmallestGlareSource || angle > optics::kLargestGlareSource) outside += part;
  }
};

double rating_of(double background, double sum) {
  return sum > 0 ? 8 * std::log10(0.25 / background * sum) : -std::numeric_limits<double>::infinity();
}

/// Ratings from 16 x 16 positions of the observer within a cell of the grid of luminaires: the lowest and the highest.
std::array<double, 2> ratings_within_a_cell(const Luminaire& luminaire, const UgrRoom& room, double spacing,
                                            double background_per_density, int view) {
  constexpr int kSteps = 16;
  const double s = spacing * kHeight, x_size = room.x * kHeight, y_size = room.y * kHeight;
  std::array<double, 2> range{std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity()};
  for (int a = 0; a < kSteps; ++a)
    for (int b = 0; b < kSteps; ++b) {
      GlareSum glare;
      const double u = (a + 0.5) / kSteps, v = (b + 0.5) / kSteps;
      const int reach = int(std::ceil(0.5 * x_size / s)) + 1;
      for (int i = -reach; i <= reach; ++i)
        for (int j = 0; (j + v) * s <= y_size; ++j)
          if (std::abs((i + u) * s) <= 0.5 * x_size) glare.add(luminaire, (i + u) * s, (j + v) * s, view);
      const double rating = rating_of(background_per_density / (s * s), glare.sum);
      range[0] = std::min(range[0], rating), range[1] = std::max(range[1], rating);
    }
  return range;
}

/// The largest difference of intensities whose directions mirror each other about both planes, over the largest intensity.
double asymmetry_of(const optics::IntensityDistribution& d) {
  double difference = 0;
  if (d.is_rotational()) return 0;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j <= 36; ++j) {
      LuminaireVector v = d.direction(15 * i, 2.5 * j);
      const double cd = d.intensity(v);
      for (const std::size_t axis : {0, 1}) {
        v[axis] = -v[axis];
        difference = std::max(difference, std::abs(d.intensity(v) - cd));
        v[axis] = -v[axis];
      }
    }
  return difference / d.maximum();
}

}  // namespace

double UgrTable::correction() const { return 8 * std::log10(flux / 1000); }

std::string ugr_column(int view, std::size_t reflectances) {
  const UgrReflectances& r = kUgrReflectances[reflectances];
  return fmt::format("{}_{:.0f}_{:.0f}_{:.0f}", view == 0 ? "crosswise" : "endwise", 100 * r.ceiling,
                     100 * r.walls, 100 * r.plane);
}

std::array<double, 5> ugr_backgrounds(const Luminaire& luminaire, const UgrRoom& room, int view,
                                      const UgrOptions& options) {
  return RoomLight(luminaire, options).backgrounds(room)[std::size_t(view)];
}

void require_ugr_spacing(double spacing) {
  const double per_height = 1 / spacing;
  if (!(spacing > 0 && per_height >= 1 - 1e-9 && per_height <= 20 + 1e-9 &&
        std::abs(per_height - std::round(per_height)) < 1e-6))
    throw Error(fmt::format(
        "--spacing {:g}: 1 over it must be a whole number from 1 to 20, so that luminaires fill all rooms",
        spacing));
}

void require_luminous_area(const std::array<double, 3>& size_m) {
  if (!(projected_area({.size_m = size_m}, {1, 1, 1}) > 0))
    throw Error(fmt::format("--opening {:g} {:g} {:g}: has no area, by which the luminance is reckoned",
                            size_m[0], size_m[1], size_m[2]));
}

UgrTable ugr_table(const Luminaire& luminaire, const UgrOptions& options) {
  if (luminaire.type != optics::PhotometricType::c)
    throw Error("a table of UGR is that of a luminaire of type C, which hangs in a room");
  if (luminaire.opening.is_point())
    throw Error(
        "the luminaire has no luminous area, by which its luminance is reckoned: state it by --opening");
  require_ugr_spacing(options.spacing);
  UgrTable table;
  table.spacing = options.spacing;
  const double flux = luminaire.distribution.flux();
  if (!(flux > 0)) throw Error("the luminaire emits no light");
  table.is_of_lamps = luminaire.lamp_flux() > 0;
  table.flux = table.is_of_lamps ? luminaire.lamp_flux() : flux;

  const RoomLight light(luminaire, options);
  constexpr std::size_t kReferenceRoom = 10;
  GlareSum reference[2];
  for (std::size_t r = 0; r < kUgrRooms.size(); ++r) {
    if (options.between) options.between();
    const StandardRoom room(kUgrRooms[r], options.spacing);
    const auto backgrounds = light.backgrounds(kUgrRooms[r]);
    for (std::size_t view = 0; view < 2; ++view) {
      GlareSum glare;
      for (int i = 0; i < room.across.count(); ++i)
        for (int j = 0; j < room.along.count(); ++j)
          glare.add(luminaire, room.across.position(i) - 0.5 * room.across.length, room.along.position(j),
                    int(view));
      if (r == kReferenceRoom) reference[view] = glare;
      table.background[view][r] = backgrounds[view];
      for (std::size_t k = 0; k < kUgrReflectances.size(); ++k)
        table.rating[view][r][k] = rating_of(backgrounds[view][k], glare.sum);
    }
  }

  const std::array<double, 3> spacings{1, 1.5, 2};
  const UgrRoom& room = kUgrRooms[kReferenceRoom];
  for (std::size_t i = 0; i < spacings.size(); ++i) {
    table.variations[i].spacing = spacings[i];
    for (std::size_t view = 0; view < 2; ++view) {
      const double s = options.spacing * kHeight, rating = table.rating[view][kReferenceRoom][0];
      const auto range = ratings_within_a_cell(luminaire, room, spacings[i],
                                               table.background[view][kReferenceRoom][0] * s * s, int(view));
      for (std::size_t end = 0; end < 2; ++end)
        table.variations[i].difference[view][end] = range[end] - rating;
    }
  }

  constexpr double kSymmetric = 0.02, kShareOutside = 0.05;
  if (const double difference = asymmetry_of(luminaire.distribution); difference > kSymmetric)
    table.notes.push_back(fmt::format(
        "intensities differ by up to {:.0f} % of the largest about C 0-180 or C 90-270: the table holds for "
        "observers whom the half-plane C = 0 of EULUMDAT faces crosswise, and C = 90 endwise",
        100 * difference));
  const auto share = [&](std::size_t view) {
    return reference[view].sum > 0 ? reference[view].outside / reference[view].sum : 0;
  };
  if (std::max(share(0), share(1)) > kShareOutside)
    table.notes.push_back(fmt::format(
        "{:.0f} % (crosswise) and {:.0f} % (endwise) of the glare in the room of 4 H by 8 H comes from luminaires that "
        "look smaller than 0.0003 sr or larger than 0.1 sr, for which UGR is not meant",
        100 * share(0), 100 * share(1)));
  return table;
}

}  // namespace aureole
