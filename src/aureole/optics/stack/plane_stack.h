// SPDX-License-Identifier: Apache-2.0
// Stacks of plane layers that absorb and scatter, with interfaces between them and a substrate below: coats
// of paint, leaves, prints, slabs between slides. The equation of radiative transfer of unpolarised light at
// one wavelength, by discrete ordinates with adding and doubling (Chandrasekhar 1960, Radiative Transfer; van
// de Hulst 1980, Multiple Light Scattering).
//
// Layers are counted from the top. "Down" is the direction from above the stack to what is below it. Cosines
// of directions are positive where light goes up and negative where it goes down, in the medium where it is;
// those of incident beams are given as positive numbers. Azimuth 0 is where light goes that continues in the
// beam's own half-plane: the mirror direction has azimuth 0. Functions throw std::domain_error, with the
// layer or the value, for bad input.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "aureole/optics/stack/legendre_phase.h"

namespace aureole::optics {

enum class InterfaceKind { smooth, beckmann, ggx };

/// Where two media of different index meet; between equal indices there is nothing. A rough one has
/// microfacets that reflect and refract as a smooth one does (Walter, Marschner, Li & Torrance 2007, (20),
/// (21)), with Smith's masking for each direction. What they lose, since each is met once only, goes into
/// lobes on both sides (Kulla & Conty 2017), so that energy is conserved.
struct StackInterface {
  InterfaceKind kind = InterfaceKind::smooth;
  /// Roughness of the microfacets, in [0.05, 1]. Lobes are as wide: radiances of beams ask for some 8/alpha
  /// streams.
  double alpha = 0.1;
};

struct StackLayer {
  double absorption = 0;  ///< sigma_a, in 1/length
  double scattering = 0;  ///< sigma_s, in 1/length
  double thickness = 0;   ///< a length in that unit; may be infinite
  LegendrePhase phase = LegendrePhase::isotropic();
  double index = 1;      ///< of refraction
  StackInterface top{};  ///< to the layer above, or the medium above the stack

  /// A layer whose unit of length is the mean free path.
  static StackLayer of_optical_thickness(double optical_thickness, double albedo,
                                         LegendrePhase phase = LegendrePhase::isotropic(), double index = 1) {
    return {1 - albedo, albedo, optical_thickness, std::move(phase), index};
  }
  double extinction() const { return absorption + scattering; }
};

struct StackDescription {
  std::vector<StackLayer> layers;
  double index_above = 1;
  /// Reflectance, in [0, 1], of a Lambertian surface that ends the last layer: 0 is black. None: there is
  /// light below, too.
  std::optional<double> substrate;
  /// Reflection by a substrate beside its Lambertian share, seen from the medium of the last layer: as a
  /// mirror, by the cosine, and by a reciprocal BRDF in 1/sr of two cosines and the azimuth. Null: none.
  std::function<double(double)> mirror{};
  std::function<double(double, double, double)> brdf{};
  double index_below = 1;   ///< where there is no substrate
  StackInterface bottom{};  ///< of the last layer, where there is no substrate
};

struct DiscreteOrdinates {
  /// Directions in which light is followed, an even number; half of them go down. 2 is a two-flux, 4 a
  /// four-flux theory. Where indices differ they are shared among the ranges between the critical angles.
  int streams = 32;
  /// Forward peaks that so few directions cannot show become light that is not scattered, and radiances of
  /// beams have single scattering by the whole phase function: Wiscombe 1977, J. Atmos. Sci. 34, 1408;
  /// Nakajima & Tanaka 1988, J. Quant. Spectrosc. Radiat. Transfer 40, 51, the method TMS. Without it the
  /// phase function ends at its moment `streams` - 1.
  bool delta_m = true;
  /// Azimuthal modes that radiances are made of, at most `streams`; 0: so many. Rough interfaces have them
  /// all, and lobes some degrees wide are done with fewer.
  int modes = 0;
};

/// Light of irradiance 1 on the stack, of a beam or, without a cosine, of a Lambertian sky (the same radiance
/// from everywhere).
struct StackLight {
  std::optional<double> cosine;  ///< in (0, 1], in the medium it comes from
  bool from_below = false;

  static StackLight beam(double cosine, bool from_below = false) { return {cosine, from_below}; }
  static StackLight diffuse(bool from_below = false) { return {std::nullopt, from_below}; }
};

/// Parts of the incident flux. With light from below "reflected" is what returns downward.
struct StackFluxes {
  /// All light. What passes into a substrate is what that absorbs.
  double reflectance = 0, transmittance = 0;
  /// Light that was not scattered, part of them: what interfaces reflect, and what passes all layers. On a
  /// substrate the share of the first arrivals that it keeps.
  double unscattered_reflectance = 0, unscattered_transmittance = 0;
  double absorptance() const { return 1 - reflectance - transmittance; }  ///< of the layers
};

/// A depth in a layer from its top, in its unit of length. Interfaces are no part of the layer.
struct StackPosition {
  int layer = 0;
  double depth = 0;
};

/// Light at a position, per irradiance on the stack, unscattered light included.
struct StackField {
  double flux_down = 0, flux_up = 0;
  double fluence_down = 0, fluence_up = 0;  ///< radiance integrated over the directions of each half
  double unscattered_flux_down = 0, unscattered_flux_up = 0;
  /// Coefficients of the two-flux equations dF_down/dz = -(K + S) F_down + S' F_up that make them exact here
  /// (Bohren & Clothiaux 2006, chapter 5; Kubelka & Munk 1931 take them for constants), in 1/length: the
  /// fraction of a flux that is absorbed per length, and the fraction scattered backward. Without `delta_m`
  /// and with 2 streams they are the same everywhere. 0 where there is no flux.
  double absorption_down = 0, absorption_up = 0;    ///< K
  double backscatter_down = 0, backscatter_up = 0;  ///< S of light that goes down, and of what goes up
};

/// Fluxes between rings of directions: row i, column j is what leaves in ring i where light of irradiance 1
/// comes evenly from ring j.
struct StackChannels {
  std::vector<double> projected_solid_angle;  ///< of each ring, pi (mu_a^2 - mu_b^2)
  std::vector<double> reflected, transmitted;
};

class PlaneStack {
public:
  explicit PlaneStack(StackDescription description, DiscreteOrdinates method = {});

  const StackDescription& description() const { return description_; }
  const DiscreteOrdinates& method() const { return method_; }

  StackFluxes fluxes(const StackLight& light) const;
  std::vector<StackFluxes> fluxes(std::span<const StackLight> lights) const;

  /// Radiance above the stack (cosines > 0) and, where there is no substrate, below it (< 0), per irradiance,
  /// in 1/sr: for a beam the BRDF and BTDF without the deltas of unscattered light; for diffuse light all of
  /// it. By light, cosine, azimuth (radians).
  std::vector<double> radiance(std::span<const StackLight> lights, std::span<const double> cosines,
                               std::span<const double> azimuths) const;
  /// Radiance within a layer, in all directions.
  std::vector<double> radiance(std::span<const StackLight> lights, const StackPosition& position,
                               std::span<const double> cosines, std::span<const double> azimuths) const;

  /// By position.
  std::vector<StackField> fields(const StackLight& light, std::span<const StackPosition> positions) const;

  /// Of rings of directions, between cosines above the stack that fall from 1 to 0 and divide them (without 1
  /// and 0). Light comes from above. Transmitted is what arrives below, or at the substrate, by the same
  /// ranges of n sin(theta).
  StackChannels channels(std::span<const double> dividing_cosines) const;

private:
  StackDescription description_;
  DiscreteOrdinates method_;
};

}  // namespace aureole::optics
