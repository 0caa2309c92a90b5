// SPDX-License-Identifier: Apache-2.0
// A lens by its elements: rotationally symmetric surfaces on one axis, traced exactly and in the paraxial
// approximation.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace aureole::optics {

/// One refracting surface, or the aperture stop. Lengths are in mm. Light of a picture passes the surfaces in their
/// order, towards +z.
struct LensSurface {
  double curvature =
      0;  ///< inverse radius at the vertex [1/mm], positive where the centre lies behind the surface
  double conic = 0;            ///< conic constant: 0 sphere, -1 paraboloid
  std::vector<double> even{};  ///< coefficients of r^4, r^6, ... of an asphere [mm^-3, mm^-5, ...]
  double thickness = 0;        ///< distance along the axis to the next surface, or to the film [mm]
  double semi_diameter = 0;    ///< radius of what lets light pass [mm]
  bool is_stop = false;        ///< the aperture stop; it may be a refracting surface as well
  double coating_index = 0;    ///< of a single layer on the surface; 0: none, 1: lossless
  double coating_nm = 550;     ///< wavelength at which that layer is a quarter wave thick at normal incidence
};

/// A ray in the lens' coordinates: origin and unit direction [mm]. z = 0 is the vertex of the first surface.
struct LensRay {
  std::array<double, 3> o{}, d{};
};

/// The first-order properties of a lens in air at one wavelength [mm]. Positions are z coordinates.
struct ParaxialLens {
  double focal_length = 0;    ///< effective focal length
  double front_focus = 0;     ///< front focal point
  double back_focus = 0;      ///< rear focal point
  double entrance_pupil = 0;  ///< position of the image of the stop by the elements before it
  double entrance_semi = 0;   ///< its radius
  double exit_pupil = 0;      ///< position of the image of the stop by the elements behind it
  double exit_semi = 0;       ///< its radius
  double f_number() const { return focal_length / (2 * entrance_semi); }
};

class LensSystem {
public:
  /// Throws std::domain_error without a refracting surface, without or with several stops, or for numbers that describe
  /// no surface.
  explicit LensSystem(std::vector<LensSurface> surfaces);

  const std::vector<LensSurface>& surfaces() const { return surfaces_; }
  std::size_t stop() const { return stop_; }
  /// z of the vertex of a surface; `surfaces().size()` is the film.
  double vertex(std::size_t surface) const { return vertices_[surface]; }
  double film() const { return vertices_.back(); }
  void set_film(double z);
  void set_stop_semi_diameter(double mm) { surfaces_[stop_].semi_diameter = mm; }

  // `indices` are those behind each surface at the wavelength `nm`; 1 is in front of the first one and, usually, behind
  // the last one.
  /// Follows a ray from the object to behind the last surface. Returns the transmittance of the surfaces, for light
  /// without polarisation; nothing where the ray misses a surface, is stopped, or is totally reflected.
  std::optional<double> trace(LensRay& ray, std::span<const double> indices, double nm) const {
    return follow(ray, indices, nm, true);
  }
  /// As `trace`, from the film to before the first surface.
  std::optional<double> trace_back(LensRay& ray, std::span<const double> indices, double nm) const {
    return follow(ray, indices, nm, false);
  }
  /// Number of sides of the stop (0: round) and the angle of a corner from +x [rad].
  void set_blades(int count, double angle) { blades_ = count, blade_angle_ = angle; }

  /// Throws std::domain_error for a lens without power.
  ParaxialLens paraxial(std::span<const double> indices) const;
  /// z of the paraxial image of the axial point at the distance `object` before the first vertex (infinity is allowed).
  double paraxial_image(std::span<const double> indices, double object) const;

  /// The height z(r) of a surface above the plane at its vertex [mm], and its slope dz/dr; nothing beyond its rim.
  static std::optional<std::array<double, 2>> sag(const LensSurface& surface, double r);

private:
  std::optional<double> follow(LensRay& ray, std::span<const double> indices, double nm, bool forward) const;
  bool passes_stop(double x, double y, double semi) const;

  std::vector<LensSurface> surfaces_;
  std::vector<double> vertices_;
  std::size_t stop_ = 0;
  int blades_ = 0;
  double blade_angle_ = 0;
};

/// The transmittance of an interface between indices n1 and n2 for light without polarisation that arrives in n1 under
/// the cosine `cos1`, through a layer of index `layer` that is a quarter of `layer_nm` thick (Born & Wolf 1999, section
/// 1.6.4). `layer` 0: none (Fresnel's equations); 1: an ideal coating that reflects nothing. It is 0 beyond the angle of
/// total reflection.
double coated_transmittance(double n1, double n2, double cos1, double layer, double layer_nm, double nm);

/// Points of a spot diagram: where rays of an object meet the plane of the film.
struct Spot {
  std::vector<std::array<double, 2>> points;  ///< (x, y) [mm]
  std::array<double, 2> centroid{};
  double rms_radius = 0;     ///< root of the mean squared distance from the centroid [mm]
  double launched = 0;       ///< number of rays that were aimed at the lens
  double transmittance = 0;  ///< mean over the rays that arrive
};
/// Traces a square grid of `rays` x `rays` rays of a point over the paraxial entrance pupil. The point is at the distance `object`
/// before the first vertex (may be infinite) and, seen from the middle of the pupil, at the angle `field` [rad] from the axis in
/// the plane of y, below it.
Spot object_spot(const LensSystem& lens, std::span<const double> indices, double nm, double field,
                 double object, int rays);
/// z at which the axial point at the distance `object` (may be infinite) has the smallest root mean square spot.
double best_focus(const LensSystem& lens, std::span<const double> indices, double nm, double object);

}  // namespace aureole::optics
