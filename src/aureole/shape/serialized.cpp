// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "aureole/core/memory.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/mesh_file.h"

namespace aureole {
namespace {

constexpr std::uint16_t kMagic = 0x041c;

/// Bits of the flags word.
enum Flags : std::uint32_t { kHasNormals = 1, kHasUvs = 2, kHasColors = 8, kDouble = 0x2000 };

template <class T>
T little_endian(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

/// Inflates a zlib stream step by step, only as much as requested.
class Inflater {
public:
  Inflater(const MeshFile& file, std::size_t offset) : file_(file) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.begin() + offset));
    left_ = file.size() - offset;
    if (inflateInit(&stream_) != Z_OK) throw file.error("the decompressor cannot be started");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  void read(void* to, std::size_t bytes) {
    // upper bound of a step, since zlib counts in 32 bits
    constexpr std::size_t kPiece = std::size_t(1) << 30;
    auto* out = static_cast<Bytef*>(to);
    while (bytes > 0) {
      if (stream_.avail_in == 0) {
        stream_.avail_in = uInt(std::min(left_, kPiece));
        left_ -= stream_.avail_in;
      }
      stream_.next_out = out;
      stream_.avail_out = uInt(std::min(bytes, kPiece));
      const std::size_t wanted = stream_.avail_out;
      const int code = inflate(&stream_, Z_NO_FLUSH);
      const std::size_t got = wanted - stream_.avail_out;
      out += got, bytes -= got;
      if (bytes == 0) return;
      if (code == Z_STREAM_END) throw file_.error("the mesh ends early: its header promises more data");
      if (code == Z_BUF_ERROR || (code == Z_OK && stream_.avail_in == 0 && left_ == 0))
        throw file_.error("the file is truncated");
      if (code != Z_OK) throw file_.error("the compressed data is damaged");
    }
  }
  template <class T>
  T value() {
    T v;
    read(&v, sizeof(T));
    return v;
  }
  /// Number of compressed bytes that are not used yet.
  std::size_t left() const { return left_ + stream_.avail_in; }

private:
  const MeshFile& file_;
  z_stream stream_{};
  std::size_t left_ = 0;
};

/// Returns the offset of the stream of mesh `index`, after its header. The dictionary at the end of the file
/// has an offset for every mesh (64 bits since version 4) and their number.
std::size_t stream_offset(const MeshFile& file, std::int64_t index, int version) {
  if (index == 0) return 4;
  const std::uint32_t count = little_endian<std::uint32_t>(file.end() - 4);
  const std::size_t entry = version >= 4 ? 8 : 4;
  if (count == 0 || (file.size() - 4) / entry < count)
    throw file.error("the file is truncated: no table of meshes at its end");
  if (index >= count)
    throw Error(file.error("shape_index " + std::to_string(index) + " is out of range: the file holds " +
                           std::to_string(count) + " meshes"));
  const char* at = file.end() - 4 - entry * (count - std::size_t(index));
  const std::uint64_t offset =
      entry == 8 ? little_endian<std::uint64_t>(at) : little_endian<std::uint32_t>(at);
  if (offset > file.size() - 8) throw file.error("the table of meshes points beyond the file");
  if (little_endian<std::uint16_t>(file.begin() + offset) != kMagic)
    throw file.error("the table of meshes points at something that is not a mesh");
  return std::size_t(offset) + 4;
}

class Serialized final : public Mesh {
public:
  explicit Serialized(const Properties& properties) : Mesh(properties) {
    const std::int64_t index = properties.get_int("shape_index", 0, Range::non_negative());
    const bool flip_v = properties.get_bool("flip_tex_coords", false);
    const MeshFile file(properties);
    if (file.size() < 8) throw file.error("the file is truncated");
    if (little_endian<std::uint16_t>(file.begin()) != kMagic) throw file.error("not a serialized mesh");
    const int version = little_endian<std::uint16_t>(file.begin() + 2);
    if (version != 3 && version != 4)
      throw file.error("serialized mesh of version " + std::to_string(version) +
                       "; versions 3 and 4 can be read");
    Inflater in(file, stream_offset(file, index, version));
    build(read(file, in, version, flip_v), "filename");
  }

private:
  MeshData read(const MeshFile& file, Inflater& in, int version, bool flip_v);
};

/// Reads `count` tuples of `dim` floats or doubles and passes each to `use` as doubles.
template <class Use>
void read_tuples(Inflater& in, bool in_double, std::size_t count, int dim, const Use& use) {
  constexpr std::size_t kBatch = 4096;
  const std::size_t size = (in_double ? 8u : 4u) * std::size_t(dim);
  std::vector<char> buffer(kBatch * size);
  for (std::size_t done = 0; done < count; done += kBatch) {
    const std::size_t n = std::min(kBatch, count - done);
    in.read(buffer.data(), n * size);
    for (std::size_t i = 0; i < n; ++i) {
      double v[3] = {0, 0, 0};
      for (int k = 0; k < dim; ++k)
        v[k] = in_double ? little_endian<double>(buffer.data() + i * size + 8u * std::size_t(k))
                         : double(little_endian<float>(buffer.data() + i * size + 4u * std::size_t(k)));
      use(v);
    }
  }
}

MeshData Serialized::read(const MeshFile& file, Inflater& in, int version, bool flip_v) {
  const auto flags = in.value<std::uint32_t>();
  if (version >= 4)  // skips the mesh's name
    for (int length = 0; in.value<char>() != 0; ++length)
      if (length > 65536) throw file.error("the compressed data is damaged");
  const auto vertices = in.value<std::uint64_t>(), triangles = in.value<std::uint64_t>();

  // Upper bound of the content, so that a damaged count is found before memory is allocated for it: deflate
  // compresses at most 1032 to 1.
  const std::uint64_t most = 1032 * (std::uint64_t(in.left()) + 64);
  const bool has_normals = flags & kHasNormals, has_uvs = flags & kHasUvs, in_double = flags & kDouble;
  const std::uint64_t per_vertex =
      (in_double ? 8u : 4u) *
      (3u + (has_normals ? 3u : 0u) + (has_uvs ? 2u : 0u) + (flags & kHasColors ? 3u : 0u));
  if (vertices > std::numeric_limits<std::uint32_t>::max() - 1 || triangles > most / 12 ||
      vertices > most / per_vertex || vertices * per_vertex + triangles * 12 > most)
    throw file.error("the file is truncated or damaged: " + std::to_string(vertices) + " vertices and " +
                     std::to_string(triangles) + " triangles cannot be in it");
  // upper bound of the ratio: meshes whose vertices differ compress by less than 20 to 1
  constexpr double kMaxRatio = 64;
  try {
    require_content(double(vertices * per_vertex + triangles * 12), double(file.size()), kMaxRatio);
  } catch (const Error& problem) {
    throw file.error(problem.message());
  }

  MeshData d;
  d.positions.reserve(vertices + 1);
  read_tuples(in, in_double, vertices, 3,
              [&](const double* v) { d.positions.push_back(place_point(v[0], v[1], v[2])); });
  if (has_normals) {
    d.normals.reserve(vertices);
    read_tuples(in, in_double, vertices, 3,
                [&](const double* v) { d.normals.push_back(place_normal(v[0], v[1], v[2])); });
  }
  if (has_uvs) {
    d.uvs.reserve(vertices);
    read_tuples(in, in_double, vertices, 2, [&](const double* v) {
      d.uvs.push_back({float(v[0]), float(flip_v ? 1 - v[1] : v[1])});
    });
  }
  if (flags & kHasColors) {
    d.attribute_names = {"vertex_color"};
    const bool wanted = wants_attribute("vertex_color");
    if (wanted)
      d.attributes.emplace_back("vertex_color", true), d.attributes[0].reserve(vertices);
    else
      remarks_.push_back("vertex colours ignored");
    read_tuples(in, in_double, vertices, 3, [&](const double* v) {
      if (!wanted) return;
      if (!(v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && std::isfinite(v[0] + v[1] + v[2])))
        throw file.error("a vertex has a colour that is negative or not finite");
      d.attributes[0].add(v);
    });
  }
  d.triangles.resize(triangles);
  in.read(d.triangles.data(), triangles * sizeof(TriangleIndices));
  for (const TriangleIndices& t : d.triangles)
    for (const std::uint32_t i : t)
      if (i >= vertices)
        throw file.error("a triangle refers to vertex " + std::to_string(i) + " of " +
                         std::to_string(vertices));
  return d;
}

AUREOLE_PLUGIN(Serialized, "shape", "serialized",
               PluginDoc{.summary = "A mesh from Mitsuba's compressed binary format, versions 3 and 4. "
                                    "Without normals in the file they are "
                                    "computed, weighted by angle. Vertex colours are the attribute "
                                    "vertex_color for the texture `mesh_attribute`.",
                         .source = "",
                         .parameters = mesh_parameters(
                             {{"filename", "file", "", "required", "the .serialized file"},
                              {"shape_index", "integer", "", "0", "index of the mesh in the file, from 0"},
                              {"flip_tex_coords", "boolean", "", "false",
                               "replace the texture coordinate v by 1 - v"}}),
                         .examples = {R"(<shape type="serialized">
  <string name="filename" value="mesh.serialized"/>
  <integer name="shape_index" value="0"/>
  <boolean name="flip_tex_coords" value="false"/>
  <boolean name="face_normals" value="false"/>
  <boolean name="flip_normals" value="false"/>
  <transform name="to_world"><scale value="2"/></transform>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
