// SPDX-License-Identifier: Apache-2.0
// The texture family: spectra that may vary over a surface.
#pragma once

#include <optional>
#include <utility>

#include "aureole/plugin/properties.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class AttributeName;
class MeshAttribute;

/// The quantity that a parameter denotes. The quantity decides how numbers and rgb colours are interpreted,
/// as in Mitsuba's spectral mode, and whether a spectrum continues beyond its points (`ends_of`).
enum class SpectrumRole {
  reflectance,  ///< reflectance or transmittance of matter, in [0, 1]
  unbounded,    ///< a property of matter, 0 or more: index of refraction, coefficient, absorbance, roughness
  emission,     ///< emission of a light; multiplies CIE D65, normalised so that rgb = 1 has luminance 1
  response      ///< response of a sensor, or a filter before a light; 0 or more
};

/// Returns how a spectrum of this role continues beyond its points. A property of matter exists at every
/// wavelength, and zero would make the matter clear, black or a vacuum there, so that the value at the end is
/// kept, with a note. Emission and responses are zero outside their points.
constexpr SpectrumEnds ends_of(SpectrumRole role) {
  return role == SpectrumRole::emission || role == SpectrumRole::response ? SpectrumEnds::zero
                                                                          : SpectrumEnds::held;
}

class Texture : public Object {
public:
  static constexpr const char* kFamily = "a texture or spectrum";
  using Object::Object;

  /// Returns the value at the path's wavelengths.
  virtual Spectrum eval(const SurfacePoint& point, const Wavelengths& wavelengths) const = 0;
  /// Returns the value as one number, for quantities that do not depend on wavelength (opacities, weights,
  /// heights): the luminance of a colour if the texture stores it, else the mean over the sensor's range.
  virtual float eval_scalar(const SurfacePoint& point) const;
  /// Returns the gradient of eval_scalar by (u, v), for textures that have one.
  virtual Vec2 gradient(const SurfacePoint& point) const;
  virtual bool has_gradient() const { return is_constant(); }
  /// Returns the three numbers of a picture that does not contain colours (normal maps), for textures that
  /// have them.
  virtual Vec3 eval_rgb(const SurfacePoint& point) const;
  virtual bool has_rgb() const { return false; }
  /// Returns the mean over the surface (over uv in [0, 1]^2), tabulated on the scene's grid. For a mesh
  /// attribute, it is only known if the shape is given.
  virtual SampledSpectrum average(const Shape* shape = nullptr) const = 0;
  /// Whether the value does not depend on the point.
  virtual bool is_constant() const { return false; }
  /// Largest value over the surface and all wavelengths, for range checks.
  virtual float maximum() const = 0;
  /// Smallest value over the surface and all wavelengths.
  virtual float minimum() const = 0;
  /// Notes the wavelengths of the film at which the spectra of the texture have no data, so that the value at
  /// the end is used. The note is located at the parameter `name` of `user`. Called for properties of matter
  /// (`ends_of`).
  virtual void note_ends(const Properties& /*user*/, std::string_view /*name*/) const {}
  /// The texture with its numbers, colours and spectra interpreted in that role; null if the role makes no difference.
  virtual std::shared_ptr<const Texture> in_role(SpectrumRole) const { return nullptr; }
  /// Returns columns and rows of a picture, for emitters that project the texture.
  virtual std::pair<int, int> resolution() const { return {1, 1}; }
};
using TexturePtr = std::shared_ptr<const Texture>;

/// A texture whose values are an attribute of the mesh it is on, see `Shape::attribute`.
class AttributeTexture : public Texture {
public:
  using Texture::Texture;
  virtual const AttributeName& attribute_name() const = 0;
  /// Throws Error if the attribute cannot be used as a texture, or if it exceeds `most`.
  virtual void check(const MeshAttribute& attribute, double most) const = 0;
};

/// Returns the texture, spectrum or number given under `name`, or `fallback` if absent. A reflectance outside
/// [0, 1] and any negative value are errors located at the parameter.
TexturePtr get_texture(const Properties& properties, std::string_view name, double fallback,
                       SpectrumRole role);

/// Returns the texture given under `name`, or null if absent.
TexturePtr get_optional_texture(const Properties& properties, std::string_view name, SpectrumRole role);

/// Returns the spectrum given under `name`, tabulated on the scene's grid; nothing where absent. A texture
/// that varies over a surface is an error located at the parameter.
std::optional<SampledSpectrum> get_optional_spectrum(const Properties& properties, std::string_view name,
                                                     SpectrumRole role);

/// Returns the texture multiplied by a positive factor at all wavelengths.
TexturePtr scaled_texture(const TexturePtr& texture, double factor);

/// Returns a texture or number in [0, 1] for `eval_scalar`, such as an opacity or a weight. It is required if
/// there is no fallback.
TexturePtr get_fraction(const Properties& properties, std::string_view name, std::optional<double> fallback);

}  // namespace aureole
