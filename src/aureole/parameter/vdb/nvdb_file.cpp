// SPDX-License-Identifier: Apache-2.0
// NanoVDB stores a grid as one block of memory in which nodes refer to each other by offsets. Its own headers
// trust them; here every offset is checked before it is used, so that a damaged file is an error.
#include <blosc.h>
#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/memory.h"
#include "aureole/parameter/vdb/vdb_file.h"

namespace aureole {

namespace {

enum class Codec : std::uint16_t { none, zip, blosc };

// The header of a segment of a file, and the headers of its grids.
struct SegmentHead {
  char magic[8];
  std::uint32_t version;
  std::uint16_t grid_count;
  Codec codec;
};
struct GridHead {
  std::uint64_t grid_bytes, file_bytes, name_key, voxel_count;
  std::uint32_t type, grid_class;
  double world_box[6];
  std::int32_t index_box[6];
  double voxel_size[3];
  std::uint32_t name_bytes, node_count[4], tile_count[3];
  std::uint16_t codec, padding;
  std::uint32_t version;
};
static_assert(sizeof(SegmentHead) == 16 && sizeof(GridHead) == 176);

[[noreturn]] void fail_damaged() { throw Error("is damaged: its nodes do not lie inside of the file"); }

/// A grid in memory.
class Block {
public:
  explicit Block(std::uint64_t bytes) : size_(bytes) {
    constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 38;
    if (bytes < sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<3>) || bytes > kMaxBytes)
      throw Error(fmt::format("is damaged: it claims a grid of {} bytes", bytes));
    memory_.reset(new (std::align_val_t{kAlignment}) std::byte[bytes]);
  }
  char* data() { return reinterpret_cast<char*>(memory_.get()); }
  std::uint64_t size() const { return size_; }

  /// Returns the node at an offset from another one.
  template <class Node>
  const Node* at(const void* from, std::int64_t distance, std::uint64_t bytes = sizeof(Node)) const {
    const std::int64_t place = static_cast<const std::byte*>(from) - memory_.get();
    std::int64_t there = 0;
    if (__builtin_add_overflow(place, distance, &there) || there < 0 || there % kAlignment != 0 ||
        std::uint64_t(there) > size_ || bytes > size_ - std::uint64_t(there))
      fail_damaged();
    return reinterpret_cast<const Node*>(memory_.get() + there);
  }

private:
  static constexpr std::int64_t kAlignment = NANOVDB_DATA_ALIGNMENT;
  struct Release {
    void operator()(std::byte* p) const { ::operator delete[](p, std::align_val_t{kAlignment}); }
  };
  std::uint64_t size_;
  std::unique_ptr<std::byte[], Release> memory_;
};

template <class T>
std::array<float, 3> numbers(const T& v) {
  return {float(v), 0, 0};
}
template <class T>
std::array<float, 3> numbers(const nanovdb::Vec3<T>& v) {
  return {float(v[0]), float(v[1]), float(v[2])};
}

/// Visits the nodes of a tree. `Build` is the type of the grid; quantised ones decode to float.
template <class Build>
class Walk {
public:
  Walk(Block& block, int channels, SparseVoxels& out) : block_(block), out_(out) {
    using Root = typename nanovdb::NanoTree<Build>::RootType;
    using Data = typename Root::DataType;
    const auto* tree = block.at<nanovdb::TreeData<3>>(block.data(), sizeof(nanovdb::GridData));
    const auto* root = block.at<Data>(tree, std::int64_t(tree->mNodeOffset[3]));
    block.at<Data>(tree, std::int64_t(tree->mNodeOffset[3]),
                   sizeof(Data) + std::uint64_t(root->mTableSize) * sizeof(typename Data::Tile));
    out.channels = channels;
    out.background = numbers(root->mBackground);
    for (std::uint32_t i = 0; i < root->mTableSize; ++i) {
      const auto* tile = root->tile(i);
      const nanovdb::Coord origin = tile->origin();
      if (tile->isChild())
        visit<typename Root::ChildNodeType>(root, tile->child, origin);
      else if (tile->isActive())
        add_tile(origin, Root::ChildNodeType::DIM, numbers(tile->value));
    }
  }

private:
  template <class Node>
  void visit(const void* from, std::int64_t distance, const nanovdb::Coord& origin) {
    using Data = typename Node::DataType;
    const Data* node = block_.at<Data>(from, distance);
    // Damaged offsets could refer to one node a million times.
    visited_ += sizeof(Data);
    if (visited_ > block_.size()) fail_damaged();
    if constexpr (Node::LEVEL == 0) {
      if constexpr (std::is_same_v<Build, nanovdb::FpN>) block_.at<Data>(from, distance, node->memUsage());
      add_block(
          out_, {origin[0], origin[1], origin[2]},
          [&](int i) { return node->mValueMask.isOn(std::uint32_t(i)); },
          [&](int i) { return numbers(node->getValue(std::uint32_t(i))); });
    } else {
      using Child = typename Node::ChildNodeType;
      constexpr int kSide = 1 << Node::LOG2DIM;
      for (std::uint32_t i = 0; i < Node::SIZE; ++i) {
        const bool is_child = node->mChildMask.isOn(i);
        if (!is_child && !node->mValueMask.isOn(i)) continue;
        const int x = int(i) / (kSide * kSide), y = int(i) / kSide % kSide, z = int(i) % kSide;
        constexpr int kChild = int(Child::DIM);
        const nanovdb::Coord at = origin + nanovdb::Coord(x * kChild, y * kChild, z * kChild);
        if (is_child)
          visit<Child>(node, node->mTable[i].child, at);
        else
          add_tile(at, Child::DIM, numbers(node->getValue(i)));
      }
    }
  }
  void add_tile(const nanovdb::Coord& at, std::uint32_t side, const std::array<float, 3>& value) {
    const int last = int(side) - 1;
    out_.tiles.push_back({{at[0], at[1], at[2]}, {at[0] + last, at[1] + last, at[2] + last}, value});
    out_.extend(out_.tiles.back().lower, out_.tiles.back().upper);
  }

