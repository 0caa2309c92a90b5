// SPDX-License-Identifier: Apache-2.0
// Tables of the unified glare rating (UGR) of a luminaire in standard rooms: CIE 117-1995 and CIE 190:2010.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "aureole/parameter/luminaire/luminaire_file.h"

namespace aureole {

/// A standard room in units of the height H of the luminaires above the eye: x across the line of sight, y along it.
struct UgrRoom {
  double x = 0, y = 0;
};
inline constexpr std::array<UgrRoom, 19> kUgrRooms{{{2, 2},
                                                    {2, 3},
                                                    {2, 4},
                                                    {2, 6},
                                                    {2, 8},
                                                    {2, 12},
                                                    {4, 2},
                                                    {4, 3},
                                                    {4, 4},
                                                    {4, 6},
                                                    {4, 8},
                                                    {4, 12},
                                                    {8, 4},
                                                    {8, 6},
                                                    {8, 8},
                                                    {8, 12},
                                                    {12, 4},
                                                    {12, 6},
                                                    {12, 8}}};

/// Reflectances of the ceiling (the plane of the luminaires), the walls, and the plane at the height of the eye.
struct UgrReflectances {
  double ceiling = 0, walls = 0, plane = 0;
};
inline constexpr std::array<UgrReflectances, 5> kUgrReflectances{
    {{0.7, 0.5, 0.2}, {0.7, 0.3, 0.2}, {0.5, 0.5, 0.2}, {0.5, 0.3, 0.2}, {0.3, 0.3, 0.2}}};

struct UgrOptions {
  double spacing =
      0.25;  ///< distance of neighbouring luminaires in units of H; 1 in the tables of CIE 190:2010
  /// The background luminance is the mean indirect illuminance of the walls over pi. `uniform`: floor, ceiling and all walls
  /// together each reflect evenly, as CIE 190 assumes; `patches`: patches with sides up to `patch` (in units of H) do.
  enum class Background { uniform, patches } background = Background::uniform;
  double patch = 0.5;
  std::function<void()> between{};  ///< called for each room; may throw
};

/// How the rating changes with the position of the observer among luminaires that are farther apart.
struct UgrVariation {
  double spacing = 0;  ///< [H]
  /// lowest and highest rating less that of the table, crosswise and endwise
  std::array<std::array<double, 2>, 2> difference{};
};

struct UgrTable {
  double spacing = 0;  ///< [H]
  double flux =
      0;  ///< luminous flux for which the ratings hold [lm]: of the lamps, or of the luminaire in absolute photometry
  bool is_of_lamps = false;   ///< whether it is the flux of the lamps
  double correction() const;  ///< 8 lg(flux/1000 lm): ratings less this hold for 1000 lm
  /// By view (crosswise: across the luminaire's axis; endwise: along it), room and reflectances; -infinity where no light
  /// reaches the eye.
  std::array<std::array<std::array<double, 5>, 19>, 2> rating{};
  std::array<std::array<std::array<double, 5>, 19>, 2> background{};  ///< background luminance [cd/m^2]
  /// In the room of 4 H by 8 H with reflectances of 0.7, 0.5 and 0.2, for spacings of 1, 1.5 and 2 H.
  std::array<UgrVariation, 3> variations{};
  std::vector<std::string> notes;
};

/// Throws Error for spacings of which no whole number fills the rooms.
void require_ugr_spacing(double spacing);
/// Throws Error for the size of a luminous opening [m], along, across and high, without an area towards an observer below it.
void require_luminous_area(const std::array<double, 3>& size_m);

/// The table of a luminaire of type C that hangs with gamma = 0 downwards. Crosswise, the half-plane C = 0 of EULUMDAT faces
/// the observer, and endwise C = 90. Throws Error for luminaires without luminous area and of other types, and for spacings
/// that do not divide the rooms.
UgrTable ugr_table(const Luminaire& luminaire, const UgrOptions& options = {});

/// The background luminances [cd/m^2] of one room, crosswise (0) or endwise (1), for all sets of reflectances.
std::array<double, 5> ugr_backgrounds(const Luminaire& luminaire, const UgrRoom& room, int view,
                                      const UgrOptions& options = {});

/// The name of a column of the table, such as "crosswise_70_50_20".
std::string ugr_column(int view, std::size_t reflectances);

}  // namespace aureole
