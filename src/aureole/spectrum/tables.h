// SPDX-License-Identifier: Apache-2.0
// Tabulated colorimetric data of the CIE: the 1931 and 1964 observers and the illuminants, in double precision, with
// wavelengths in nm.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aureole {

/// A piecewise linear spectrum, zero outside its table. It does not own its numbers. The wavelengths
/// increase.
struct TabulatedSpectrum {
  std::span<const double> wavelengths_nm;
  std::span<const double> values;

  double at(double lambda_nm) const;
};

/// Colour matching functions at start_nm + i step_nm, i = 0 ... size - 1.
struct Observer {
  double start_nm, step_nm;
  std::span<const double> x, y, z;
};

/// The CIE 1931 2-degree standard observer, 360-830 nm in steps of 1 nm (CIE 018:2019; ISO/CIE 11664-1).
const Observer& cie_1931_observer();

/// The CIE 1964 10-degree standard observer, 360-830 nm in steps of 1 nm (CIE 15:2004, table T.5; ISO/CIE
/// 11664-1). Colours of surfaces that are viewed at more than 4 degrees are stated for it.
const Observer& cie_1964_observer();

/// The integral of y-bar over wavelength, trapezoidal over the 1 nm table: 106.856915 nm.
double cie_y_integral();

/// Returns the integrals of the spectrum times x-bar, y-bar, z-bar, in the spectrum's unit times nm, by the
/// trapezoidal rule over the observer's 1 nm table. They are not normalised: divide by `cie_y_integral()`, or
/// multiply by 683.002 lm/W for photometric units.
std::array<double, 3> cie_tristimulus(const TabulatedSpectrum& spectrum);

/// Returns the CIE illuminant `name`, or nothing if there is none. Case is ignored; F1 ... F12 and F3.1 ...
/// F3.15 mean FL1 and so on. Values are the published relative ones every 5 nm, with different scales: A and
/// the D series are 100 at 560 nm, the fluorescent lamps are not. Ranges: A and the D series 300-830 nm, E
/// 360-830 nm, the others up to 780 nm. Sources of the tables, CIE 15:2004 and CIE 015:2018, are given in
/// data/illuminants.inc.
std::optional<TabulatedSpectrum> find_illuminant(std::string_view name);

/// All names that `find_illuminant` accepts, without aliases, in a fixed order.
std::vector<std::string> illuminant_names();

/// The factor that scales the D65 of `find_illuminant` to a luminance of one: integral of y-bar / integral of
/// (D65 y-bar), 1/98.890. An emitter of linear sRGB (1, 1, 1) times this D65 is then the white (1, 1, 1) of a
/// sensor whose Y is divided by `cie_y_integral()`. Mitsuba 3 scales its `d65` spectrum likewise, but takes
/// the integral of y-bar as 106.7503 nm in both places, so that its factor is 1/98.997. Pictures of such
/// emitters agree; spectra given in absolute numbers come out 0.1 % brighter in Mitsuba.
double d65_whitepoint_normalization();

}  // namespace aureole