  const Block& block_;
  SparseVoxels& out_;
  std::uint64_t visited_ = 0;  ///< bytes of all visited nodes
};

std::vector<char> read_bytes(InputFile& file, std::uint64_t count) {
  if (count > file.left()) file.skip(count);  // throws before memory is allocated
  std::vector<char> all(count);
  file.read(all.data(), count);
  return all;
}

void read_grid(InputFile& file, Codec codec, Block& block) {
  if (codec == Codec::none) {
    file.read(block.data(), block.size());
    return;
  }
  const auto packed = [&] {
    std::uint64_t bytes = 0;
    file.read(&bytes, sizeof bytes);
    return read_bytes(file, bytes);
  };
  if (codec == Codec::zip) {
    const std::vector<char> from = packed();
    uLongf size = block.size();
    if (uncompress(reinterpret_cast<Bytef*>(block.data()), &size, reinterpret_cast<const Bytef*>(from.data()),
                   uLong(from.size())) != Z_OK ||
        size != block.size())
      throw Error("is damaged: a grid cannot be decompressed");
  } else if (codec == Codec::blosc) {
    constexpr std::uint64_t kChunk = 1 << 30;
    for (std::uint64_t done = 0; done < block.size();) {
      const std::vector<char> from = packed();
      const std::uint64_t chunk = std::min(kChunk, block.size() - done);
      std::size_t size = 0;
      if (blosc_cbuffer_validate(from.data(), from.size(), &size) != 0 || size != chunk ||
          blosc_decompress_ctx(from.data(), block.data() + done, chunk, 1) != int(chunk))
        throw Error("is damaged: a grid cannot be decompressed");
      done += chunk;
    }
  } else {
    throw Error(fmt::format("has the unknown compression {}", int(codec)));
  }
}

void convert(Block& block, const std::string& name, SparseVoxels& out) {
  const auto* grid = block.at<nanovdb::GridData>(block.data(), 0);
  out.name = name;
  if (grid->mGridClass == nanovdb::GridClass::LevelSet)
    throw Error("the grid \"" + name + "\" is a level set: distances from a surface, and no density");
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out.to_space[i][j] = grid->mMap.mMatD[3 * i + j];
    out.to_space[i][3] = grid->mMap.mVecD[i];
  }
  out.to_space[3][3] = 1;
  switch (grid->mGridType) {
    case nanovdb::GridType::Float:
      Walk<float>(block, 1, out);
      break;
    case nanovdb::GridType::Double:
      Walk<double>(block, 1, out);
      break;
    case nanovdb::GridType::Fp4:
      Walk<nanovdb::Fp4>(block, 1, out);
      break;
    case nanovdb::GridType::Fp8:
      Walk<nanovdb::Fp8>(block, 1, out);
      break;
    case nanovdb::GridType::Fp16:
      Walk<nanovdb::Fp16>(block, 1, out);
      break;
    case nanovdb::GridType::FpN:
      Walk<nanovdb::FpN>(block, 1, out);
      break;
    case nanovdb::GridType::Vec3f:
      Walk<nanovdb::Vec3f>(block, 3, out);
      break;
    case nanovdb::GridType::Vec3d:
      Walk<nanovdb::Vec3d>(block, 3, out);
      break;
    default:
      throw Error("the grid \"" + name + "\" holds values of type number " +
                  std::to_string(int(grid->mGridType)) +
                  " of NanoVDB; float, double, vec3f, vec3d and quantised floats are supported");
  }
}

}  // namespace

