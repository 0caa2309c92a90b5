// SPDX-License-Identifier: Apache-2.0
// Stacks of plane layers that absorb and scatter, with interfaces between them and a substrate below: coats
// of paint, leaves, prints, slabs between slides. The equation of radiative transfer for unpolarised light at
// one wavelength is solved by discrete ordinates with adding and doubling (Chandrasekhar 1960, Radiative
// Transfer; van de Hulst 1980, Multiple Light Scattering).
//
// Layers are counted from the top. "Down" is the direction from the medium above the stack to the one below.
// Cosines of propagation directions are positive for upward and negative for downward light, in the local
// medium; those of incident beams are given as positive numbers. Azimuth 0 is the half-plane in which the
// incident beam continues: the mirror direction has azimuth 0. Functions throw std::domain_error, with the
// layer or the value, for invalid input.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "aureole/optics/stack/legendre_phase.h"

namespace aureole::optics {

enum class InterfaceKind { smooth, beckmann, ggx };

/// An interface between two media; with equal indices it has no effect. A rough interface has microfacets
/// that reflect and refract as a smooth one does (Walter, Marschner, Li & Torrance 2007, (20), (21)), with
/// Smith masking for each direction. The energy that single scattering by microfacets loses is added as lobes
/// on both sides (Kulla & Conty 2017), so that energy is conserved.
struct StackInterface {
  InterfaceKind kind = InterfaceKind::smooth;
  /// Roughness of the microfacets, in [0.05, 1]. It is about the width of the lobes: radiances of beams need
  /// some 8/alpha streams.
  double alpha = 0.1;
};

struct StackLayer {
  double absorption = 0;  ///< absorption coefficient sigma_a, in 1/length
  double scattering = 0;  ///< scattering coefficient sigma_s, in 1/length
  double thickness = 0;   ///< thickness in the same unit of length; may be infinite
  LegendrePhase phase = LegendrePhase::isotropic();
  double index = 1;      ///< index of refraction
  StackInterface top{};  ///< interface to the layer above, or to the medium above the stack

  /// Returns a layer whose unit of length is the mean free path.
  static StackLayer of_optical_thickness(double optical_thickness, double albedo,
                                         LegendrePhase phase = LegendrePhase::isotropic(), double index = 1) {
    return {1 - albedo, albedo, optical_thickness, std::move(phase), index};
  }
  double extinction() const { return absorption + scattering; }
};

struct StackDescription {
  std::vector<StackLayer> layers;
  double index_above = 1;
  /// Reflectance, in [0, 1], of a Lambertian surface below the last layer; 0 is black. Empty: there is a
  /// medium below, from which light may come.
  std::optional<double> substrate;
  /// Reflection by a substrate in addition to its Lambertian part, in the medium of the last layer: a
  /// specular reflectance of the cosine, and a reciprocal BRDF in 1/sr of two cosines and the azimuth. Null:
  /// none.
  std::function<double(double)> mirror{};
  std::function<double(double, double, double)> brdf{};
  double index_below = 1;   ///< index of the medium below, used without a substrate
  StackInterface bottom{};  ///< interface below the last layer, used without a substrate
};

struct DiscreteOrdinates {
  /// Number of discrete directions, an even number; half of them go down. 2 is a two-flux, 4 a four-flux
  /// theory. If indices differ, the directions are distributed over the ranges between the critical angles.
  int streams = 32;
  /// Delta-M scaling: forward peaks that the streams cannot resolve are treated as unscattered light
  /// (Wiscombe 1977, J. Atmos. Sci. 34, 1408). Radiances of beams then have exact single scattering (method
  /// TMS of Nakajima & Tanaka 1988, J. Quant. Spectrosc. Radiat. Transfer 40, 51). Without it the phase
  /// function is truncated at its moment `streams` - 1.
  bool delta_m = true;
  /// Number of azimuthal modes of radiances, at most `streams`; 0: `streams`. With rough interfaces all modes
  /// contribute; lobes several degrees wide need fewer.
  int modes = 0;
};

/// Light of irradiance 1 on the stack, from a beam or, without a cosine, from a uniform (Lambertian) sky.
struct StackLight {
  std::optional<double> cosine;  ///< cosine of the beam in (0, 1], in the medium of incidence
  bool from_below = false;

