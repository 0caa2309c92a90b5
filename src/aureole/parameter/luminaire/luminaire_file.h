// SPDX-License-Identifier: Apache-2.0
// Photometric data of luminaires as makers publish them: IES LM-63 (1986 to 2019) and EULUMDAT (A. W. Stockmar,
// "EULUMDAT - ein Leuchtendatenformat fuer den europaeischen Beleuchtungsplaner", Licht '90).
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/optics/photometry/intensity_distribution.h"

namespace aureole {

/// The body from which a luminaire emits, with its centre at the photometric centre.
struct LuminousOpening {
  enum class Shape { box, cylinder, ellipsoid } shape = Shape::box;
  int axis = 2;  ///< axis of a cylinder with an elliptic section: 0, 1 or 2 for x, y or z
  /// Extents along x, y and z of the luminaire [m]; a box or cylinder may be flat, and all zero is a point.
  std::array<double, 3> size_m{};

  bool is_point() const { return size_m[0] == 0 && size_m[1] == 0 && size_m[2] == 0; }
};

/// The area of an opening as seen from a direction, a vector of any length except zero [m^2].
double projected_area(const LuminousOpening& opening, const optics::LuminaireVector& direction);

/// Alternative lamps of a luminaire.
struct LampSet {
  double count = 1;  ///< number of lamps
  double flux = 0;   ///< luminous flux of all lamps together [lm]; 0: the file does not state it
  double watts = 0;  ///< electrical power with the gear [W]; 0: unknown
  std::string type{}, colour{}, rendering{};
};

/// Factors of the flux by the tilt of the lamp [degrees] (LM-63, TILT=INCLUDE).
struct LampTilt {
  int geometry = 1;  ///< lamp-to-luminaire geometry, 1 to 3
  std::vector<double> angles, factors;

  /// The factor at an angle [degrees]: linear between the angles of the table, constant outside.
  double at(double angle) const;
};

struct Luminaire {
  enum class Format { ies, eulumdat } format = Format::ies;
  std::string standard;  ///< name of the standard, such as "LM-63-2002" or "EULUMDAT"
  /// keywords of LM-63, or lines of text of EULUMDAT
  std::vector<std::pair<std::string, std::string>> keywords;
  optics::PhotometricType type = optics::PhotometricType::c;
  std::string symmetry;  ///< symmetry in words, for reports
  /// The intensities [cd] with all factors of the file except the factor of a tilt. Symmetric ones are
  /// completed. The coordinates are those of `photometric_axes`, with x along the luminaire, so that C = 0 of
  /// EULUMDAT is -y.
  optics::IntensityDistribution distribution;
  /// Numbers of horizontal and vertical angles in the file, from which `distribution` was made, for reports.
  std::size_t horizontal_count = 0, vertical_count = 0;
  LuminousOpening opening;
  std::vector<LampSet> lamps;  ///< sets of lamps; LM-63 has one
  std::size_t lamp_set = 0;    ///< index of the set of lamps to which `distribution` refers
  /// whether the intensities are absolute, so that they do not refer to the flux of lamps
  bool is_absolute = false;
  LampTilt tilt{};               ///< factors by the tilt; without angles the flux does not depend on the tilt
  double output_ratio = 0;       ///< stated light output ratio; 0: not stated
  double downward_fraction = 0;  ///< stated fraction of the flux below the horizontal; 0: not stated
  /// notes for the user on data that were not read as the file states them
  std::vector<std::string> notes{};

  /// Luminous flux of the chosen lamps [lm]; 0: unknown.
  double lamp_flux() const { return is_absolute ? 0 : lamps.at(lamp_set).flux; }
};

/// Options for reading a file.
struct LuminaireOptions {
  std::size_t lamp_set = 0;  ///< index of the set of lamps in an EULUMDAT file, from 0
  /// Flux of all lamps [lm], to which the intensities are scaled; 0: the flux in the file.
  double lamp_flux = 0;
  /// Orientation of C = 0 relative to the luminaire, for files of type C that deviate from their format.
  enum class ZeroPlane { by_format, along, across } zero_plane = ZeroPlane::by_format;
  /// Called with each further file that the file names (TILT=file).
  std::function<void(const std::filesystem::path&)> on_file{};
};

/// Reads a luminaire from a file; its content decides between the two formats. Throws Error located in the
/// file.
Luminaire read_luminaire(const std::filesystem::path& file, const LuminaireOptions& options = {});
/// Reads the text of a file of that name.
Luminaire parse_luminaire(std::string text, const std::filesystem::path& file,
                          const LuminaireOptions& options = {});

/// Returns the text of the file in LM-63-2019 or EULUMDAT for a luminaire of type C. Its table has C from 0 to 360
/// degrees, or one half-plane. Throws Error for other types, for keywords of several lines, and by EULUMDAT for a luminaire without light.
std::string ies_text(const Luminaire& luminaire);
std::string eulumdat_text(const Luminaire& luminaire);

/// Compares the integral of the intensities with the flux of the lamps and the ratios that the file states.
struct FluxBalance {
  double flux = 0;          ///< integral of the intensities [lm]
  double lamp_flux = 0;     ///< luminous flux of the lamps [lm]; 0: unknown or absolute photometry
  double output_ratio = 0;  ///< flux over lamp_flux; 0: unknown
  double stated_ratio = 0;  ///< output ratio that the file states; 0: it states none
  /// Returns one sentence with these numbers.
  std::string text() const;
};
FluxBalance flux_balance(const Luminaire& luminaire);

}  // namespace aureole
