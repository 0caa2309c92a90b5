// SPDX-License-Identifier: Apache-2.0
// Evaluates pictures in photometric units: statistics, uniformity, false colours, glare and daylight factors.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/report/false_color.h"
#include "aureole/optics/photometry/glare.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// One channel of a picture with its unit.
struct PhotometricMap {
  int width = 0, height = 0;
  std::vector<double> values;  ///< values row by row from the top
  std::string quantity, unit;  ///< quantity and unit, such as "illuminance" and "lx"
  /// Areas of the cells on a shape, by which means are weighted, in any unit; empty: equal areas.
  std::vector<double> areas = {};

  double at(int x, int y) const { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// Takes a photometric or radiometric channel from a picture whose header says its unit (`aureole:channels`). Throws
/// Error, which `name` begins, if no channel has a unit.
PhotometricMap photometric_map(const Image& picture, const std::string& channels_attribute,
                               const std::string& name);

/// Throws Error unless a map holds the photopic illuminance on a surface, of which a daylight factor is made: the illuminance on a
/// sphere or a cylinder over that of the open ground is another quantity, which may exceed 100 % in the open.
void require_daylight_map(const std::string& quantity, const std::string& unit);

/// Whether a channel of the header has a unit that `photometric_map` knows.
bool has_photometric_unit(const std::string& channels_attribute);

/// Whether values of the cells add up: units of power and energy, such as "lm" and "J".
bool is_unit_of_flux(const std::string& unit);

/// A part of a map, in cells.
struct MapRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The position on a film of the upper left corner of a picture of its crop, or of the whole film [pixels]. Throws Error for a
/// picture of another size.
std::array<int, 2> place_on_film(const Film& film, int width, int height);

/// The areas of the cells of a power map on a shape, for a map of its film or of the film's crop; empty for other sensors.
std::vector<double> cell_areas(const PlacedSensor& sensor, int width, int height);

/// Statistics over a region, of the finite values of its cells; those without area are left out.
struct MapStatistics {
  std::size_t count = 0;
  double sum = 0;                                 ///< of power or energy: that through the region
  double mean = 0, min = 0, max = 0, median = 0;  ///< mean and median weighted by the areas of the cells
  double uniformity() const {
    return mean > 0 ? min / mean : 0;
  }  ///< uniformity U_0 = E_min/E_mean (EN 12464-1)
  double diversity() const { return max > 0 ? min / max : 0; }  ///< diversity U_d = E_min/E_max
};
/// Throws Error if the region leaves the map or has no finite values.
MapStatistics map_statistics(const PhotometricMap& map, const MapRegion& region);

/// A scale for a map: linear, or with `logarithmic` over decades. Lines are drawn at the values `isolines`; empty: those of
/// the labels. Throws Error for limits that do not increase.
ColorScale map_scale(const PhotometricMap& map, std::optional<double> min, std::optional<double> max,
                     bool logarithmic, std::vector<double> isolines);

/// A source of glare in a picture.
struct PictureGlareSource {
  optics::GlareSource source;
  double x = 0, y = 0;  ///< centre of the source in pixels
  std::size_t pixels = 0;
};
/// Glare of a picture in cd/m^2 that a camera of the scene has taken.
struct PictureGlare {
  double threshold = 0;  ///< luminance from which pixels belong to sources [cd/m^2]
  /// mean luminance of the other pixels, weighted by their projected solid angle [cd/m^2]
  double background = 0;
  double solid_angle = 0;                   ///< solid angle of the picture in front of the observer [sr]
  double rating = 0;                        ///< UGR; -infinity without sources
  std::vector<PictureGlareSource> sources;  ///< sources, the largest contribution first
  std::size_t outside = 0;                  ///< number of sources smaller or larger than CIE 117 allows
};
/// Evaluates the glare of a picture. The line of sight goes through the middle of the film, of which the picture may be a crop,
/// and `up` [world] points upwards. Sources are connected pixels of at least `threshold`; 0: five times the mean.
/// Throws Error.
PictureGlare picture_glare(const PhotometricMap& map, const PlacedSensor& camera, const Vec3& up,
                           double threshold);

/// Illuminance [lx] of the open ground with the normal `up` by all emitters at infinity, through the photopic response.
double open_illuminance(const Scene& scene, const Vec3& up);

}  // namespace aureole
