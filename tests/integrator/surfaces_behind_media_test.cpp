// SPDX-License-Identifier: Apache-2.0
// Integrators that composite media before a nested integrator: it sees every surface that rays reach, at any angle and distance.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "harness/paths.h"
#include "integrator/dvr_test_support.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

/// A cube of half a side with a medium, far beside everything else.
std::string cube_beside(const std::string& medium) {
  return R"(<shape type="cube"><transform name="to_world"><scale value="0.5"/><translate x="3000" y="-2000" z="9000"/></transform>
    <bsdf type="null"/>)" +
         medium + "</shape>";
}

// A plane that emits on one side: rays that a rounding error lets begin behind it find no light.
TEST(SurfacesBehindMedia, AreSeenAtFlatAnglesAndFromAfar) {
  const SplatFolder splats;
  const VolumeFolder volumes;
  const auto splat = splats.write("s.ply", make_ply({PlainSplat{}}));
  const auto grid = write_bytes(volumes.path() / "g.vol", make_vol({2, 2, 2}, 1, kOnes).bytes());
  std::string values = grid_xml(grid);
  values.insert(values.find(' '), R"( name="value")");
  // Splats and radiance grids have places of their own, whatever shape they are in.
  const std::string there =
      R"(<transform name="to_world"><translate x="3000" y="-2000" z="9000"/></transform>)";
  const auto of_file = [&](const char* type, const std::filesystem::path& file) {
    return fmt::format(R"(<medium type="{}" name="interior"><string name="filename" value="{}"/>{}</medium>)",
                       type, file.string(), there);
  };
  const std::pair<const char*, std::string> media[] = {
      {"splat", of_file("splats", splat)},
      {"radiance_field", of_file("radiance_grid", source_dir() / "tests/medium/data/radiance/sh0.npz")},
      {"dvr", R"(<medium type="classified" name="interior"><string name="opacity" value="0 0.1, 1 0.1"/>)" +
                  values + "</medium>"}};
  for (const auto& [integrator, medium] : media) {
    const auto loaded = scene_of(
        std::string(integrator) + R"("><integrator type="path"/>)",
        cube_beside(medium) +
            R"(<shape type="rectangle"><transform name="to_world"><scale value="5000"/><rotate x="1" y="0.3" z="0.1" angle="37"/>
    <translate x="1.3" y="-0.7" z="2.1"/></transform><emitter type="area"><spectrum name="radiance" type="d65"/></emitter></shape>)");
    loaded.integrator->require_scene(*loaded.scene);
    // Axes of the plane: its first shape's frame, by Rodrigues' formula in double precision.
    const double angle = 37 * M_PI / 180, n = std::sqrt(1 + 0.3 * 0.3 + 0.1 * 0.1);
    const double k[3] = {1 / n, 0.3 / n, 0.1 / n};
    const auto rotated = [&](double x, double y, double z) {
      const double dot = k[0] * x + k[1] * y + k[2] * z, c = std::cos(angle), s = std::sin(angle);
      return std::array<double, 3>{x * c + (k[1] * z - k[2] * y) * s + k[0] * dot * (1 - c),
                                   y * c + (k[2] * x - k[0] * z) * s + k[1] * dot * (1 - c),
                                   z * c + (k[0] * y - k[1] * x) * s + k[2] * dot * (1 - c)};
    };
    const auto u = rotated(1, 0, 0), v = rotated(0, 1, 0), w = rotated(0, 0, 1);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform;
    int missed = 0;
    constexpr int kRays = 2000;
    for (int i = 0; i < kRays; ++i) {
      // Heights of a millimetre to 10 m, grazing angles down to 1/300, places up to 1 km from the middle.
      const double height = std::pow(10.0, -3 + 4 * uniform(random)),
                   tangent = std::pow(10.0, -2.5 + 3 * uniform(random));
      const double turn = 2 * M_PI * uniform(random), far = std::pow(10.0, 3 * uniform(random)),
                   at = 2 * M_PI * uniform(random);
      Vec3 origin, direction;
      for (int c = 0; c < 3; ++c) {
        const auto s = std::size_t(c);
        const double middle[] = {1.3, -0.7, 2.1};
        origin[c] = float(middle[c] + far * (std::cos(at) * u[s] + std::sin(at) * v[s]) + height * w[s]);
        direction[c] = float(std::cos(turn) * u[s] + std::sin(turn) * v[s] - tangent * w[s]);
      }
      const Seen seen = look(loaded, {origin, normalize(direction)}, i);
      missed += !(std::abs(seen.radiance - 1) < 1e-3 && seen.alpha == 1);
    }
    EXPECT_EQ(missed, 0) << integrator << ": rays of " << kRays << " that miss the plane";
  }
}

}  // namespace
}  // namespace aureole::test
