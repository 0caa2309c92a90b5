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

/// The quantity that rgb or a number stands for, as in Mitsuba's spectral mode: a reflectance in [0, 1], an
/// unbounded quantity, or an emission, which multiplies CIE D65 (normalised so that rgb = 1 has luminance 1).
enum class SpectrumRole { reflectance, unbounded, emission };

class Texture : public Object {
public:
  static constexpr const char* kFamily = "a texture or spectrum";
  using Object::Object;

  /// Value at the path's wavelengths.
  virtual Spectrum eval(const SurfacePoint& point, const Wavelengths& wavelengths) const = 0;
  /// The value as one number, for quantities without wavelength (opacities, weights, heights): of a colour
  /// the luminance where the texture knows it, else the mean over the sensor's range.
  virtual float eval_scalar(const SurfacePoint& point) const;
  /// d eval_scalar / d(u, v), for textures that have it.
  virtual Vec2 gradient(const SurfacePoint& point) const;
  virtual bool has_gradient() const { return is_constant(); }
  /// The three numbers of a picture that holds no colours, for textures that have them (normal maps).
  virtual Vec3 eval_rgb(const SurfacePoint& point) const;
  virtual bool has_rgb() const { return false; }
  /// The mean over the surface (over uv in [0, 1]^2), tabulated on the scene's grid. Of an attribute of a
  /// mesh it is known where the shape is.
  virtual SampledSpectrum average(const Shape* shape = nullptr) const = 0;
  /// True where the value does not depend on the point.
  virtual bool is_constant() const { return false; }
  /// Largest value over the surface and all wavelengths, for range checks.
  virtual float maximum() const = 0;
  /// Smallest value over the surface and all wavelengths.
  virtual float minimum() const = 0;
  /// The texture where its numbers and colours mean that quantity; null: it is the same for all.
  virtual std::shared_ptr<const Texture> in_role(SpectrumRole) const { return nullptr; }
  /// Columns and rows of a picture, for emitters that project it.
  virtual std::pair<int, int> resolution() const { return {1, 1}; }
};
using TexturePtr = std::shared_ptr<const Texture>;

/// A texture that shows an attribute of the mesh it is on: `Shape::attribute` has the values.
class AttributeTexture : public Texture {
public:
  using Texture::Texture;
  virtual const AttributeName& attribute_name() const = 0;
  /// Throws Error where these values cannot be shown, or exceed `most` where it is used.
  virtual void check(const MeshAttribute& attribute, double most) const = 0;
};

/// The texture, spectrum or number given under `name`; `fallback` where absent. A reflectance outside [0, 1]
/// and any negative value are errors located at the parameter.
TexturePtr get_texture(const Properties& properties, std::string_view name, double fallback,
                       SpectrumRole role);

/// The texture given under `name`, or null where absent.
TexturePtr get_optional_texture(const Properties& properties, std::string_view name, SpectrumRole role);

/// The spectrum given under `name`, tabulated on the scene's grid; nothing where absent. A texture that varies
/// over a surface is an error located at the parameter.
std::optional<SampledSpectrum> get_optional_spectrum(const Properties& properties, std::string_view name,
                                                     SpectrumRole role);

/// A texture or number in [0, 1] to be read with `eval_scalar`: an opacity or a weight. Without a fallback it
/// is required.
TexturePtr get_fraction(const Properties& properties, std::string_view name, std::optional<double> fallback);

}  // namespace aureole
