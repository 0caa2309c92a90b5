// SPDX-License-Identifier: Apache-2.0
// `ConstantTexture`: one spectrum everywhere, with helpers of the spectrum plug-ins that make it.
#pragma once

#include <string>
#include <vector>

#include "aureole/texture/texture.h"

namespace aureole {

class ConstantTexture : public Texture {
public:
  ConstantTexture(const Properties& properties, SampledSpectrum spectrum);

  Spectrum eval(const SurfacePoint&, const Wavelengths& w) const final {
    return flat_ ? Spectrum(value_) : spectrum_.eval(w);
  }
  float eval_scalar(const SurfacePoint&) const final { return scalar_; }
  Vec2 gradient(const SurfacePoint&) const final { return {}; }
  SampledSpectrum average(const Shape*) const final { return spectrum_; }
  bool is_constant() const final { return true; }
  float maximum() const final { return spectrum_.maximum(); }
  float minimum() const final { return spectrum_.minimum(); }

private:
  SampledSpectrum spectrum_;
  bool flat_ = false;
  float value_ = 0, scalar_ = 0;
};

/// Points of a spectrum: increasing wavelengths, at least two, and as many values.
struct SpectrumPoints {
  std::vector<double> nm, values;
};

/// A spectrum given by points. It is zero outside its points unless its role continues it (`ends_of`).
class PointSpectrum : public ConstantTexture {
public:
  PointSpectrum(const Properties& properties, SpectrumPoints points, SpectrumEnds ends = SpectrumEnds::zero);

  void note_ends(const Properties& user, std::string_view name) const final;
  TexturePtr in_role(SpectrumRole role) const final;
  /// Whether its points have wavelengths in common with the film.
  bool reaches_film() const;

private:
  SpectrumPoints points_;
  SpectrumEnds ends_;
};

/// Throws Error if wavelengths without a unit, which are read as nm, all lie outside the film's range, but
/// would lie within it in um, angstrom or m.
void check_unit(const Properties& properties, std::string_view name, double first_nm, double last_nm);

/// The spectrum of a linear sRGB colour, not multiplied by an illuminant. A colour in [0, 1] is the
/// reflectance of that colour. A brighter colour, or any colour with `emission`, is scaled to a largest
/// component of 1/2 for the upsampling, and its spectrum is scaled back, as in Mitsuba.
SampledSpectrum spectrum_of_rgb(const SpectralGrid& grid, const double rgb[3], bool emission);

/// Returns the colour given as `<rgb>` under `name`; without `unbounded`, components above one are errors.
SpectrumLiteral get_rgb(const Properties& properties, std::string_view name, bool unbounded);

/// Returns the numbers in a string such as "0.1, 0.2 0.3" under `name`: at least two, none negative.
std::vector<double> get_numbers(const Properties& properties, std::string_view name);

}  // namespace aureole
