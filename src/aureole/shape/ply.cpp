// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "aureole/parameter/ply/ply_source.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/mesh_file.h"
#include "aureole/shape/mesh/mesh_polygons.h"
#include "aureole/shape/mesh/ply_attributes.h"

namespace aureole {
namespace {

using ply::Element;
using ply::Property;

/// Reads the elements `vertex` and `face` and skips the others.
template <class Source>
class PlyReader {
public:
  using Wants = std::function<bool(std::string_view)>;
  PlyReader(const MeshFile& file, const ply::Header& header, bool flip_v, Wants wants)
      : file_(file), header_(header), source_(file, header.body), flip_v_(flip_v), wants_(std::move(wants)) {}

  template <class PlacePoint, class PlaceNormal>
  MeshData read(const PlacePoint& place_point, const PlaceNormal& place_normal) {
    bool has_vertices = false, has_faces = false;
    for (const Element& e : header_.elements) {
      check_size(e);
      if (e.name == "vertex" && !has_vertices) {
        has_vertices = true;
        vertices(e, place_point, place_normal);
      } else if (e.name == "face" && !has_faces) {
        has_faces = true;
        faces(e);
      } else {
        ignored_.insert(e.name);
        for (std::size_t i = 0; i < e.count; ++i)
          record(
              e, [](std::size_t, double) {}, [](std::size_t, std::size_t, double) {});
      }
    }
    if (!has_vertices) throw file_.error("no element \"vertex\"");
    if (!has_faces) throw file_.error("no element \"face\"");
    if (!source_.finished()) throw file_.error("there is more in the file than its header says");
    for (const TriangleIndices& t : d_.triangles)
      for (const std::uint32_t i : t)
        if (i >= d_.positions.size())
          throw file_.error("a face refers to vertex " + std::to_string(i) + " of " +
                            std::to_string(d_.positions.size()));
    for (std::string& note : triangulate_polygons(d_, polygons_, file_)) notes_.push_back(std::move(note));
    return std::move(d_);
  }

  std::vector<std::string> remarks() const {
    std::vector<std::string> r = notes_;
    std::string names;
    for (const std::string& name : ignored_) names += (names.empty() ? "" : ", ") + name;
    if (!names.empty()) r.push_back("ignored in the file: " + names);
    if (source_.long_lines())
      r.push_back(std::to_string(source_.long_lines()) +
                  " lines have more numbers than the header has properties; the rest is ignored");
    if (small_faces_)
      r.push_back(std::to_string(small_faces_) + " faces of fewer than three vertices dropped");
    return r;
  }

private:
  /// Rejects counts that exceed the file's size, before memory is allocated for them.
  void check_size(const Element& e) const {
    const std::size_t least = header_.format == ply::Format::ascii ? e.properties.size() : e.least_bytes();
    if (e.properties.empty() && e.count > 0)
      throw file_.error("element \"" + e.name + "\" has no properties");
    if (e.count > std::numeric_limits<std::uint32_t>::max() - 1 ||
        (least > 0 && e.count > source_.values_left() / least))
      throw file_.error("the file is truncated: " + std::to_string(e.count) + " times \"" + e.name +
                        "\" cannot be in it");
  }

  /// Reads one record: calls `scalar(property, value)` and `item(property, index, value)` for its values in
  /// order.
  template <class Scalar, class Item>
  void record(const Element& e, const Scalar& scalar, const Item& item) {
    for (std::size_t k = 0; k < e.properties.size(); ++k) {
      const Property& p = e.properties[k];
      if (!p.is_list) {
        source_.require(size_of(p.type));
        scalar(k, source_.value(p.type));
        continue;
      }
      source_.require(size_of(p.count_type));
      const double count = source_.value(p.count_type);
      if (!(count >= 0) || count > double(source_.values_left()))
        throw file_.error("the file is truncated or a list has an impossible length");
      source_.require(std::size_t(count) * size_of(p.type));
      for (std::size_t i = 0; i < std::size_t(count); ++i) item(k, i, source_.value(p.type));
    }
    source_.end_record();
  }

  template <class PlacePoint, class PlaceNormal>
  void vertices(const Element& e, const PlacePoint& place_point, const PlaceNormal& place_normal) {
    // Destination slot[k] of property k: 0-2 position, 3-5 normal, 6-7 texture coordinates, 8 any other.
    std::vector<int> slot(e.properties.size(), 8);
    const auto all = [&](std::initializer_list<const char*> names, int first) {
      for (const char* name : names)
        if (const int k = e.find(name); k < 0 || e.properties[std::size_t(k)].is_list) return false;
      for (const char* name : names) slot[std::size_t(e.find(name))] = first++;
      return true;
    };
    if (!all({"x", "y", "z"}, 0)) throw file_.error("vertices need the properties x, y and z");
    const bool normals = all({"nx", "ny", "nz"}, 3);
    const bool uvs = all({"u", "v"}, 6) || all({"s", "t"}, 6) || all({"texture_u", "texture_v"}, 6);
    ply::AttributeReader attributes(e, "vertex_", wants_, d_);
    for (std::size_t k = 0; k < slot.size(); ++k)
      if (slot[k] == 8 && !attributes.keeps(k)) ignored_.insert("vertex." + e.properties[k].name);

    d_.positions.reserve(e.count + 1);
    if (normals) d_.normals.reserve(e.count);
    if (uvs) d_.uvs.reserve(e.count);
    double v[9] = {};
    for (std::size_t i = 0; i < e.count; ++i) {
      record(
          e, [&](std::size_t k, double value) { v[slot[k]] = value, attributes.set(k, value); },
          [](std::size_t, std::size_t, double) {});
      if (!attributes.add()) throw wrong_attribute("vertex", i);
      d_.positions.push_back(place_point(v[0], v[1], v[2]));
      if (normals) d_.normals.push_back(place_normal(v[3], v[4], v[5]));
      if (uvs) d_.uvs.push_back({float(v[6]), float(flip_v_ ? 1 - v[7] : v[7])});
    }
    note_noise(attributes);
  }

