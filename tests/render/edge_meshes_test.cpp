// SPDX-License-Identifier: Apache-2.0
// Edges of meshes: a box of few or of many faces has the same light, and meshes that are open, that cut through themselves or that hold
// faces twice or of no extent render, too.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "harness/effort.h"
#include "render/edge_scenes.h"

namespace aureole::test {
namespace {

using testing::Picture;

std::string obj(const std::filesystem::path& file, double reflectance) {
  return R"(<shape type="obj"><string name="filename" value=")" + file.string() +
         R"("/><bsdf type="freespacediffraction"><float name="scale" value="1"/>)" + grey(reflectance) +
         "</bsdf></shape>";
}

/// Writes the box [-half, half]^3 about a place, each face in pieces x pieces quadrilaterals, without the first `open` faces. Returns how
/// many vertices there are after it.
int write_box(std::ofstream& mesh, double half, double x, int pieces, int open = 0, int vertices = 0) {
  for (int face = open; face < 6; ++face) {
    const int axis = face / 2, side = face % 2 ? 1 : -1;
    for (int i = 0; i <= pieces; ++i)
      for (int j = 0; j <= pieces; ++j) {
        double p[3];
        p[axis] = half * side;
        p[(axis + 1) % 3] = half * side * (2.0 * i / pieces - 1),
                       p[(axis + 2) % 3] = half * (2.0 * j / pieces - 1);
        mesh << fmt::format("v {} {} {}\n", p[0] + x, p[1], p[2]);
      }
    for (int i = 0; i < pieces; ++i)
      for (int j = 0; j < pieces; ++j) {
        const int at = vertices + 1 + i * (pieces + 1) + j;
        mesh << fmt::format("f {} {} {} {}\n", at, at + pieces + 1, at + pieces + 2, at + 1);
      }
    vertices += (pieces + 1) * (pieces + 1);
  }
  return vertices;
}

TEST(EdgeMeshes, ABoxInManyFacesHasTheLightOfOneInFew) {
  const TemporaryFolder folder;
  const auto box = [&](int pieces) {
    const auto file = folder.path / fmt::format("box{}.obj", pieces);
    std::ofstream mesh(file);
    write_box(mesh, 0.3, 0, pieces);
    mesh.close();
    return obj(file, 0);
  };
  const std::string whole = box(1), fine = box(8);
  const struct {
    const char *name, *lamp, *receiver;
    double least, most;  ///< of the light without a box
  } places[] = {{"in the shadow", "-0.8, -0.1, 0.7", "0.9, 0, -0.4", 1e-4, 0.1},
                {"beside the box", "0.33, 0.02, 2", "0.31, 0, -2", 0.3, 0.95}};
  for (const auto& place : places)
    for (const char* integrator : {"path", "ptracer"}) {
      const EdgeMethod method{integrator, effort(2048, 16384), 3};
      const auto measured_at = [&](const std::string& scene, std::uint64_t seed) {
        return measured(scene + point(place.lamp), method, receiver(place.receiver), seed);
      };
      const Picture a = measured_at(whole, 1), b = measured_at(fine, 2);
      expect_equal(fmt::format("{}, {}", place.name, integrator), a, b, 0.05);
      const double free = measured_at("", 3).all;
      if (kSanitized) continue;
      EXPECT_GT(a.all, place.least * free) << place.name;
      EXPECT_LT(a.all, place.most * free) << place.name;
    }
}

struct OddMesh {
  const char* name;
  void (*write)(std::ofstream& mesh);
};
const OddMesh kOddMeshes[] = {
    {"two cubes that cut through each other",
     [](std::ofstream& mesh) { write_box(mesh, 0.3, 0.2, 1, 0, write_box(mesh, 0.3, -0.1, 2)); }},
    {"two cubes of which one shares a plane with the other",
     [](std::ofstream& mesh) { write_box(mesh, 0.2, 0.1, 1, 0, write_box(mesh, 0.3, 0, 1)); }},
    {"box without a lid", [](std::ofstream& mesh) { write_box(mesh, 0.3, 0, 3, 1); }},
    {"box of two sides", [](std::ofstream& mesh) { write_box(mesh, 0.3, 0, 1, 4); }},
    {"a cube twice", [](std::ofstream& mesh) { write_box(mesh, 0.3, 0, 1, 0, write_box(mesh, 0.3, 0, 1)); }},
    {"three sheets on one edge, one a needle, one a face of no extent",
     [](std::ofstream& mesh) {
       mesh << "v -0.4 0 0\nv 0.4 0 0\nv 0 0.4 0.2\nv 0 -0.4 0.2\nv 0 0 -0.4\nv 0.4 0.4 0\nv 0.4 0.400001 0\n"
               "f 1 2 3\nf 2 1 4\nf 1 2 5\nf 1 6 7\nf 1 2 2\n";
     }},
    {"a sheet that crosses itself", [](std::ofstream& mesh) {
       mesh << "v -0.4 -0.3 0\nv 0.4 -0.3 0\nv 0.4 0.3 0.3\nv -0.4 0.3 -0.3\nv 0.4 0.3 -0.3\nv -0.4 0.3 0.3\n"
               "f 1 2 3 4\nf 1 2 5 6\n";
     }}};

TEST(EdgeMeshes, ThoseThatCloseNoBodyRender) {
  const TemporaryFolder folder;
  for (const OddMesh& odd : kOddMeshes) {
    const auto file = folder.path / "odd.obj";
    std::ofstream mesh(file);
    odd.write(mesh);
    mesh.close();
    const std::string scene = walls() + obj(file, 0.5) + point("-0.3, 0.1, 0.9");
    for (const char* integrator : kIntegrators) {
      const auto render = [&](bool diffraction) {
        return measured(scene, {integrator, 512, 5, diffraction}, receiver("0.45, 0.2, -0.6"), 1);
      };
      const Picture with = render(true), without = render(false);
      std::printf("%s, %s: %.4f +- %.2g, without diffraction %.4f +- %.2g\n", odd.name, integrator, with.all,
                  with.all_error, without.all, without.all_error);
      EXPECT_TRUE(std::isfinite(with.all) && std::isfinite(with.all_error)) << odd.name << " " << integrator;
      if (kSanitized) continue;
      EXPECT_GT(with.all, 0.5 * without.all) << odd.name << " " << integrator;
      EXPECT_LT(with.all, 2 * without.all) << odd.name << " " << integrator;
      EXPECT_NE(with.all, without.all) << odd.name << " " << integrator;
    }
  }
}

}  // namespace
}  // namespace aureole::test
