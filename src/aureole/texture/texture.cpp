// SPDX-License-Identifier: Apache-2.0
#include "aureole/texture/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "aureole/core/units.h"
#include "aureole/parameter/data_range.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/upsampling_fit.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {

namespace {

/// Tolerance of bounds for rounding errors of tabulation and of image formats.
constexpr float kTolerance = 1e-5f;

void check_number(const Properties& properties, std::string_view name, double v, SpectrumRole role) {
  if (!std::isfinite(v)) throw properties.error(name, "must be finite");
  if (v > kLargestSpectrumValue)
    throw properties.error(name, "is too large to be computed with: 1e37 is the most");
  if (v < 0) throw properties.error(name, "must not be negative, got " + shown_number(v));
  if (role == SpectrumRole::reflectance && v > 1)
    throw properties.error(name, "a reflectance or transmittance lies in [0, 1], got " + shown_number(v));
}

/// Clamps values that miss the limits of their role by rounding, with a note, and checks all values.
void check_numbers(const Properties& properties, std::string_view name, std::span<double> values,
                   SpectrumRole role) {
  const bool bounded = role == SpectrumRole::reflectance;
  double largest = 0;
  for (const double v : values)
    if (std::isfinite(v)) largest = std::max(largest, v);
  NoiseClamp clamp(0, bounded ? 1 : kLargestSpectrumValue, bounded || values.size() == 1 ? 1 : largest);
  for (double& v : values) check_number(properties, name, v = clamp(v), role);
  if (clamp.any()) properties.note(name, "parameter \"" + std::string(name) + "\": " + clamp.note());
}

/// Returns the properties of a spectrum that is not an object of the scene: the location of its parameter.
Properties spectrum_properties(const Properties& owner, std::string_view name) {
  SourceLocation where = owner.where();
  for (const Properties::Entry& e : owner.entries())
    if (e.name == name) where = e.where;
  return {"spectrum", "", where, owner.shared_context()};
}

TexturePtr make_constant(const Properties& owner, std::string_view name, SampledSpectrum spectrum) {
  return std::make_shared<ConstantTexture>(spectrum_properties(owner, name), std::move(spectrum));
}

SampledSpectrum tabulate_number(const Properties& properties, std::string_view name, double v,
                                SpectrumRole role) {
  const SpectralGrid& grid = properties.context().grid;
  if (role != SpectrumRole::emission) return SampledSpectrum::constant(grid, float(v));
  SampledSpectrum s = d65_spectrum(grid, v);
  if (v > 0 && !(s.maximum() > 0) && properties.has(name))
    properties.note(name,
                    "a number is a factor of illuminant D65, which is dark where the sensor sees: write "
                    "<spectrum name=\"" +
                        std::string(name) + "\" value=\"" + shown_number(v) + "\"/> for a flat spectrum");
  return s;
}

TexturePtr make_spectrum_texture(const Properties& properties, std::string_view name, SpectrumLiteral literal,
                                 SpectrumRole role) {
  const SpectralGrid& grid = properties.context().grid;
  switch (literal.kind) {
    case SpectrumLiteral::Kind::value:
      // Unlike a plain number, a spectrum with a single value is flat for emitters as well.
      check_numbers(properties, name, {&literal.value, 1}, role);
      return make_constant(properties, name, SampledSpectrum::constant(grid, float(literal.value)));
    case SpectrumLiteral::Kind::rgb: {
      check_numbers(properties, name, literal.rgb, role);
      const bool emits = role == SpectrumRole::emission;
      SampledSpectrum spectrum = spectrum_of_rgb(grid, literal.rgb, emits);
      return make_constant(properties, name, emits ? product(spectrum, d65_spectrum(grid, 1)) : spectrum);
    }
    case SpectrumLiteral::Kind::points:
      check_numbers(properties, name, literal.values, role);
      if (literal.nm.size() < 2 || literal.nm.size() != literal.values.size())
        throw properties.error(name, "a spectrum needs at least two wavelengths, each with its value");
      if (!literal.unit_is_stated) check_unit(properties, name, literal.nm.front(), literal.nm.back());
      return std::make_shared<PointSpectrum>(spectrum_properties(properties, name),
                                             SpectrumPoints{literal.nm, literal.values}, ends_of(role));
  }
  throw std::logic_error("unknown kind of spectrum");
}

void check_range(const Properties& properties, std::string_view name, const Texture& texture,
                 SpectrumRole role) {
  if (texture.minimum() < -kTolerance)
    throw properties.error(name,
                           "the texture has negative values, down to " + shown_number(texture.minimum()));
  if (!(double(texture.maximum()) <= kLargestSpectrumValue))
    throw properties.error(name, "the texture has values too large to be computed with: 1e37 is the most");
  if (role == SpectrumRole::reflectance && texture.maximum() > 1 + kTolerance)
    throw properties.error(name,
                           "a reflectance or transmittance lies in [0, 1], but the texture goes up to " +
                               shown_number(texture.maximum()));
}

/// A texture multiplied by a factor.
class ScaledTexture final : public Texture {
public:
  ScaledTexture(TexturePtr texture, float factor)
      : Texture(texture->properties()), texture_(std::move(texture)), factor_(factor) {}

