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
  int axis = 2;  ///< of a cylinder with an elliptic section: 0, 1 or 2 for x, y or z
  /// Extents along x, y and z of the luminaire [m]; a box or cylinder may be flat, and all zero is a point.
  std::array<double, 3> size_m{};

  bool is_point() const { return size_m[0] == 0 && size_m[1] == 0 && size_m[2] == 0; }
};

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
  std::string standard;                                       ///< "LM-63-2002", "EULUMDAT"
  std::vector<std::pair<std::string, std::string>> keywords;  ///< of LM-63, or lines of text of EULUMDAT
  optics::PhotometricType type = optics::PhotometricType::c;
  std::string symmetry;  ///< in words, for reports
  /// The intensities [cd] with all factors of the file, without that of a tilt. Symmetric ones are complete. The
  /// coordinates are those of `photometric_axes`, x along the luminaire: C = 0 of EULUMDAT is -y there.
  optics::IntensityDistribution distribution;
  /// The rows behind `distribution` as the file has them, for reports: number of horizontal and vertical angles.
  std::size_t horizontal_count = 0, vertical_count = 0;
  LuminousOpening opening;
  std::vector<LampSet> lamps;        ///< LM-63 has one
  std::size_t lamp_set = 0;          ///< the set for which `distribution` holds
  bool is_absolute = false;          ///< the intensities do not refer to the flux of lamps
  LampTilt tilt{};                   ///< no angles: the flux does not depend on it
  double output_ratio = 0;           ///< stated light output ratio; 0: not stated
  double downward_fraction = 0;      ///< stated fraction of the flux below the horizontal; 0: not stated
  std::vector<std::string> notes{};  ///< what was read otherwise than the file says, for the user

  /// Luminous flux of the chosen lamps [lm]; 0: unknown.
  double lamp_flux() const { return is_absolute ? 0 : lamps.at(lamp_set).flux; }
};

/// How a file is read.
struct LuminaireOptions {
  std::size_t lamp_set = 0;  ///< of EULUMDAT, from 0
  /// Flux of all lamps [lm], to which the intensities are scaled; 0: the one of the file.
  double lamp_flux = 0;
  /// Which direction of the luminaire has C = 0, for files of type C that deviate from their format.
  enum class ZeroPlane { by_format, along, across } zero_plane = ZeroPlane::by_format;
  /// Called with each further file that the file names (TILT=file).
  std::function<void(const std::filesystem::path&)> on_file{};
};

/// Reads a file of either format, which its content decides. Throws Error located in the file.
Luminaire read_luminaire(const std::filesystem::path& file, const LuminaireOptions& options = {});
/// Reads the text of a file of that name.
Luminaire parse_luminaire(std::string text, const std::filesystem::path& file,
                          const LuminaireOptions& options = {});

/// Returns the text of the file in LM-63-2019 or EULUMDAT for a luminaire of type C. Its table has C from 0 to 360
/// degrees, or one half-plane. EULUMDAT needs equal rows of angles from 0 to 180 degrees. Throws Error.
std::string ies_text(const Luminaire& luminaire);
std::string eulumdat_text(const Luminaire& luminaire);

/// Compares the integral of the intensities with the flux of the lamps and the ratios that the file states.
struct FluxBalance {
  double flux = 0;          ///< integral of the intensities [lm]
  double lamp_flux = 0;     ///< of the lamps [lm]; 0: unknown or absolute photometry
  double output_ratio = 0;  ///< flux over lamp_flux; 0: unknown
  double stated_ratio = 0;  ///< 0: the file states none
  /// One sentence with these numbers.
  std::string text() const;
};
FluxBalance flux_balance(const Luminaire& luminaire);

}  // namespace aureole
