// SPDX-License-Identifier: Apache-2.0
// Scenes of classified media, and the light of single rays through them.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/loading/load.h"
#include "aureole/spectrum/observer.h"
#include "volume/volume_test_support.h"

namespace aureole::test {

/// A classified medium in the unit cube whose numbers are `values` on a grid of that size.
inline std::string volume_of(const VolumeFolder& folder, const std::string& name,
                             const std::array<int, 3>& size, const std::vector<float>& values,
                             const std::string& parameters) {
  const auto file = write_bytes(folder.path() / (name + ".vol"), make_vol(size, 1, values).bytes());
  std::string grid = grid_xml(file);
  grid.insert(grid.find(' '), R"( name="value")");
  return R"(<shape type="cube"><transform name="to_world"><translate x="1" y="1" z="1"/><scale value="0.5"/>
      <scale value="1.02"/><translate x="-0.01" y="-0.01" z="-0.01"/></transform>
    <bsdf type="null"/><medium type="classified" name="interior">)" +
         grid + parameters + "</medium></shape>";
}

inline std::string text(const std::string& name, const std::string& value) {
  return R"(<string name=")" + name + R"(" value=")" + value + R"("/>)";
}

inline std::string number(const std::string& name, double value) {
  return R"(<float name=")" + name + R"(" value=")" + std::to_string(value) + R"("/>)";
}

inline LoadedScene scene_of(const std::string& integrator, const std::string& content) {
  return load_scene_from_string(R"(<scene version="3.0.0"><integrator type=")" + integrator +
                                    "</integrator>" + content +
                                    R"(<sensor type="perspective"><sampler type="sobol"/></sensor></scene>)",
                                "dvr.xml");
}
inline std::string dvr(const std::string& parameters) { return R"(dvr">)" + parameters; }

/// The light of one ray.
struct Seen {
  double radiance,
      spread;  ///< in units of the spectrum of D65, or of 1 where it is flat; largest minus smallest
  double alpha;
  float measures[4] = {0, 0, 0, 0};  ///< optical thickness, value, depth, lookups
};

inline Seen look(const LoadedScene& loaded, const Ray& ray, int sample = 0, bool flat = false) {
  const Scene& scene = *loaded.scene;
  const SpectralGrid grid = scene.wavelengths().grid();
  const SampledSpectrum d65 = d65_spectrum(grid, 1);
  const Sampler& sampler = scene.sensor().sensor->sampler();
  Path path;
  path.samples = SampleStream(sampler, 7, std::uint32_t(sample));
  path.wavelengths = scene.wavelengths().sample(path.samples.get1(2));
  path.samples.set_first(SampleStream::camera_dimensions(false));
  path.ray = ray;
  Seen seen;
  path.aovs = seen.measures;
  std::vector<Splat> splats;
  loaded.integrator->trace(scene, std::span(&path, 1), splats, {});
  Spectrum s = path.result.estimate * (path.wavelengths.pdf * float(kWavelengths));
  if (!flat) s = s / d65.eval(path.wavelengths);
  double low = 1e30, high = -1e30, sum = 0;
  for (int i = 0; i < kWavelengths; ++i)
    low = std::min(low, double(s[i])), high = std::max(high, double(s[i])), sum += double(s[i]);
  seen.radiance = sum / kWavelengths, seen.spread = high - low, seen.alpha = double(path.result.alpha);
  return seen;
}

inline const Ray kAlongZ{{0.5f, 0.5f, -1}, {0, 0, 1}}, kAlongX{{-1, 0.5f, 0.5f}, {1, 0, 0}};
inline const std::vector<float> kOnes(8, 1);

inline std::vector<float> ramp(int n) {
  std::vector<float> values;
  for (int i = 0; i < 4 * n; ++i) values.push_back((float(i % n) + 0.5f) / float(n));
  return values;
}

/// A smooth ball in the unit cube: its numbers fall from 1 in the middle.
inline std::string ball(const VolumeFolder& folder, const std::string& parameters, int n = 32) {
  std::vector<float> values;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const float at[3] = {(float(x) + 0.5f) / float(n) - 0.5f, (float(y) + 0.5f) / float(n) - 0.5f,
                             (float(z) + 0.5f) / float(n) - 0.5f};
        values.push_back(std::exp(-20 * (at[0] * at[0] + at[1] * at[1] + at[2] * at[2])));
      }
  return volume_of(folder, "ball", {n, n, n}, values, parameters);
}

inline const Ray kOblique{{-0.5f, -0.2f, -1}, {0.48f, 0.36f, 0.8f}};

/// Mean radiance of the samples 0 to count - 1 of a ray, and its standard error.
struct MeanRadiance {
  double mean = 0, error = 0;
};
template <class Scene>
MeanRadiance mean_radiance(const Scene& scene, const Ray& ray, int count, bool flat = false) {
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double x = look(scene, ray, i, flat).radiance;
    sum += x, squares += x * x;
  }
  const double mean = sum / count;
  return {mean, std::sqrt((squares / count - mean * mean) / count)};
}

inline std::string problem(const std::string& integrator, const std::string& content) {
  return error_thrown_by([&] {
    const auto scene = scene_of(integrator, content);
    scene.integrator->require_scene(*scene.scene);
  });
}

}  // namespace aureole::test
