// SPDX-License-Identifier: Apache-2.0
// Theories of a film of paint over a card, in one form, so that data can choose between them: two fluxes with
// Saunderson's interface, and transport (streams) with the interface's own reflection by angle.
//
// A film is described by K = 2 sigma_a X and S = 3/4 sigma_s (1 - g) X, with X its thickness
// (transport_coefficients.h, `three_quarters`), in both theories. Fits work with ln K and ln S.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// The interface and the phase function of the theory by streams.
struct StreamsSettings {
  double index = 1.5;  ///< index of refraction of the binder, relative to air
  double g = 0.8;      ///< mean cosine of Henyey and Greenstein's phase function
  Geometry geometry = Geometry::diffuse_8;
  Specular specular = Specular::excluded;
  int streams = 16;
  /// Whether layers may have mean cosines of their own (`FilmLayer::g_shift`).
  bool varies_g = false;
};

/// A measured reflectance or transmittance as a theory predicts it, with its derivatives.
struct FilmValue {
  double value = 0;
  double by_ln_k = 0, by_ln_s = 0;  ///< derivatives by ln K and ln S
  double by_substrate = 0;          ///< derivative by the substrate's inner reflectance
  double by_g_shift = 0;            ///< derivative by `FilmLayer::g_shift`
};

/// A layer of paint as the input of a film theory.
struct FilmLayer {
  double ln_k = 0, ln_s = 0;
  /// ln((1 - g)/(1 - g0)), with g the mean cosine of scattering in this layer and g0 the theory's
  /// `mean_cosine`. Theories without directions ignore it.
  double g_shift = 0;
};

/// The light that an instrument receives from a film, as a function of the card below it.
struct FilmLight {
  double seen = 0;  ///< reflected by the interface and by the film, without the card
  double pass =
      0;  ///< fraction of the light that reaches the card, times that of the card's light that is received
  double inside = 0;  ///< fraction of the card's light that the film and the interface send back to it
  /// Reflectance over a card of this inner reflectance.
  double over(double substrate) const { return seen + pass * substrate / (1 - inside * substrate); }
};

/// A film without the interface above it: its reflectance for diffuse light over a substrate of inner reflectance g is
/// reflectance + transmittance2 g/(1 - back g).
struct InnerFilm {
  double reflectance = 0, transmittance2 = 0, back = 0;
};
/// The film whose light is this one under a Saunderson interface. Of two fluxes it has Kubelka and Munk's R, T^2 and R; of
/// streams it makes two fluxes under the interface reflect as the streams do, over every card. Values outside [0, 1], by
/// rounding or by an interface that is not that of the theory, are set to the limits.
InnerFilm inner_film(const FilmLight& light, const Surface& surface);

class FilmTheory {
public:
  virtual ~FilmTheory() = default;
  virtual std::string name() const = 0;
  /// Inner reflectance, in [0, 1], of a card that was measured bare. The card is assumed to be a Lambertian
  /// surface under an interface like the paint's. Values below the interface's own reflectance give 0.
  virtual double card(double measured) const = 0;
  /// The mean cosine g0 of the theory, if layers may differ from it (`FilmLayer::g_shift`).
  virtual std::optional<double> mean_cosine() const { return std::nullopt; }
  /// The settings of a theory by streams; nothing for other theories.
  virtual std::optional<StreamsSettings> streams() const { return std::nullopt; }
  /// Reflectance of a film over a card of this inner reflectance.
  virtual FilmValue over(const FilmLayer& layer, double substrate) const = 0;
  /// Reflectance of a layer so thick that nothing below it matters; of K and S only K/S counts.
  virtual FilmValue opaque(const FilmLayer& layer) const = 0;
  /// The light of a film over any card, without derivatives: for searches that evaluate millions of layers.
  virtual FilmLight light(const FilmLayer& layer) const = 0;
  /// The value of `opaque`, without derivatives.
  virtual double opaque_value(const FilmLayer& layer) const { return opaque(layer).value; }
  /// Reflectance or transmittance, as measured, of a free film with an interface on each side. Transmittance is that of all
  /// light that leaves below, unscattered light included.
  virtual FilmValue free_reflectance(const FilmLayer& layer) const = 0;
  virtual FilmValue free_transmittance(const FilmLayer& layer) const = 0;
};

/// Reflectances of opaque layers by a theory, for searches that evaluate millions of them. They are tabulated over the inner reflectance
/// S/(K + S + sqrt(K^2 + 2 K S)) of two fluxes, of which that of a theory is a smooth function, so that no logarithm is needed. The
/// difference from `FilmTheory::opaque` is below 1e-5. Layers have the theory's own mean cosine.
class OpaqueReflectance {
public:
  explicit OpaqueReflectance(const FilmTheory& theory);
  double operator()(double k, double s) const {
    constexpr double kTiny = 1e-300;  // avoids 0/0 for a paint with K = S = 0
    const double x = kCells * s / (k + s + std::sqrt(k * (k + 2 * s)) + kTiny);
    const int i = std::min(int(x), kCells - 1);
    const double t = x - i, *v = values_.data() + i;
    return v[1] + 0.5 * t *
                      (v[2] - v[0] +
                       t * (2 * v[0] - 5 * v[1] + 4 * v[2] - v[3] + t * (3 * (v[1] - v[2]) + v[3] - v[0])));
  }

private:
  static constexpr int kCells = 1024;
  std::vector<double> values_;  ///< at the nodes, and one extrapolated value beyond each end
};

/// Kubelka and Munk's two fluxes under a Saunderson interface.
std::unique_ptr<FilmTheory> two_flux_theory(const Surface& surface);

/// Radiative transfer by discrete ordinates (optics/stack). Solutions are tabulated once over ln K and ln S
/// (some 0.5 s) and interpolated by cubic polynomials, with an error below 1e-4 in reflectance. With `varies_g`
/// there is such a table for each of up to nine mean cosines, 0.3 of ln(1 - g) apart, with 1 - g from 0.05 to 1.3
/// and no more than a factor of 3.3 from 1 - `g`; layers beyond use the nearest table. Free films have tables of their own, made
/// when the first one is wanted: reflectance is without the light that both interfaces reflect specularly where this is excluded,
/// and transmittance is for a beam at 8 degrees (`diffuse_8`), along the normal (`angle_45_0`), or for diffuse light.
std::unique_ptr<FilmTheory> streams_theory(const StreamsSettings& settings,
                                           const ParallelFor& threads = serial_for);

/// The tables of the theory by streams, for callers that keep them.
struct StreamsTables {
  int first_g = 0, last_g = 0;              ///< tables, in steps of ln(1 - g) from the theory's own g
  std::vector<std::array<float, 4>> nodes;  ///< logarithms of the film's parts, by table, ln K, ln S
  std::vector<double> opaque;               ///< reflectances of opaque layers, by table and ln(K/S)
  /// of the interface without a film: the fraction of a card's light that is received, that returns to the card, and
  /// what the interface reflects
  double bare = 1, bare_inside = 0, gloss = 0;

  /// Calls `all` with the members; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.first_g, self.last_g, self.nodes, self.opaque, self.bare, self.bare_inside, self.gloss);
  }
};
/// Returns the tables of `streams_theory` with these settings.
StreamsTables streams_tables(const StreamsSettings& settings, const ParallelFor& threads = serial_for);
/// Returns the theory of tables that `streams_tables` has made with the same settings.
std::unique_ptr<FilmTheory> streams_theory(const StreamsSettings& settings, StreamsTables tables);

}  // namespace aureole::pigment