  Spectrum eval(const SurfacePoint& point, const Wavelengths& wavelengths) const override {
    return texture_->eval(point, wavelengths) * factor_;
  }
  float eval_scalar(const SurfacePoint& point) const override {
    return texture_->eval_scalar(point) * factor_;
  }
  SampledSpectrum average(const Shape* shape) const override {
    SampledSpectrum s = texture_->average(shape);
    s.scale(factor_);
    return s;
  }
  bool is_constant() const override { return texture_->is_constant(); }
  float maximum() const override { return texture_->maximum() * factor_; }
  float minimum() const override { return texture_->minimum() * factor_; }
  std::pair<int, int> resolution() const override { return texture_->resolution(); }

private:
  TexturePtr texture_;
  float factor_;
};

std::string film_range(const Properties& properties) {
  const SpectralGrid& grid = properties.context().grid;
  return range_text(grid.min_nm, grid.max_nm);
}

}  // namespace

void check_unit(const Properties& properties, std::string_view name, double first_nm, double last_nm) {
  const SpectralGrid& grid = properties.context().grid;
  const auto overlaps = [&](double factor) {
    return last_nm * factor >= grid.min_nm && first_nm * factor <= grid.max_nm;
  };
  if (overlaps(1)) return;
  for (const auto& [unit, factor] : {std::pair("um", 1e3), {"angstrom", 0.1}, {"m", 1e9}})
    if (overlaps(factor))
      throw properties.error(
          name,
          fmt::format(
              "the wavelengths {0:g} to {1:g} are taken for nm, but the film has {2}; if they are in {3}, "
              "write \"{0:g}{3}\" or <spectrum unit=\"{3}\" ...> (unit=\"nm\" if they are right)",
              first_nm, last_nm, film_range(properties), unit));
}

ConstantTexture::ConstantTexture(const Properties& properties, SampledSpectrum spectrum)
    : Texture(properties), spectrum_(std::move(spectrum)) {
  flat_ = spectrum_.minimum() == spectrum_.maximum();
  value_ = spectrum_.maximum();
  scalar_ = flat_ ? value_ : float(spectrum_.average());
}

PointSpectrum::PointSpectrum(const Properties& properties, SpectrumPoints points, SpectrumEnds ends)
    : ConstantTexture(properties, SampledSpectrum::from_points(properties.context().grid, points.nm,
                                                               points.values, ends)),
      points_(std::move(points)),
      ends_(ends) {}

void PointSpectrum::note_ends(const Properties& user, std::string_view name) const {
  note_data_range(user, name, "the spectrum", {points_.nm.front(), points_.nm.back()});
}

bool PointSpectrum::reaches_film() const {
  const SpectralGrid& grid = properties().context().grid;
  return points_.nm.back() >= grid.min_nm && points_.nm.front() <= grid.max_nm;
}

TexturePtr PointSpectrum::in_role(SpectrumRole role) const {
  return ends_of(role) == ends_ ? nullptr
                                : std::make_shared<const PointSpectrum>(properties(), points_, ends_of(role));
}

float Texture::eval_scalar(const SurfacePoint& point) const {
  const SpectralGrid& grid = properties().context().grid;
  const Spectrum nm = make_spectrum(
      [&](int i) { return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (i + 0.5) / kWavelengths); });
  return mean(eval(point, Wavelengths::at(grid, nm)));
}

Vec2 Texture::gradient(const SurfacePoint&) const {
  if (is_constant()) return {};
  throw std::logic_error("the texture \"" + properties().type() + "\" has no gradient");
}

Vec3 Texture::eval_rgb(const SurfacePoint&) const {
  throw std::logic_error("the texture \"" + properties().type() + "\" has no RGB values");
}

SampledSpectrum spectrum_of_rgb(const SpectralGrid& grid, const double rgb[3], bool emission) {
  const double largest = std::max({rgb[0], rgb[1], rgb[2]});
  if (largest <= 0) return SampledSpectrum::constant(grid, 0);
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return SampledSpectrum::constant(grid, float(largest));
  // A reflectance must not be scaled to a largest component of 1/2: another spectrum of the same colour (a
  // metamer) would look different under coloured light.
  // A colour that exceeds 1 by rounding must not be scaled either, even if its role allows any value.
  const bool fits = !emission && largest <= 1 + kLimitNoise;
  const auto part = [&](double c) { return fits ? std::min(c, 1.0) : c; };
  const Rgb color{part(rgb[0]), part(rgb[1]), part(rgb[2])};
  const SigmoidSpectrum s = fits ? fit_srgb(color) : fit_unbounded(color);
  return SampledSpectrum::from_function(grid, [&](double nm) { return double(s.at(float(nm))); });
}

