// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/vdb/vdb_module.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <new>
#include <stdexcept>

#include "vdb_lengths.h"

namespace aureole {
namespace {

/// A fault in a file that OpenVDB itself accepts.
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

/// Converts a grid; returns false if it has another type.
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

/// The grids of a file in the order of their names. `openvdb::io::File` reads from its own stream, which
/// continues past the end of a file as if it contained zeros, so that a damaged count makes nodes until
/// memory is full. This class throws there.
class Grids : public openvdb::io::Archive {
public:
  explicit Grids(const char* path) : in_(path, std::ios::binary) {
    in_.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    readHeader(in_);
    if (!inputHasGridOffsets()) {
      // The grids follow one another without a list, and all of them are read.
      in_.seekg(0);
      const openvdb::GridPtrVecPtr all = openvdb::io::Stream(in_, /*delayLoad=*/false).getGrids();
      for (const openvdb::GridBase::Ptr& grid : *all) read_.emplace(grid->getName(), grid);
      return;
    }
    openvdb::io::setStreamMetadataPtr(in_, state_, /*transfer=*/false);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
    openvdb::MetaMap().readMeta(in_);
    for (std::int32_t left = readGridCount(in_); left > 0; --left) {
      openvdb::io::GridDescriptor entry;
      const openvdb::GridBase::Ptr grid = entry.read(in_);
      listed_.emplace(entry.uniqueName(), std::pair(entry, grid));
      entry.seekToEnd(in_);
    }
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, grid] : read_) all.push_back(name);
    for (const auto& [name, entry] : listed_) all.push_back(openvdb::io::GridDescriptor::nameAsString(name));
    return all;
  }
  /// Returns null if there is no grid of this name.
  openvdb::GridBase::Ptr read(const std::string& wanted) {
    if (const auto found = read_.find(wanted); found != read_.end()) return found->second;
    const auto entry = std::find_if(listed_.begin(), listed_.end(), [&](const auto& e) {
      return openvdb::io::GridDescriptor::nameAsString(e.first) == wanted ||
             e.second.first.gridName() == wanted;
    });
    if (entry == listed_.end()) return nullptr;
    const auto fill = [&](const auto& listed) {
      listed.first.seekToGrid(in_);
      readGrid(listed.second, listed.first, in_);
    };
    fill(entry->second);
    if (const auto& [descriptor, grid] = entry->second; descriptor.isInstance()) {
      // An instance uses the tree of another grid.
      NamedGridMap both{{descriptor.uniqueName(), grid}};
      if (const auto parent = listed_.find(descriptor.instanceParentName());
          parent != listed_.end() && !parent->second.first.isInstance()) {
        fill(parent->second);
        both.emplace(parent->first, parent->second.second);
      }
      connectInstance(descriptor, both);
    }
    return entry->second.second;
  }

private:
  openvdb::io::StreamMetadata::Ptr state_ = std::make_shared<openvdb::io::StreamMetadata>();
  std::ifstream in_;
  std::multimap<std::string, std::pair<openvdb::io::GridDescriptor, openvdb::GridBase::Ptr>> listed_;
  std::multimap<std::string, openvdb::GridBase::Ptr> read_;
};

void read(const char* path, const char* wanted, SparseFile& out) {
  if (const std::string fault = fault_of_vdb_header(path, openvdb::OPENVDB_FILE_VERSION); !fault.empty())
    throw Fault(fault);
  openvdb::initialize();
  Grids grids(path);
  out.grids = grids.names();
  if (out.grids.empty()) throw Fault("holds no grids");
  const std::string name = wanted ? wanted : out.grids[default_grid(out.grids)];
  const openvdb::GridBase::Ptr grid = grids.read(name);
  if (!grid) return;
  out.found = true;
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
  } catch (const std::ios_base::failure&) {
    out.error = "is damaged or truncated: its data end too early";
  } catch (const std::bad_alloc&) {
    out.error = "needs more memory than there is";
  } catch (...) {
    out.error = "is damaged";
  }
}
