// SPDX-License-Identifier: Apache-2.0
// Parts that the readers of LM-63 and EULUMDAT share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/parameter/luminaire/luminaire_file.h"

namespace aureole::luminaire_reader {

/// Upper bound of the size of a file: a table of 0.5 by 0.5 degrees over the sphere has 2 MB.
constexpr std::uint64_t kMaxLuminaireBytes = std::uint64_t(1) << 24;

/// A line of a file, without its end.
struct TextLine {
  std::string_view text;
  int number = 0;         ///< number of the line, from 1
  std::size_t begin = 0;  ///< position of the line's first character
};

/// Returns the line that begins with TILT=, in any case; nothing if there is none.
std::optional<TextLine> find_tilt_line(std::string_view text);

Luminaire read_ies(const std::string& text, const std::filesystem::path& file,
                   const LuminaireOptions& options);
Luminaire read_eulumdat(const std::string& text, const std::filesystem::path& file,
                        const LuminaireOptions& options);

[[nodiscard]] Error fault(const std::filesystem::path& file, int line, int column,
                          const std::string& message);

/// Intensities [cd] over the angles [degrees] of a file: a row of vertical angles for each horizontal angle.
struct MeasuredTable {
  std::vector<double> horizontal, vertical, candela;
  optics::PhotometricType type = optics::PhotometricType::c;
};
/// Converts a complete table to azimuths and polar angles.
optics::IntensityDistribution make_distribution(const MeasuredTable& table,
                                                const optics::PhotometricAxes& axes);
/// Adds to each half-plane its mirror image about the horizontal angle `about`; angles may leave [0, 360].
void mirror(MeasuredTable& table, double about);
/// Returns the half-planes [degrees] of a table rotated by `angle`, from 0 to 360; a single half-plane is
/// unchanged.
std::vector<double> turned_half_planes(const std::vector<double>& azimuths, double angle);
/// Throws Error for a keyword of several lines, which files of lines cannot hold.
void require_lines(const Luminaire& luminaire);
/// Returns the axes of a type, where C = 0 may run across the luminaire.
optics::PhotometricAxes axes_of(optics::PhotometricType type, bool zero_is_across);

}  // namespace aureole::luminaire_reader
