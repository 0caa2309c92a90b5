// SPDX-License-Identifier: Apache-2.0
#include "aureole/volume/vdb/vdb_module.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <new>
#include <stdexcept>

#include "vdb_lengths.h"

namespace aureole {
namespace {

/// What is wrong with a file that OpenVDB can read.
struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::array<float, 3> numbers(float v) { return {v, 0, 0}; }
std::array<float, 3> numbers(double v) { return {float(v), 0, 0}; }
template <class T>
std::array<float, 3> numbers(const openvdb::math::Vec3<T>& v) {
  return {float(v[0]), float(v[1]), float(v[2])};
}

SparseVoxels::Coordinates coordinates(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

/// False where the grid has another type.
template <class Grid>
bool convert(const openvdb::GridBase::Ptr& base, int channels, SparseVoxels& out) {
  const auto grid = openvdb::gridPtrCast<Grid>(base);
  if (!grid) return false;
  using Tree = typename Grid::TreeType;
  static_assert(Tree::LeafNodeType::DIM == SparseVoxels::kEdge);
  const Tree& tree = grid->tree();
  out.channels = channels;
  out.background = numbers(tree.background());
  out.values.reserve(std::size_t(tree.leafCount()) * SparseVoxels::kBlockVoxels * std::size_t(channels));
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const auto* values = leaf->buffer().data();
    if (!values) throw Fault("a part of the grid has no values");
    add_block(
        out, coordinates(leaf->origin()), [&](int i) { return leaf->isValueOn(openvdb::Index(i)); },
        [&](int i) { return numbers(values[i]); });
  }
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const openvdb::CoordBBox box = tile.getBoundingBox();
    out.tiles.push_back({coordinates(box.min()), coordinates(box.max()), numbers(*tile)});
    out.extend(out.tiles.back().lower, out.tiles.back().upper);
  }
  return true;
}

void read(const char* path, const char* wanted, SparseFile& out) {
  if (!vdb_lengths_are_good(path)) throw Fault("is damaged: a length in its header leads beyond its end");
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  for (auto name = file.beginName(); name != file.endName(); ++name)
    out.grids.push_back(openvdb::Name(name.gridName()));
  if (out.grids.empty()) throw Fault("holds no grids");
  const std::string name = wanted ? wanted : out.grids[default_grid(out.grids)];
  if (!file.hasGrid(name)) return;
  out.found = true;
  const openvdb::GridBase::Ptr grid = file.readGrid(name);
  file.close();
  SparseVoxels& voxels = out.voxels;
  voxels.name = name;
  if (grid->getGridClass() == openvdb::GRID_LEVEL_SET)
    throw Fault("the grid \"" + name + "\" is a level set: distances from a surface, and no density");
  if (!grid->transform().isLinear())
    throw Fault("the grid \"" + name + "\" has a transform that is not linear (a frustum); resample it");
  const openvdb::Mat4R m = grid->transform().baseMap()->getAffineMap()->getMat4();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) voxels.to_space[std::size_t(i)][std::size_t(j)] = m(j, i);  // row vectors
  if (!convert<openvdb::FloatGrid>(grid, 1, voxels) && !convert<openvdb::DoubleGrid>(grid, 1, voxels) &&
      !convert<openvdb::Vec3SGrid>(grid, 3, voxels) && !convert<openvdb::Vec3DGrid>(grid, 3, voxels))
    throw Fault("the grid \"" + name + "\" holds values of type " + grid->valueType() +
                "; float, double, vec3s and vec3d are supported");
}

}  // namespace
}  // namespace aureole

extern "C" __attribute__((visibility("default"))) void aureole_read_vdb(const char* file, const char* grid,
                                                                        aureole::SparseFile& out) {
  try {
    aureole::read(file, grid, out);
  } catch (const aureole::Fault& problem) {
    out.error = problem.what();
  } catch (const openvdb::Exception& problem) {
    out.error = std::string("cannot be read by OpenVDB: ") + problem.what();
  } catch (const std::bad_alloc&) {
    out.error = "needs more memory than there is";
  } catch (...) {
    out.error = "is damaged";
  }
}