  void faces(const Element& e) {
    int list = e.find("vertex_indices");
    if (list < 0) list = e.find("vertex_index");
    if (list < 0 || !e.properties[std::size_t(list)].is_list)
      throw file_.error("faces need the list property vertex_indices or vertex_index");
    ply::AttributeReader attributes(e, "face_", wants_, d_);
    for (std::size_t k = 0; k < e.properties.size(); ++k)
      if (k != std::size_t(list) && !attributes.keeps(k)) ignored_.insert("face." + e.properties[k].name);
    d_.triangles.reserve(e.count);
    for (std::size_t i = 0; i < e.count; ++i) {
      std::uint32_t first = 0, previous = 0;
      std::size_t corners = 0;
      record(
          e, [&](std::size_t k, double value) { attributes.set(k, value); },
          [&](std::size_t k, std::size_t at, double value) {
            if (k != std::size_t(list)) return;
            if (!(value >= 0 && value < 4294967295.0))
              throw file_.error("a face refers to the vertex " + std::to_string(value));
            const auto v = std::uint32_t(value);
            if (at == 0) first = v;
            if (at >= 2) d_.triangles.push_back({first, previous, v});
            previous = v;
            corners = at + 1;
          });
      if (corners < 3) ++small_faces_;
      if (corners > 3) polygons_.push_back({d_.triangles.size() + 2 - corners, corners});
      for (std::size_t k = 2; k < corners; ++k)
        if (!attributes.add()) throw wrong_attribute("face", i);
    }
    note_noise(attributes);
  }
  void note_noise(const ply::AttributeReader& attributes) {
    if (attributes.noise().any()) notes_.push_back("colours: " + attributes.noise().note());
  }
  Error wrong_attribute(const char* element, std::size_t i) const {
    return file_.error(std::string(element) + " " + std::to_string(i) +
                       " has an attribute that is not finite, or a negative colour");
  }

  const MeshFile& file_;
  const ply::Header& header_;
  Source source_;
  const bool flip_v_;
  const Wants wants_;
  MeshData d_;
  std::size_t small_faces_ = 0;
  std::set<std::string> ignored_;
  std::vector<FannedPolygon> polygons_;
  std::vector<std::string> notes_;  ///< notes on polygons and colours
};

class Ply final : public Mesh {
public:
  explicit Ply(const Properties& properties) : Mesh(properties) {
    const bool flip_v = properties.get_bool("flip_tex_coords", false);
    const MeshFile file(properties);
    const ply::Header header = ply::read_header(file);
    constexpr bool kLittle = std::endian::native == std::endian::little;
    if (header.format == ply::Format::ascii)
      load<ply::TextSource>(file, header, flip_v);
    else if ((header.format == ply::Format::little_endian) == kLittle)
      load<ply::BinarySource<false>>(file, header, flip_v);
    else
      load<ply::BinarySource<true>>(file, header, flip_v);
  }

private:
  template <class Source>
  void load(const MeshFile& file, const ply::Header& header, bool flip_v) {
    PlyReader<Source> reader(file, header, flip_v,
                             [this](std::string_view name) { return wants_attribute(name); });
    MeshData data = reader.read([this](double x, double y, double z) { return place_point(x, y, z); },
                                [this](double x, double y, double z) { return place_normal(x, y, z); });
    for (std::string& remark : reader.remarks()) remarks_.push_back(std::move(remark));
    build(std::move(data), "filename");
  }
};

AUREOLE_PLUGIN(
    Ply, "shape", "ply",
    PluginDoc{
        .summary =
            "A mesh from a PLY file, ASCII or binary of either byte order, with polygons (convex or "
            "not); vertex normals (nx, ny, nz) and texture coordinates (u, v or s, t or texture_u, "
            "texture_v) are read. Without normals they are computed, weighted by angle. Other properties "
            "are attributes for the texture `mesh_attribute`, kept if one reads them: r, g, b or red, "
            "green, blue are vertex_color (face_color on faces); NAME_x alone is the number vertex_NAME; "
            "NAME_x, NAME_y, NAME_z or NAME_0, NAME_1, NAME_2 are the colour vertex_NAME, and NAME_r, "
            "NAME_g, NAME_b vertex_NAME_color. Integers represent [0, 1], encoded as in sRGB pictures.",
        .source = "Normals: Thuermer & Wuethrich 1998, \"Computing vertex normals from polygonal facets\".",
        .parameters = mesh_parameters({{"filename", "file", "", "required", "the PLY file"},
                                       {"flip_tex_coords", "boolean", "", "false",
                                        "replace the texture coordinate v by 1 - v"}}),
        .examples = {R"(<shape type="ply">
  <string name="filename" value="mesh.ply"/>
  <boolean name="flip_tex_coords" value="true"/>
  <boolean name="face_normals" value="false"/>
  <boolean name="flip_normals" value="true"/>
  <transform name="to_world"><translate x="1" y="2" z="3"/></transform>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
