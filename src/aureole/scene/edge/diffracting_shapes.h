// SPDX-License-Identifier: Apache-2.0
// `DiffractingShapes`: the shapes of a scene whose edges diffract, as triangles in the world: meshes, and round
// shapes by polygons around their rims and outlines. Left out are null surfaces, round shapes that emit or are
// seen from within, and, if BSDFs request diffraction (`freespacediffraction`), the shapes of all other BSDFs.
#pragma once

#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/edge_diffraction.h"
#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/scene/edge/beam_width.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// Returns the settings of diffraction of a BSDF or of a BSDF nested in it, or null.
const EdgeDiffraction* edge_diffraction_of(const Bsdf& bsdf);
/// Returns the first BSDF in the scene that requests diffraction for its shape, or null.
const Bsdf* first_diffracting_bsdf(const SceneParts& parts);

/// The note for a scene without diffracting edges.
inline constexpr const char* kNoDiffractingEdges =
    "no shape of the scene has edges that diffract: no light is diffracted";

class DiffractingShapes {
public:
  /// Whether shapes that transmit part of the light undeflected, such as masks and panes, count. Those that
  /// transmit less than a hundredth of it always count.
  enum class SeenThrough { counts, left_out };
  /// Whether balls become polyhedra in `sets` or are listed in `balls`.
  enum class Balls { as_polyhedra, listed };
  explicit DiffractingShapes(const SceneParts& parts, SeenThrough seen_through = SeenThrough::counts,
                             Balls balls = Balls::as_polyhedra);

  std::vector<TriangleSet> sets;
  std::vector<float> scale;  ///< of each set: factor of the light
  /// For each set, the height above an edge from which light passes. A round surface bends away behind its
  /// outline; where it is lower than the outline by less than this height, it acts as a flat screen.
  std::vector<float> lift;
  /// How the surface of a set reflects waves that its edges diffract.
  struct Reflection {
    bool is_mirror = false;  ///< whether it has a specular reflection; otherwise it absorbs
    /// amplitudes of that reflection; null: those of a perfect mirror
    const MirrorReflection* amplitudes = nullptr;
  };
  std::vector<Reflection> reflects;  ///< of each set
  /// A ball in the world.
  struct BallInWorld {
    Double3 center;
    double radius;
    double lift;  ///< height as in `lift` of a set
    int pieces;   ///< number of sides of the polygon that approximates its outline
  };
  std::vector<BallInWorld> balls;
  std::vector<std::string> remarks;

  /// Whether a BSDF states the width of beams.
  bool has_width() const;
  /// Returns the width of beams, also from the BSDFs. Throws Error if they disagree.
  BeamWidth width(const BeamWidth& of_integrator) const;

private:
  struct Round;
  void add(const Shape& shape, const Bsdf& bsdf, bool shines, const Instance* instance);
  void add_round_shapes();
  void add_triangles(std::vector<Vec3> positions, std::vector<TriangleIndices> triangles,
                     const Instance* instance, float scale, float lift, Reflection reflects);

  bool passes_light(const Bsdf& bsdf) const;
  /// Returns the number of sides of a polygon that approximates a rim of that radius; `is_curved`: the
  /// surface bends away behind its outline.
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

/// A round shape; it becomes triangles when the number of round shapes is known.
struct DiffractingShapes::Round {
  const Shape* shape;
  const Instance* instance;
  float scale;
  double radius;  ///< in the world
  Reflection reflects;
};

}  // namespace aureole
