// SPDX-License-Identifier: Apache-2.0
// Scattering by matrices between patches of two hemispheres (Klems), ready to be evaluated and sampled.
#pragma once

#include <array>
#include <vector>

#include "aureole/bsdf/measured/window_file.h"
#include "aureole/math/piecewise.h"
#include "aureole/math/vec.h"

namespace aureole {

/// The patches of an angle basis.
class KlemsPatches {
public:
  KlemsPatches() = default;
  explicit KlemsPatches(const AngleBasis& basis);

  std::size_t count() const { return count_; }
  /// The patch of a direction with the cosine `z` > 0, or `count()` where the basis ends before 90 degrees.
  std::size_t at(float x, float y, float z) const;
  /// The integral of the cosine over the patch [sr].
  double projected_solid_angle(std::size_t patch) const;
  /// A direction above the surface, distributed as the cosine within the patch.
  Vec3 sample(std::size_t patch, Vec2 u) const;

private:
  struct Ring {
    float lower_sin2, upper_sin2;  ///< squared sines of the angles from the normal that bound the ring
    std::uint32_t first, azimuths;
  };
  const Ring& ring_of(std::size_t patch) const;
  std::vector<Ring> rings_;
  std::size_t count_ = 0;
};

/// Scattering of light from one side of the surface to one side; f [1/sr] for each incident and outgoing patch. Incident
/// patches have azimuths turned by 180 degrees, so that undeviated light stays in the patch of its index.
struct KlemsMatrix {
  KlemsPatches incident, outgoing;
  bool is_coloured = false;
  /// values by incident patch, outgoing patch, and channel (linear sRGB) if there are three
  std::vector<float> values;

  bool empty() const { return values.empty(); }
  /// f for the patches of two directions with positive z; zero outside of the bases.
  std::array<float, 3> at(const Vec3& incident_direction, const Vec3& outgoing_direction) const;
  /// The mean of the channels.
  float mean(std::size_t i, std::size_t o) const;
};

/// Faults of a file that are noted, not repaired.
struct WindowNotes {
  std::size_t negative = 0;  ///< number of values below zero, which count as zero
  /// whether the transmission of a side was missing and was taken from the other side
  bool reversed_front = false, reversed_back = false;
};

/// A sheet with matrices for both sides. Index 0: light that arrives on the side of +z, which is the file's back (inside);
/// index 1: on the side of -z.
struct KlemsSheet {
  std::array<KlemsMatrix, 2> reflection, transmission;
};

/// Reads a sheet with Klems matrices. Throws Error located at the file's line.
KlemsSheet read_klems_sheet(const WindowFile& file, WindowNotes& notes);

/// Linear sRGB of CIE XYZ.
std::array<float, 3> rgb_of_xyz(double x, double y, double z);

}  // namespace aureole
