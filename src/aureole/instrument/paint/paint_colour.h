// SPDX-License-Identifier: Apache-2.0
// Colours of paints under illuminants for the CIE observers, and target colours.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "aureole/pigment/colour_indices.h"
#include "aureole/pigment/match.h"
#include "aureole/pigment/samples.h"

namespace aureole {

/// An illuminant and the observer's field, from a name such as "D65" (2 degrees) or "A/10" (10 degrees).
struct Viewing {
  std::string illuminant;
  pigment::Field field = pigment::Field::two;
};
/// Names of illuminants are recognised in any case and returned as `illuminant_names` spells them; names of
/// files are returned unchanged.
Viewing viewing_of(const std::string& name);
/// The name with the field "2" or "10" of degrees, unless it states one itself: "A" and "10" give "A/10", while
/// "A/2" stays.
std::string viewed_at(const std::string& illuminant, const std::string& degrees);

/// The relative power of a lamp by wavelength: an illuminant of `illuminant_names`, or a file as `observe` reads it. Throws Error as
/// `observe` does.
struct LampPower {
  std::vector<double> nm, power;
};
LampPower lamp_power(const std::string& name);

/// Returns the observer under an illuminant: a name of `illuminant_names`, or a file of a measured lamp with two
/// columns, wavelength and power; followed by "/10" for the CIE 1964 observer, or by "/2" or nothing for the CIE 1931
/// observer. Throws Error if there is none, with the nearest name, and if the wavelengths do not cover the
/// visible range.
pigment::Observation observe(const std::string& illuminant, std::span<const double> nm);

/// Error of colours that were measured at few wavelengths, from CIEDE2000 differences of the 13 measured
/// paints (measured_paints.h) taken at these wavelengths only.
struct SamplingError {
  double widest_nm = 0;  ///< the widest step between neighbouring wavelengths in the visible range
  double mean = 0, largest = 0;
};
SamplingError sampling_error(const std::string& illuminant, std::span<const double> nm);
/// The error in words, or nothing where the widest step is no more than 20 nm.
std::string sampling_note(const std::string& illuminant, std::span<const double> nm);

/// Returns "#rrggbb" for tristimulus values relative to a white, which is adapted to the screen's white by
/// von Kries's rule on XYZ.
std::string screen_colour(const pigment::Xyz& xyz, const pigment::Xyz& white);

/// A colour to match, and the palette at the wavelengths at which the colour is known.
struct ColourTarget {
  pigment::MatchTarget target;
  pigment::Palette palette;
  std::string file = {};                ///< file of a measured sample
  pigment::Instrument instrument = {};  ///< instrument as the file states it
  std::vector<std::string> notes = {};  ///< assumptions made on reading the file, for the user to confirm
};

/// The mean reflectance of the samples of a name in a file of measured samples, which needs no recipes.
struct MeasuredReflectance {
  std::vector<double> nm, values;
  pigment::Instrument instrument = {};  ///< instrument as the file states it
  std::vector<std::string> notes = {};  ///< assumptions made on reading the file, for the user to confirm
  std::string repeats = {};             ///< a note that several measurements are averaged, or nothing
  /// Interpolated at other wavelengths as `pigment::interpolated` does; constant beyond the measured ones.
  std::vector<double> at(std::span<const double> wavelengths) const;
};
/// Reads the samples of a name. Throws Error if there is no sample of the name, or if there are several over
/// different substrates, which have the names of `pigment::panels_of`, such as "ochre over card".
MeasuredReflectance mean_reflectance(const std::string& file, const std::string& sample);
/// Reads the mean reflectance that "FILE#SAMPLE" names. Throws Error that begins with `option` for other texts.
MeasuredReflectance mean_reflectance_called(const std::string& text, const std::string& option);

/// Reads `text`: "#rrggbb" (sRGB, D65 and 2 degrees only), one of the sixteen colour names of HTML 4, "lab(50, 20, -10)"
/// under this illuminant's white, or "FILE#SAMPLE", the mean of the measurements of that name in a file of
/// samples. For a sample, the palette is cut to the common range of wavelengths, and the sample is interpolated at
/// the palette's wavelengths as `pigment::interpolated` does. Throws Error that begins with `option`.
ColourTarget read_colour_target(const std::string& text, const pigment::Palette& palette,
                                const std::string& illuminant, const std::string& option);

}  // namespace aureole