SpectrumLiteral get_rgb(const Properties& properties, std::string_view name, bool unbounded) {
  const Properties::Entry* e = properties.find(name);
  if (!e) throw properties.error(name, "needs the parameter \"" + std::string(name) + "\"");
  const auto* literal = Properties::spectrum_of(e->value);
  if (!literal || literal->kind != SpectrumLiteral::Kind::rgb)
    throw properties.error(name, "expected an rgb colour");
  SpectrumLiteral checked = *literal;
  check_numbers(properties, name, checked.rgb,
                unbounded ? SpectrumRole::unbounded : SpectrumRole::reflectance);
  return checked;
}

std::vector<double> get_numbers(const Properties& properties, std::string_view name) {
  std::vector<double> numbers = get_number_list(properties, name);
  check_numbers(properties, name, numbers, SpectrumRole::unbounded);
  if (numbers.size() < 2) throw properties.error(name, "needs at least two numbers");
  return numbers;
}

namespace {

/// Returns the texture given under `name`, or null, without notes.
TexturePtr read_texture(const Properties& properties, std::string_view name, SpectrumRole role) {
  const Properties::Entry* e = properties.find(name);
  if (!e) return nullptr;
  double number = 0;
  if (const auto* d = std::get_if<double>(&e->value))
    number = *d;
  else if (const auto* i = std::get_if<std::int64_t>(&e->value))
    number = double(*i);
  else if (const auto* literal = Properties::spectrum_of(e->value))
    return make_spectrum_texture(properties, name, *literal, role);
  else if (std::holds_alternative<ObjectPtr>(e->value)) {
    TexturePtr texture = properties.get_object<Texture>(name);
    if (TexturePtr meant = texture->in_role(role)) texture = std::move(meant);
    check_range(properties, name, *texture, role);
    if (role == SpectrumRole::reflectance) properties.expect_at_most(name, 1);
    return texture;
  } else
    throw properties.error(name, "expected a number, a spectrum or a texture");
  check_numbers(properties, name, {&number, 1}, role);
  return make_constant(properties, name, tabulate_number(properties, name, number, role));
}

}  // namespace

TexturePtr get_optional_texture(const Properties& properties, std::string_view name, SpectrumRole role) {
  TexturePtr texture = read_texture(properties, name, role);
  // A texture's own spectra have the role of the texture. Only the user of the texture knows that role, so
  // that the user notes missing data.
  const std::string family = properties.plugin() ? properties.plugin()->family : "";
  if (texture && ends_of(role) == SpectrumEnds::held && family != "texture" && family != "volume")
    texture->note_ends(properties, name);
  const auto* points = dynamic_cast<const PointSpectrum*>(texture.get());
  if (points && ends_of(role) == SpectrumEnds::zero && !points->reaches_film())
    properties.note(name, "parameter \"" + std::string(name) +
                              "\": none of the spectrum's points lies within the wavelengths of the film, " +
                              film_range(properties) + ": it is zero there");
  return texture;
}

std::optional<SampledSpectrum> get_optional_spectrum(const Properties& properties, std::string_view name,
                                                     SpectrumRole role) {
  const TexturePtr texture = get_optional_texture(properties, name, role);
  if (!texture) return {};
  if (!texture->is_constant()) throw properties.error(name, "must not vary over the surface");
  return texture->average();
}

TexturePtr get_texture(const Properties& properties, std::string_view name, double fallback,
                       SpectrumRole role) {
  const auto given = [&] { return get_optional_texture(properties, name, role); };
  if (TexturePtr texture = properties.tolerate(TexturePtr(), given)) return texture;
  return make_constant(properties, name, tabulate_number(properties, name, fallback, role));
}

TexturePtr scaled_texture(const TexturePtr& texture, double factor) {
  if (!texture->is_constant()) return std::make_shared<ScaledTexture>(texture, float(factor));
  SampledSpectrum spectrum = texture->average();
  spectrum.scale(float(factor));
  return std::make_shared<ConstantTexture>(texture->properties(), std::move(spectrum));
}

TexturePtr get_fraction(const Properties& properties, std::string_view name, std::optional<double> fallback) {
  TexturePtr texture = get_optional_texture(properties, name, SpectrumRole::unbounded);
  if (!texture) {
    if (!fallback)
      throw properties.error(
          name, "\"" + properties.type() + "\" needs the parameter \"" + std::string(name) + "\"");
    texture = get_texture(properties, name, *fallback, SpectrumRole::unbounded);
  }
  if (texture->maximum() > 1 + kTolerance)
    throw properties.error(name, std::string("must lie in [0, 1], but ") +
                                     (texture->is_constant() ? "is " : "the texture goes up to ") +
                                     shown_number(texture->maximum()));
  return texture;
}

AUREOLE_FAMILY(FamilyInfo{.name = "texture", .second_element = "spectrum", .is_reusable = true});

}  // namespace aureole