void read_nvdb(const std::filesystem::path& path, const std::optional<std::string>& wanted, SparseFile& out) {
  // The names come first, since the default grid is known only after all of them.
  struct Entry {
    GridHead head;
    Codec codec;
    std::uint64_t place;
  };
  std::vector<Entry> entries;
  std::uint64_t all = 0;
  {
    InputFile file(path);
    all = file.left();
    while (file.left() > 0) {
      SegmentHead segment;
      file.read(&segment, sizeof segment);
      if (std::memcmp(segment.magic, "NanoVDB0", 8) != 0)
        throw Error(
            fmt::format("is of another version of NanoVDB: it begins with \"{}\", and only \"NanoVDB0\" "
                        "can be read; convert it to .vdb",
                        std::string(segment.magic, std::memcmp(segment.magic, "NanoVDB", 7) ? 0 : 8)));
      if (segment.version >> 21 != NANOVDB_MAJOR_VERSION_NUMBER)
        throw Error(fmt::format("is of version {} of NanoVDB; {} can be read", segment.version >> 21,
                                NANOVDB_MAJOR_VERSION_NUMBER));
      const std::size_t first = entries.size();
      for (int i = 0; i < segment.grid_count; ++i) {
        GridHead head;
        file.read(&head, sizeof head);
        const std::vector<char> name = read_bytes(file, head.name_bytes);
        out.grids.emplace_back(name.data(), strnlen(name.data(), name.size()));
        entries.push_back({head, segment.codec, 0});
      }
      for (std::size_t i = first; i < entries.size(); ++i) {
        entries[i].place = all - file.left();
        file.skip(entries[i].head.file_bytes);
      }
    }
  }
  if (entries.empty()) throw Error("holds no grids");
  std::size_t which = default_grid(out.grids);
  if (wanted) which = std::size_t(std::find(out.grids.begin(), out.grids.end(), *wanted) - out.grids.begin());
  if (which >= entries.size()) return;
  out.found = true;
  const Entry& entry = entries[which];
  InputFile file(path);
  file.skip(entry.place);
  if (entry.codec == Codec::none && entry.head.grid_bytes > file.left())
    throw Error("is truncated: it ends in the grid \"" + out.grids[which] + "\"");
  constexpr double kMaxRatio = 1100;  // largest compression ratio of deflate
  try {
    require_content(double(entry.head.grid_bytes), double(all), kMaxRatio);
  } catch (const Error& problem) {
    throw Error("is damaged, or compressed too well: " + problem.message());
  }
  Block block(entry.head.grid_bytes);
  read_grid(file, entry.codec, block);
  convert(block, out.grids[which], out.voxels);
}

}  // namespace aureole
