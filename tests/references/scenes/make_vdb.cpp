// SPDX-License-Identifier: Apache-2.0
// Writes volumes/cloud.vdb, volumes/far.vdb and volumes/cloud.nvdb, the sparse grids of the tests, and values of them that OpenVDB itself interpolates:
//
//     g++ -std=c++17 -O1 -I /usr/include/Imath make_vdb.cpp -lopenvdb -ltbb -lImath-3_1 -lz -o /tmp/make_vdb && /tmp/make_vdb .
//
// (Debian's libopenvdb-dev and libnanovdb-dev, 10.0.1.) Grids: "density" (float), "temperature" (double, background 300), "color"
// (vectors), in the .nvdb file also "quantised" (density in 8 bits).
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_OPENVDB
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>

using namespace openvdb;

int main(int, char** arguments) {
  initialize();
  const std::string folder = std::string(arguments[1]) + "/volumes/";
  const auto density = FloatGrid::create(0);
  const auto temperature = DoubleGrid::create(300);
  const auto color = Vec3SGrid::create(Vec3f(0));
  density->setName("density"), temperature->setName("temperature"), color->setName("color");
  density->setGridClass(GRID_FOG_VOLUME);
  // Turned and stretched, and off the origin.
  Mat4R matrix = Mat4R::identity();
  matrix.setToRotation(Vec3d(1, 2, 3) / std::sqrt(14.), 0.5);
  matrix.preScale(Vec3d(0.1, 0.15, 0.2));
  matrix.postTranslate(Vec3d(1, -2, 3));
  const auto transform = math::Transform::createLinearTransform(matrix);
  density->setTransform(transform), temperature->setTransform(transform), color->setTransform(transform);
  auto d = density->getAccessor();
  auto t = temperature->getAccessor();
  auto c = color->getAccessor();
  for (int x = -9; x < 21; ++x)
    for (int y = 0; y < 9; ++y)
      for (int z = 0; z < 12; ++z) {
        const double r2 =
            std::pow((x - 6) / 14., 2) + std::pow((y - 4) / 4.5, 2) + std::pow((z - 5.5) / 6, 2);
        if (r2 >= 1) continue;
        const Coord at(x, y, z);
        d.setValue(at, float(1 - r2) * (1.2f + std::sin(0.9f * float(x) + 0.5f * float(z))));
        t.setValue(at, 300 + 1500 * (1 - r2));
        c.setValue(at, Vec3f(0.8f, 0.1f * float(y) + 0.1f, 0.2f));
      }
  // A tile: all of a block.
  density->tree().addTile(1, Coord(24, 0, 0), 0.75f, true);
  io::File file(folder + "cloud.vdb");
  file.setCompression(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
  file.write({temperature, density, color});

  // Two voxels far apart: a small file that describes a large box.
  GridPtrVec far;
  for (const auto& [name, distance] : {std::pair("near", 1000), std::pair("far", 1000000)}) {
    const auto grid = FloatGrid::create(0);
    grid->setName(name);
    auto voxels = grid->getAccessor();
    voxels.setValue(Coord(0), 1.f), voxels.setValue(Coord(distance), 1.f);
    far.push_back(grid);
  }
  io::File far_file(folder + "far.vdb");
  far_file.setCompression(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
  far_file.write(far);

  using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;
  std::vector<Handle> handles;
  handles.push_back(nanovdb::openToNanoVDB(*temperature));
  handles.push_back(nanovdb::openToNanoVDB(*density));
  handles.push_back(nanovdb::openToNanoVDB(*color));
  const auto quantised = density->deepCopy();
  quantised->setName("quantised");
  handles.push_back(nanovdb::openToNanoVDB<nanovdb::HostBuffer, FloatTree, nanovdb::Fp8>(*quantised));
  nanovdb::io::writeGrids(folder + "cloud.nvdb", handles, nanovdb::io::Codec::ZIP);

  std::FILE* const out =
      std::fopen((std::string(arguments[1]) + "/../../volume/data/vdb_values.txt").c_str(), "w");
  std::mt19937 random(1);
  const auto between = [&](double a, double b) { return a + (b - a) * double(random()) / 4294967296.; };
  for (int i = 0; i < 60; ++i) {
    const Vec3R index(between(-11, 33), between(-2, 10), between(-2, 14));
    const Vec3R p = Vec3R(Vec3f(transform->indexToWorld(index)));
    const tools::GridSampler<FloatGrid, tools::BoxSampler> linear(*density);
    const tools::GridSampler<FloatGrid, tools::PointSampler> nearest(*density);
    const tools::GridSampler<DoubleGrid, tools::BoxSampler> warm(*temperature);
    std::fprintf(out, "%.9g %.9g %.9g %.7g %.7g %.7g\n", p[0], p[1], p[2], double(linear.wsSample(p)),
                 double(nearest.wsSample(p)), warm.wsSample(p));
  }
  std::fclose(out);
}
