// SPDX-License-Identifier: Apache-2.0
// Scenes whose geometry, materials and lights a test knows in closed form: rectangles, one box of fog, one
// sky and a pinhole camera. They are written as XML for aureole; `PathOracle` computes with the same numbers
// by itself.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "aureole/shape/geometry/double3.h"

namespace aureole::testing {

/// A spectrum that is linear between points at whole nanometres, from at most 359 to at least 831 nm. Aureole
/// tabulates it as means weighted by the hat functions of a grid of 1 nm (docs/conventions.md), which is done
/// here in closed form.
class Curve {
public:
  explicit Curve(std::map<int, double> points) : points_(std::move(points)) {}
  explicit Curve(double value) : Curve({{300, value}, {900, value}}) {}
  double operator()(double nm) const;
  Curve scaled(double factor) const;
  /// The element <spectrum name="...">.
  std::string xml(const std::string& name) const;

private:
  double exact(int nm) const;
  double node(int nm) const;
  std::map<int, double> points_;
};

/// Scattering of a surface for light from the side of its normal; it is black from behind.
struct Material {
  enum class Kind { lambert, phong, mirror };
  Kind kind = Kind::lambert;
  Curve reflectance{0.5};    ///< of the mirror, or of the Lambertian lobe
  Curve glossy{0.};          ///< reflectance of the Phong lobe
  Curve exponent{1.};        ///< of the Phong lobe
  Curve diffuse_share{0.5};  ///< probability of sampling the Lambertian lobe, of kind `phong`
};

/// The points center + a half_x + b half_y, a and b in [-1, 1]. The normal is along half_x x half_y.
struct Rectangle {
  Double3 center, half_x, half_y;
  Material material;
  std::optional<Curve> radiance;  ///< of light that leaves on the side of the normal

  Double3 normal() const { return normalize(cross(half_x, half_y)); }
  double area() const { return 4 * length(cross(half_x, half_y)); }
};

struct PointLight {
  Double3 p;
  Curve intensity;
};

/// A homogeneous medium with the phase function of Henyey and Greenstein in a box along the axes.
struct Fog {
  Double3 lower, upper;
  Curve scattering, absorption;
  double mean_cosine;
};

/// A pinhole that looks along `forward`; `left` and `up` are unit vectors of the picture.
struct Pinhole {
  Double3 p, forward{0, 0, -1}, left{-1, 0, 0}, up{0, 1, 0};
  double field_of_view = 40;  ///< along the width [degrees]
  int width = 32, height = 24;

  double pixel_size() const;  ///< of the picture plane at distance 1
};

struct ClosedFormScene {
  std::vector<Rectangle> rectangles;
  std::optional<PointLight> point;
  std::optional<Curve> sky;
  std::optional<Fog> fog;
  Pinhole camera;

  /// The scene file. Rectangle number i has the id "r<i>", the box of fog "fog".
  std::string xml(const std::string& integrator) const;
};

}  // namespace aureole::testing
