// SPDX-License-Identifier: Apache-2.0
// `PathOracle`: the value of one path, given by its vertices, and the pdf of every technique that can sample
// it, in double precision and by the textbook formula, product by product (Veach 1997, chapter 10; Wilkie et
// al. 2014). It shares no code with the integrators, which compute the same numbers recursively as ratios to
// those of the hero wavelength.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "aureole/spectrum/wavelengths.h"
#include "harness/oracle_scene.h"

namespace aureole::testing {

using PerWavelength = std::array<double, kWavelengths>;

struct OracleVertex {
  enum class Kind { surface, medium, point_light, sky, pinhole };
  Kind kind;
  Double3 p;                             ///< of the sky: the unit direction towards it
  const Rectangle* rectangle = nullptr;  ///< of a surface

  bool is_mirror() const { return rectangle && rectangle->material.kind == Material::Kind::mirror; }
};

/// The vertices of a path from the light to the pinhole.
using OraclePath = std::vector<OracleVertex>;

/// Values that the oracle takes from aureole, since the choice of a light by the tree of lights has tests of its
/// own. The light is that of the path's first vertex.
struct LightProbabilities {
  /// Of connecting the point `p` with the light; `facing`: the side that scatters light, or zero.
  std::function<double(const Double3& p, const Double3& facing, const OracleVertex& light)> of_connection;
};

class PathOracle {
public:
  /// Which techniques an integrator combines.
  enum class Method { path, ptracer, bdpt };

  PathOracle(const ClosedFormScene& scene, Method method, LightProbabilities probabilities)
      : scene_(scene), method_(method), probabilities_(std::move(probabilities)) {}

  /// The estimate that the path adds, whichever of the techniques has found it: per wavelength i, f_i /
  /// (p_lambda,i sum of the pdfs of all techniques and wavelengths). `f` includes the importance of a film
  /// whose rays are uniform over its area; with `is_splat` the estimate is per area of film [pixels^2].
  PerWavelength estimate(const OraclePath& path, const Wavelengths& w, bool is_splat) const;

  /// The measurement contribution of the path at a wavelength.
  double contribution(const OraclePath& path, double nm) const;
  /// The pdf of the technique that samples s vertices from the light and the others from the sensor.
  double pdf(const OraclePath& path, std::size_t s, double nm) const;
  /// The pdfs of all techniques of the method, in no particular order.
  std::vector<double> pdfs(const OraclePath& path, double nm, const Wavelengths& w) const;

  /// The least distance of a vertex from a neighbour or from the plane of its surface: how much rounded
  /// positions matter.
  double nearest_distance(const OraclePath& path) const;
  /// Whether nothing lies between two neighbouring vertices; nothing where rounding may decide.
  std::optional<bool> visible(const OracleVertex& a, const OracleVertex& b) const;
  /// The nearest surface along a ray, or else the sky.
  OracleVertex hit(const Double3& o, const Double3& d) const;
  /// The pixel coordinates at which a point is seen.
  std::array<double, 2> film_position(const Double3& p) const;
  /// Whether these are surely on the film.
  bool is_on_film(const Double3& p) const;
  Method method() const { return method_; }

private:
  /// Value without the cosine, and pdf per solid angle of sampling `to`; both directions point away from the
  /// vertex. Of a mirror both are factors of the same delta distribution.
  double scattering(const OracleVertex& v, const Double3& from, const Double3& to, double nm) const;
  double direction_pdf(const OracleVertex& v, const Double3& from, const Double3& to, double nm) const;
  double transmittance(const OracleVertex& a, const OracleVertex& b, double nm) const;
  /// Area or volume of the next vertex per solid angle, inverted; and the pdf of the free path, where it is
  /// in the fog.
  double arrival(const OracleVertex& from, const OracleVertex& to, double nm) const;
  double sensor_direction_pdf(const Double3& d) const;
  /// Of vertex i as found from the light, or from the sensor.
  double from_light(const OraclePath& path, std::size_t i, double nm) const;
  double from_sensor(const OraclePath& path, std::size_t i, double nm) const;
  double light_sampling(const OraclePath& path) const;
  /// Per length, of sampling the position of vertex 1 in the fog about the light.
  double equiangular(const OraclePath& path, const Wavelengths& w) const;
  double power_probability(const OracleVertex& light) const;
  double sky_disc_radius() const;
  /// The distances along a ray between which it is in the fog; empty where the second is not larger.
  std::pair<double, double> in_fog(const Double3& o, const Double3& d, double t_max) const;
  double extinction(double nm) const { return scene_.fog->scattering(nm) + scene_.fog->absorption(nm); }

  const ClosedFormScene& scene_;
  Method method_;
  LightProbabilities probabilities_;
};

}  // namespace aureole::testing
