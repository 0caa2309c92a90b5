// SPDX-License-Identifier: Apache-2.0
// Discomfort glare: the unified glare rating, and the luminance to which the eye adapts at dusk.
#pragma once

#include <span>

namespace aureole::optics {

/// A glare source from the position of an observer.
struct GlareSource {
  double luminance = 0;    ///< luminance [cd/m^2]
  double solid_angle = 0;  ///< solid angle [sr]
  double position = 1;     ///< position index of Guth, 1 along the line of sight
};

/// The unified glare rating, UGR = 8 lg((0.25/L_b) sum L^2 omega/p^2) (CIE 117-1995, equation 1). `background` is the
/// luminance of the background [cd/m^2], the vertical illuminance at the eye without the sources over pi. It is -infinity
/// without sources. Throws std::domain_error for a background that is not positive and for negative values.
double unified_glare_rating(double background, std::span<const GlareSource> sources);

/// The range of solid angles [sr] for which CIE 117 gives the rating; CIE 190-2010 treats the same range.
inline constexpr double kSmallestGlareSource = 3e-4, kLargestGlareSource = 0.1;

/// The position index of a source (M. Luckiesh and S. K. Guth, "Brightness in visual field at borderline between comfort
/// and discomfort", 1949; as a formula in the IES Lighting Handbook, 1984). `elevation` and `to_the_side` are the angles
/// [rad] of its direction above the line of sight and beside it; for directions below (negative elevation)
/// the formula of T. Iwata and M. Tokura (1997) holds. The index is at most 16, its value at the edge of the
/// field of vision.
double position_index(double elevation, double to_the_side);

/// Mesopic luminance [cd/m^2] by photopic luminance [cd/m^2] and the ratio of scotopic to photopic luminance, and its
/// coefficient m (CIE 191:2010, MES2): L_mes = (m L_p + (1 - m) L_s V'(555 nm))/(m + (1 - m) V'(555 nm)), V' = 683/1699,
/// m = 0.7670 + 0.3334 lg(L_mes) within [0, 1].
struct MesopicLuminance {
  double luminance = 0, m = 0;
};
MesopicLuminance mesopic_luminance(double photopic, double scotopic_to_photopic);

}  // namespace aureole::optics
