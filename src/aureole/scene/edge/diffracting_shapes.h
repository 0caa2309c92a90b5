// SPDX-License-Identifier: Apache-2.0
// `DiffractingShapes`: which shapes of a scene have edges that diffract, as triangles in the world.
#pragma once

#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/edge_diffraction.h"
#include "aureole/scene/edge/beam_width.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// The settings of diffraction of the BSDF or of one within it, or null.
const EdgeDiffraction* edge_diffraction_of(const Bsdf& bsdf);
/// The first BSDF in the scene that has its shape diffract, or null.
const Bsdf* first_diffracting_bsdf(const SceneParts& parts);

/// The note of a scene whose shapes have none.
inline constexpr const char* kNoDiffractingEdges =
    "no shape of the scene has edges that diffract: no light is diffracted";

class DiffractingShapes {
public:
  /// Meshes and, by polygons around their rims and outlines, round shapes. Without those that light passes as if they were not there,
  /// round ones that shine or are seen from within, and, where BSDFs say which shapes diffract, all others.
  /// `seen_through`: whether shapes count that light passes straight through in part, such as masks and panes. Those that
  /// pass less than a hundredth of it always do.
  enum class SeenThrough { counts, left_out };
  /// Whether balls become polyhedra in `sets` or are listed in `balls`.
  enum class Balls { as_polyhedra, listed };
  explicit DiffractingShapes(const SceneParts& parts, SeenThrough seen_through = SeenThrough::counts,
                             Balls balls = Balls::as_polyhedra);

  std::vector<TriangleSet> sets;
  std::vector<float> scale;  ///< of each set: factor of the light
  /// Of each set: how high above an edge light passes. A round surface bends away behind its outline; so far as its depth there is less
  /// than that, it is as good as a flat screen.
  std::vector<float> lift;
  std::vector<bool> reflects;  ///< of each set: whether its BSDF reflects as a mirror
  /// A ball in the world.
  struct BallInWorld {
    Double3 center;
    double radius;
    double lift;  ///< as above
    int pieces;   ///< sides of a polygon around it that is as good as a circle
  };
  std::vector<BallInWorld> balls;
  std::vector<std::string> remarks;

  /// The width of beams, with what BSDFs say about it. Throws Error where they disagree.
  BeamWidth width(const BeamWidth& of_integrator) const;

private:
  struct Round;
  void add(const Shape& shape, const Bsdf& bsdf, bool shines, const Instance* instance);
  void add_round_shapes();
  void add_triangles(std::vector<Vec3> positions, std::vector<TriangleIndices> triangles,
                     const Instance* instance, float scale, float lift, bool reflects);

  bool passes_light(const Bsdf& bsdf) const;
  /// The number of sides of a polygon with that radius, whose surface bends away behind its outline or not.
  int wanted_pieces(double radius, bool is_curved) const;

  double wave_number_;  ///< of the shortest wavelength, per unit of length
  SeenThrough seen_through_;
  Balls balls_;
  Wavelengths middle_;  ///< in the middle of the film's range
  std::size_t left_out_ = 0;
  bool only_marked_ = false;
  std::vector<const Bsdf*> marked_;
  std::vector<Round> rounds_;
  std::vector<std::vector<Vec3>> positions_;
  std::vector<std::vector<TriangleIndices>> triangles_;
};

/// A round shape that waits until it is known how many there are.
struct DiffractingShapes::Round {
  const Shape* shape;
  const Instance* instance;
  float scale;
  double radius;  ///< in the world
  bool reflects;  ///< as a mirror
};

}  // namespace aureole
