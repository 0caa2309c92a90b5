// SPDX-License-Identifier: Apache-2.0
// Layers of circles for the tests of the BSDF `correlated_scatterers`, and integrals over the directions that they
// scatter into, through optics:: only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>

#include "aureole/bsdf/bsdf.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing::layer_cases {

inline const Spectrum kLambdas =
    make_spectrum([](int i) { return 400.f + 350.f / kWavelengths * (float(i) + 0.3f); });

struct LayerCase {
  std::string scatterer = "apertures", substrate = "none", radius = "5um", correlation_radius = "5um";
  double area_fraction = 0.5;
  std::string extra = "";

  std::shared_ptr<Bsdf> build() const {
    std::string xml = R"(<bsdf type="correlated_scatterers"><string name="scatterer" value=")" + scatterer +
                      R"("/><string name="substrate" value=")" + substrate +
                      R"("/><string name="radius" value=")" + radius +
                      R"("/><string name="correlation_radius" value=")" + correlation_radius +
                      R"("/><float name="area_fraction" value=")" + std::to_string(area_fraction) +
                      R"("/><float name="ext_ior" value="1"/>)";
    if (substrate != "none") xml += R"(<float name="int_ior" value="1.5"/>)";
    return testing::build<Bsdf>(xml + extra + "</bsdf>");
  }
  double a() const { return std::stod(correlation_radius) * 1e-6; }
  double b() const { return std::stod(radius) * 1e-6; }
  /// Made once for each of the few layers: its total is an integral.
  const optics::ScattererLayer& layer() const {
    static std::map<std::tuple<double, double, double>, optics::ScattererLayer> layers;
    return layers.try_emplace({b(), a(), area_fraction}, b(), a(), area_fraction).first->second;
  }
  double index(double z) const { return substrate == "dielectric" && z < 0 ? 1.5 : 1; }
  /// Reflectance for a direction with transverse index p = n sin, from the side with index n; one beyond the
  /// critical angle.
  double reflectance(double p, double n) const {
    if (substrate == "none") return 0;
    const double cosine = std::sqrt(1 - p * p / (n * n));
    return substrate == "dielectric" ? optics::fresnel_reflectance(cosine, n, 2.5 - n)
                                     : optics::thin_slab_reflectance(cosine, 1, 1.5);
  }
};

inline std::string text(const char* name, const std::string& value) {
  return std::string("<string name=\"") + name + "\" value=\"" + value + "\"/>";
}

class Context {
public:
  explicit Context(TransportMode mode = TransportMode::radiance, const Spectrum& nm = kLambdas)
      : wavelengths_(Wavelengths::at(SpectralGrid{}, nm)), ctx{wavelengths_, point_, mode, 0} {}

private:
  SurfacePoint point_;
  Wavelengths wavelengths_;

public:
  BsdfContext ctx;
};

inline Vec3 direction(double degrees, double azimuth_degrees = 0) {
  const double t = degrees * std::numbers::pi / 180, f = azimuth_degrees * std::numbers::pi / 180;
  return {float(std::sin(t) * std::cos(f)), float(std::sin(t) * std::sin(f)), float(std::cos(t))};
}

/// Energies at each wavelength of `kLambdas`.
using Energies = std::array<double, kWavelengths>;

/// Integrals over all directions wo of a function whose values are spectra, in polar coordinates of q around
/// the specular directions, in rings fine enough for the wavelength `nm` and longer ones.
template <class Function>
Energies integrate(const LayerCase& s, const Vec3& wi, double nm, const Function& f) {
  const double k = 2 * std::numbers::pi / (nm * 1e-9), n_i = s.index(wi.z), phase = k * s.a();
  const double u_max = phase * (1.5 + n_i);
  // The intensity swings with a period of pi in u.
  const int rings = std::max(1000, int(u_max * test::effort(6, 12))), azimuths = test::effort(120, 240);
  Energies sum{};
  for (int i = 0; i < rings; ++i) {
    const double u = (i + 0.5) * u_max / rings,
                 area = u * (u_max / rings) * 2 * std::numbers::pi / azimuths / (phase * phase);
    for (int m = 0; m < azimuths; ++m) {
      const double phi = 2 * std::numbers::pi * (m + 0.5 * (i % 2)) / azimuths;
      const double x = u / phase * std::cos(phi) - n_i * wi.x, y = u / phase * std::sin(phi) - n_i * wi.y;
      for (double side : {1., -1.}) {
        const double n = s.index(side), c2 = 1 - (x * x + y * y) / (n * n);
        if (c2 <= 1e-9) continue;
        const double z = std::sqrt(c2), weight = area / (n * n * z);
        const Spectrum value = f(Vec3{float(x / n), float(y / n), float(side * z)});
        for (int j = 0; j < kWavelengths; ++j) sum[std::size_t(j)] += value[j] * weight;
      }
    }
  }
  return sum;
}

}  // namespace aureole::testing::layer_cases
