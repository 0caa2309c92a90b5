// SPDX-License-Identifier: Apache-2.0
// The light of a layer of transparent scatterers on a plane, for the BSDF `correlated_caps`: the undiffracted beam,
// light that is diffracted and refracted into other directions, and light that is turned back. The model of one
// scatterer is in optics/layer/phase_scatterer.h.
//
// Directions are unit vectors of the medium outside, both outward from the surface; caps lie on the side of z > 0. For
// a pair of directions on opposite sides, q is the change of the transverse wave vector, u = k a |w_i + w_o|, and
//     f = (k a)^2/(4 pi^2) rho (U + C S'),   rho = area_fraction/(pi <s^2>),
// with lengths relative to the median radius a and the mean <s^2> of the squares of sizes.
//
// Energy. The fraction |1 + rho <F>|^2 is not diffracted. The integral of f, computed at nodes of the angle of
// incidence and of the wavelength, should be at most 1 minus this and minus what is absorbed. It may be more by 1 %,
// and by much where light of one direction passes scatterers and gaps in phase, since F depends on both directions
// and the undiffracted beam on one; f is then multiplied by s(w_i) s(w_o), s <= 1. The rest is light that is reflected
// within caps, and the power of evanescent waves; it is turned back evenly,
//     f = L_i L_o/(pi <L>),   <L> = 2 integral of L cos,
// which is reciprocal (Kelemen and Szirmay-Kalos, "A microfacet based coupled specular-matte BRDF model with
// importance sampling", 2001). So a layer that does not absorb loses no light at any angle.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "aureole/core/table_fields.h"
#include "aureole/math/vec.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/layer/phase_scatterer.h"
#include "aureole/optics/layer/radial_function.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// A layer as a scene describes it.
struct CapLayer {
  optics::PhaseProfile profile;
  double radius_nm = 0;  ///< radius of the base; the median radius, if sizes differ
  double height = 0;     ///< height of a cap over the radius of its base
  double area_fraction = 0;
  optics::SizeDistribution sizes;
  std::shared_ptr<const optics::StructureFactor> structure;  ///< structure factor at area_fraction
  std::function<double(double nm)> medium;                   ///< index of refraction outside
  /// index of refraction of the scatterers over the index outside
  std::function<double(double nm)> relative_index;
  std::function<double(double nm)> transmittance;  ///< transmittance of a scatterer, reduced by absorption
};

class CapTables {
public:
  /// Empty tables, to be read.
  CapTables() = default;
  /// Computes the tables of a layer. Throws std::domain_error if the tables would be too large.
  CapTables(const CapLayer& layer, const SpectralGrid& grid);

  /// Properties of the layer for light of one wavelength.
  struct Light {
    float phase;      ///< k a
    float index;      ///< index of refraction of the scatterers over the index outside
    float amplitude;  ///< square root of the transmittance
    float node;       ///< position of the wavelength between the nodes of the tables
  };
  Light light(float nm, float medium, float relative_index, float transmittance) const;

  /// Fractions into which the layer divides light that arrives from one side at a cosine.
  struct Shares {
    float undiffracted, scattered, turned_back;
  };
  Shares shares(const Light& light, bool from_caps, float cosine) const;

  /// Returns f |cos o| of light that is transmitted through the layer.
  float scattered(const Light& light, const Vec3& wi, const Vec3& wo) const;
  /// Returns f |cos o| of light that is turned back. Both directions lie on one side, and `share` is the
  /// fraction `turned_back` of light from wi.
  float turned_back(const Light& light, float share, const Vec3& wo) const;

  /// Samples a direction of scattered light; false if it is evanescent.
  bool sample(const Light& light, const Vec3& wi, Vec2 xi, Vec3& wo) const;
  /// Returns the density of `sample` [1/sr].
  float density(const Light& light, const Vec3& wi, const Vec3& wo) const;

  std::size_t bytes() const;

  static constexpr TableKind kTable{"layer of caps", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.covered_, self.density_, self.height_, self.structure_scale_, self.is_curved_, self.phase_nm_,
        self.first_, self.scale_, self.structure_, self.scatterer_, self.waves_, self.passing_,
        self.reduction_, self.mean_back_);
  }

private:
  static constexpr int kWavelengthNodes = 33, kCosines = 48;

  /// A pair of directions by their transverse parts, which are those of w_i and w_o on their sides.
  struct Pair {
    Vec2 on_caps, on_flat;  ///< transverse parts of the direction on the side of the caps and on the other
    float cos_caps, cos_flat;
  };
  static Pair pair(const Vec3& wi, const Vec3& wo);
  /// Returns (U + C S')/a^4 for a pair of directions (definitions above).
  float intensity(const Light& light, const Pair& pair) const;
  float structure(float u) const { return std::max(1 + structure_.eval(u * structure_scale_), 0.f); }
  Light node_light(int node) const;
  float absorbed(const Light& light) const { return covered_ * (1 - light.amplitude * light.amplitude); }
  float undiffracted(const Light& light, float cosine) const;
  /// Interpolates a table over wavelength, side and cosine.
  float look_up(const std::vector<float>& table, const Light& light, bool on_caps, float cosine) const;
  void sum_scattered(int node);

  CapLayer layer_;  ///< while tables are made
  float covered_ = 0, density_ = 0, height_ = 0, structure_scale_ = 0;
  bool is_curved_ = false;                       ///< whether scatterers are caps, not discs
  double phase_nm_ = 0, first_ = 0, scale_ = 0;  ///< the node of a wavelength is (1/nm - first) scale
  optics::RadialFunction structure_;
  optics::PhaseScatterer scatterer_;
  /// radial distributions of u, one for each wavelength node
  std::vector<optics::RadialDistribution> waves_;
  std::vector<float> passing_;    ///< fraction that passes undiffracted, by [node][side][cosine]
  std::vector<float> reduction_;  ///< the factor s of a direction, [node][side][cosine]
  std::vector<float> mean_back_;  ///< mean <L>, by [node][side]
};

}  // namespace aureole