  static StackLight beam(double cosine, bool from_below = false) { return {cosine, from_below}; }
  static StackLight diffuse(bool from_below = false) { return {std::nullopt, from_below}; }
};

/// Fractions of the incident flux. For light from below "reflected" is the light that returns downward.
struct StackFluxes {
  /// Fractions of all light. With a substrate, transmittance is the fraction that the substrate absorbs.
  double reflectance = 0, transmittance = 0;
  /// Fractions of unscattered light: light reflected by interfaces, and light that crosses all layers. With a
  /// substrate, the latter is the fraction of the light on its first arrival that is absorbed.
  double unscattered_reflectance = 0, unscattered_transmittance = 0;
  double absorptance() const { return 1 - reflectance - transmittance; }  ///< fraction that the layers absorb
};

/// A depth below the top of a layer, in the layer's unit of length. Interfaces are not part of the layer.
struct StackPosition {
  int layer = 0;
  double depth = 0;
};

/// Light at a position, per irradiance on the stack, including unscattered light.
struct StackField {
  double flux_down = 0, flux_up = 0;
  double fluence_down = 0, fluence_up = 0;  ///< radiance integrated over the directions of each hemisphere
  double unscattered_flux_down = 0, unscattered_flux_up = 0;
  /// Coefficients that make the two-flux equations dF_down/dz = -(K + S) F_down + S' F_up exact here, in
  /// 1/length: K is the fraction of a flux absorbed per length, S the fraction scattered backward (Bohren &
  /// Clothiaux 2006, chapter 5; Kubelka & Munk 1931 assume constants). With 2 streams and without `delta_m`
  /// they are constant over depth. 0 if there is no flux.
  double absorption_down = 0, absorption_up = 0;    ///< K
  double backscatter_down = 0, backscatter_up = 0;  ///< coefficient S of the downward and of the upward flux
};

/// Fluxes between rings of directions: row i, column j is the flux that leaves in ring i for irradiance 1,
/// uniform over ring j.
struct StackChannels {
  std::vector<double> projected_solid_angle;  ///< projected solid angle of each ring, pi (mu_a^2 - mu_b^2)
  std::vector<double> reflected, transmitted;
};

class PlaneStack {
public:
  explicit PlaneStack(StackDescription description, DiscreteOrdinates method = {});

  const StackDescription& description() const { return description_; }
  const DiscreteOrdinates& method() const { return method_; }

  StackFluxes fluxes(const StackLight& light) const;
  std::vector<StackFluxes> fluxes(std::span<const StackLight> lights) const;

  /// Returns the radiance above the stack (cosines > 0) and, without a substrate, below it (< 0), per
  /// irradiance, in 1/sr, by light, cosine and azimuth (radians). For a beam it is the BRDF and BTDF without
  /// the deltas of unscattered light; for diffuse light it includes unscattered light.
  std::vector<double> radiance(std::span<const StackLight> lights, std::span<const double> cosines,
                               std::span<const double> azimuths) const;
  /// Returns the radiance at a position within a layer, in all directions, with the same units and order.
  std::vector<double> radiance(std::span<const StackLight> lights, const StackPosition& position,
                               std::span<const double> cosines, std::span<const double> azimuths) const;

  /// Returns the light at each position.
  std::vector<StackField> fields(const StackLight& light, std::span<const StackPosition> positions) const;

  /// Returns the fluxes between rings of directions, for light from above. The rings are bounded by
  /// `dividing_cosines` above the stack, which fall from 1 to 0 (both excluded). Transmitted light arrives
  /// below, or at the substrate, in equal ranges of n sin(theta).
  StackChannels channels(std::span<const double> dividing_cosines) const;

private:
  StackDescription description_;
  DiscreteOrdinates method_;
};

}  // namespace aureole::optics
