// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 (.gltf, .glb) with KHR_gaussian_splatting (ratified by the Khronos Group): points whose attributes are linear
// scales, opacities in [0, 1], rotations x, y, z, w and harmonics by degree and order. Nodes place them; coordinates are
// right-handed with y up.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "aureole/core/input_file.h"
#include "aureole/math/transform.h"
#include "aureole/parameter/grid/grid_reader.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole::splat_reader {

namespace {

using nlohmann::json;

constexpr const char* kExtension = "KHR_gaussian_splatting";

/// Returns the member of an object, or a null value.
const json& member(const json& object, const char* name) {
  static const json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(name);
  return found == object.end() ? kNull : *found;
}

std::uint64_t natural(const json& object, const char* name, std::uint64_t fallback) {
  const json& value = member(object, name);
  if (value.is_null()) return fallback;
  if (!value.is_number_unsigned())
    throw Error(fmt::format("has the {} {}; a whole number of 0 or more is expected", name,
                            value.dump().substr(0, 40)));
  return value.get<std::uint64_t>();
}

const json& element(const json& document, const char* list, std::uint64_t index) {
  const json& all = member(document, list);
  if (!all.is_array() || index >= all.size())
    throw Error(fmt::format("refers to number {} of its {}, of which there are {}", index, list,
                            all.is_array() ? all.size() : 0));
  return all[index];
}

class GltfDocument {
public:
  GltfDocument(const Path& file, const SharedBytes& bytes) : file_(file) {
    SharedBytes text = bytes;
    if (bytes.size() >= 4 && std::memcmp(bytes.bytes.data(), "glTF", 4) == 0) text = chunks(bytes);
    constexpr std::size_t kMaxText = kMaxJsonBytes;
    if (text.size() > kMaxText)
      throw Error(fmt::format("has {} bytes of JSON; {} are possible", text.size(), kMaxText));
    const char* begin = reinterpret_cast<const char*>(text.bytes.data());
    try {
      // Upper bound of the nesting of JSON, deeper than any glTF, since deeper text would exhaust the stack.
      static constexpr int kMaxDepth = 64;
      document_ = json::parse(begin, begin + text.size(), [](int depth, json::parse_event_t, json&) {
        if (depth > kMaxDepth) throw Error(fmt::format("has JSON nested more than {} deep", kMaxDepth));
        return true;
      });
    } catch (const json::exception& fault) {
      throw Error(fmt::format("is no JSON: {}", fault.what()));
    }
    if (!document_.is_object()) throw Error("is no glTF: its JSON is not an object");
    const json& version = member(member(document_, "asset"), "version");
    if (!version.is_string() || !version.get<std::string>().starts_with("2."))
      throw Error("is no glTF of version 2: its \"asset\" states the version " +
                  version.dump().substr(0, 20));
    const json& required = member(document_, "extensionsRequired");
    if (required.is_array())
      for (const json& name : required)
        if (name != kExtension && name != "KHR_mesh_quantization")
          throw Error("requires the extension " + name.dump().substr(0, 60) + ", which is not supported");
  }

  const json& document() const { return document_; }
  const std::vector<Path>& further_files() const { return further_; }

  /// The numbers of an accessor; each element has `width` numbers.
  struct Numbers {
    std::vector<float> values;
    std::size_t count = 0;
    bool is_float = false;
  };
  Numbers read(std::uint64_t accessor_index, std::size_t width, const char* name) {
    const json& accessor = element(document_, "accessors", accessor_index);
    if (!member(accessor, "sparse").is_null())
      throw Error(fmt::format("has a sparse accessor for {}, which is not supported", name));
    const json& type = member(accessor, "type");
    const char* expected = width == 1 ? "SCALAR" : width == 3 ? "VEC3" : "VEC4";
    if (type != expected)
      throw Error(
          fmt::format("has the type {} for {}; {} is expected", type.dump().substr(0, 20), name, expected));
    const std::uint64_t component = natural(accessor, "componentType", 0),
                        count = natural(accessor, "count", 0);
    const std::size_t size = component == 5126 || component == 5125   ? 4
                             : component == 5122 || component == 5123 ? 2
                             : component == 5120 || component == 5121 ? 1
                                                                      : 0;
    if (size == 0)
      throw Error(fmt::format("has the component type {} for {}, which glTF does not have", component, name));
    const bool normalized = member(accessor, "normalized") == true;
    // KHR_gaussian_splatting allows floats and normalised whole numbers; plain whole numbers of 8 and 16 bits are those of
    // KHR_mesh_quantization.
    if (component == 5125)
      throw Error(fmt::format(
          "has unsigned whole numbers of 32 bits for {}, which the extension does not allow", name));
    if (count > kMaxSplats) throw Error(fmt::format("claims {} splats; {} are possible", count, kMaxSplats));
    const json& view = element(document_, "bufferViews", natural(accessor, "bufferView", ~0ull));
    const SharedBytes& buffer = buffer_of(natural(view, "buffer", ~0ull));
    const std::uint64_t start = natural(view, "byteOffset", 0), length = natural(view, "byteLength", 0),
                        offset = natural(accessor, "byteOffset", 0),
                        stride = natural(view, "byteStride", size * width);
    if (start > buffer.size() || length > buffer.size() - start)
      throw Error(fmt::format("is truncated: {} needs {} bytes from byte {} of a buffer of {}", name, length,
                              start, buffer.size()));
    if (stride < size * width || stride > 1024 || offset > length ||
        (count > 0 &&
         (count - 1 > (length - offset) / stride || (count - 1) * stride + size * width > length - offset)))
      throw Error(
          fmt::format("is truncated: {} elements for {} do not fit into {} bytes", count, name, length));
    Numbers out{std::vector<float>(count * width), std::size_t(count), component == 5126};
    const std::byte* from = buffer.bytes.data() + start + offset;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < width; ++k) {
        const std::byte* at = from + stride * i + size * k;
        float v = 0;
        switch (component) {
          case 5120:
            v = float(load<std::int8_t>(at));
            if (normalized) v = std::max(v / 127, -1.f);
            break;
          case 5121:
            v = float(load<std::uint8_t>(at));
            if (normalized) v /= 255;
            break;
          case 5122:
            v = float(load<std::int16_t>(at));
            if (normalized) v = std::max(v / 32767, -1.f);
            break;
          case 5123:
            v = float(load<std::uint16_t>(at));
            if (normalized) v /= 65535;
            break;
          case 5125:
            v = float(load<std::uint32_t>(at));
            break;
          default:
            v = load<float>(at);
        }
        out.values[i * width + k] = v;
      }
    return out;
  }

private:
  /// Returns the JSON of a .glb, and keeps its binary chunk.
  SharedBytes chunks(const SharedBytes& bytes) {
    if (bytes.size() < 20) throw Error("is truncated in the header of its .glb");
    const std::uint32_t version = load<std::uint32_t>(&bytes.bytes[4]);
    if (version != 2) throw Error(fmt::format("is a .glb of version {}; 2 is known", version));
    SharedBytes text;
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      const std::uint32_t length = load<std::uint32_t>(&bytes.bytes[at]),
                          type = load<std::uint32_t>(&bytes.bytes[at + 4]);
      if (length > bytes.size() - at - 8)
        throw Error(fmt::format("is truncated: a chunk of its .glb has {} bytes, but {} are left", length,
                                bytes.size() - at - 8));
      const SharedBytes chunk{bytes.bytes.subspan(at + 8, length), bytes.owner};
      if (type == 0x4E4F534A && text.size() == 0)
        text = chunk;
      else if (type == 0x004E4942 && !has_binary_)
        binary_ = chunk, has_binary_ = true;
      at += 8 + std::size_t(length);
    }
    if (text.size() == 0) throw Error("is a .glb without JSON");
    return text;
  }

  const SharedBytes& buffer_of(std::uint64_t index) {
    const json& buffer = element(document_, "buffers", index);
    for (const auto& [known, bytes] : buffers_)
      if (known == index) return bytes;
    const json& uri = member(buffer, "uri");
    SharedBytes bytes;
    if (uri.is_null()) {
      if (!has_binary_ || index != 0) throw Error(fmt::format("has a buffer {} without bytes", index));
      bytes = binary_;
    } else if (!uri.is_string()) {
      throw Error("has a buffer whose uri is no text");
    } else if (const std::string text = uri.get<std::string>(); text.starts_with("data:")) {
      const std::size_t comma = text.find(";base64,");
      if (comma == text.npos) throw Error("has a buffer of data that are not base64");
      bytes = grid_reader::shared(grid_reader::base64_bytes(std::string_view(text).substr(comma + 8)));
    } else {
      const Path further = file_.parent_path() / Path(text);
      bytes = map_file(further);
      further_.push_back(further);
    }
    const std::uint64_t length = natural(buffer, "byteLength", 0);
    if (length > bytes.size())
      throw Error(
          fmt::format("is truncated: buffer {} claims {} bytes and has {}", index, length, bytes.size()));
    buffers_.emplace_back(index, bytes);
    return buffers_.back().second;
  }

  Path file_;
  json document_;
  SharedBytes binary_;
  bool has_binary_ = false;
  std::vector<std::pair<std::uint64_t, SharedBytes>> buffers_;
  std::vector<Path> further_;
};

std::vector<double> number_array(const json& node, const char* name, std::size_t count) {
  const json& list = member(node, name);
  if (list.is_null()) return {};
  if (!list.is_array() || list.size() != count ||
      !std::all_of(list.begin(), list.end(), [](const json& v) { return v.is_number(); }))
    throw Error(fmt::format("has a node whose {} is not {} numbers", name, count));
  return list.get<std::vector<double>>();
}

Transform node_transform(const json& node) {
  if (const auto m = number_array(node, "matrix", 16); !m.empty()) {
    Transform::Matrix rows;
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c) rows[r][c] = m[4 * c + r];
    return Transform(rows);
  }
  Transform t;
  if (const auto v = number_array(node, "translation", 3); !v.empty())
    t = Transform::translate(v[0], v[1], v[2]);
  if (const auto q = number_array(node, "rotation", 4); !q.empty()) {
    const double w = std::hypot(q[0], q[1], q[2]);
    if (w > 0) t = t * Transform::rotate(q[0], q[1], q[2], 2 * std::atan2(w, q[3]) / kDegree);
  }
  if (const auto s = number_array(node, "scale", 3); !s.empty()) t = t * Transform::scale(s[0], s[1], s[2]);
  return t;
}

/// The rotation and the scale of a node; other transforms of splats are undefined (KHR_gaussian_splatting, geometry).
struct SplatPlacement {
  Transform to_world;
  std::array<double, 4> rotation;  ///< quaternion w, x, y, z
  double scale;
};

std::array<double, 4> quaternion_of(const Transform& rotation) {
  const auto& m = rotation.matrix();
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    const double s = 2 * std::sqrt(trace + 1);
    return {s / 4, (m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s};
  }
  const int i = m[0][0] > m[1][1] && m[0][0] > m[2][2] ? 0
                : m[1][1] > m[2][2]                    ? 1
                                                       : 2,
            j = (i + 1) % 3, k = (i + 2) % 3;
  const auto at = [&](int r, int c) { return m[std::size_t(r)][std::size_t(c)]; };
  const double s = 2 * std::sqrt(std::max(0., 1 + at(i, i) - at(j, j) - at(k, k)));
  std::array<double, 4> q;
  q[0] = (at(k, j) - at(j, k)) / s;
  q[std::size_t(i) + 1] = s / 4;
  q[std::size_t(j) + 1] = (at(j, i) + at(i, j)) / s;
  q[std::size_t(k) + 1] = (at(k, i) + at(i, k)) / s;
  return q;
}

SplatPlacement placement_of(const Transform& t) {
  if (t.is_singular() || !t.stays_near()) throw Error("has a node whose transform is singular or not finite");
  const Transform rotation = t.orthogonal_part();
  if (rotation.determinant3() < 0)
    throw Error("has splats in a node that mirrors them, which KHR_gaussian_splatting leaves undefined");
  const double scale = std::cbrt(t.determinant3());
  const auto &m = t.matrix(), &r = rotation.matrix();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (std::abs(m[i][j] - scale * r[i][j]) > 1e-4 * scale)
        throw Error(
            "has splats in a node that scales its axes differently, which is not supported: scale them in the file");
  return {t, quaternion_of(rotation), scale};
}

struct PlacedPrimitive {
  const json* primitive;
  SplatPlacement at;
};

class GltfSplats {
public:
  GltfSplats(const Path& file, const SharedBytes& bytes) : gltf_(file, bytes) {}

  SplatCloud read() {
    find_primitives();
    SplatCloud c;
    c.format = "glTF with KHR_gaussian_splatting", c.axes = "RUB";
    c.hints.sorting = SplatHints::Sorting::camera_distance;
    c.hints.cutoff = 3;
    int degree = 0;
    for (const PlacedPrimitive& p : primitives_) degree = std::max(degree, degree_of(*p.primitive));
    for (std::size_t i = 0; i < primitives_.size(); ++i) append(primitives_[i], degree, i == 0, c);
    if (others_ > 0)
      c.notes.push_back(fmt::format("has {} primitives that are no splats: they are left out", others_));
    c.further_files = gltf_.further_files();
    return c;
  }

private:
  void find_primitives() {
    const json& d = gltf_.document();
    const json& scenes = member(d, "scenes");
    if (scenes.is_array() && !scenes.empty()) {
      const json& scene = element(d, "scenes", natural(d, "scene", 0));
      const json& roots = member(scene, "nodes");
      if (roots.is_array())
        for (const json& root : roots) visit(root, Transform(), 0);
    } else if (const json& meshes = member(d, "meshes"); meshes.is_array()) {
      for (std::size_t i = 0; i < meshes.size(); ++i) add_mesh(i, Transform());
    }
    if (primitives_.empty()) throw Error(std::string("holds no primitives with the extension ") + kExtension);
  }

  void visit(const json& index, const Transform& parent, int depth) {
    constexpr int kMaxDepth = 256, kMaxNodes = 1 << 20;
    if (!index.is_number_unsigned()) throw Error("has a node whose number is no whole number");
    if (depth > kMaxDepth || ++nodes_ > kMaxNodes)
      throw Error("has nodes that contain themselves, or too many of them");
    const json& node = element(gltf_.document(), "nodes", index.get<std::uint64_t>());
    const Transform here = parent * node_transform(node);
    if (!member(node, "mesh").is_null()) add_mesh(natural(node, "mesh", 0), here);
    const json& children = member(node, "children");
    if (children.is_array())
      for (const json& child : children) visit(child, here, depth + 1);
  }

  void add_mesh(std::uint64_t index, const Transform& to_world) {
    const json& list = member(element(gltf_.document(), "meshes", index), "primitives");
    if (!list.is_array()) return;
    for (const json& primitive : list) {
      const json& extension = member(member(primitive, "extensions"), kExtension);
      if (extension.is_null()) {
        ++others_;
        continue;
      }
      if (natural(primitive, "mode", 4) != 0)
        throw Error(fmt::format("has splats whose mode is {}; POINTS (0) is expected",
                                natural(primitive, "mode", 4)));
      primitives_.push_back({&primitive, placement_of(to_world)});
    }
  }

  static int degree_of(const json& primitive) {
    const json& attributes = member(primitive, "attributes");
    int degree = 0;
    for (int l = 1; l <= kMaxHarmonicDegree; ++l) {
      int found = 0;
      for (int k = 0; k < 2 * l + 1; ++k) found += !member(attributes, harmonic_name(l, k).c_str()).is_null();
      if (found == 0) continue;
      if (found != 2 * l + 1)
        throw Error(fmt::format("has {} of the {} spherical harmonics of degree {}", found, 2 * l + 1, l));
      if (degree != l - 1)
        throw Error(fmt::format("has spherical harmonics of degree {}, but none of degree {}", l, l - 1));
      degree = l;
    }
    return degree;
  }
  static std::string harmonic_name(int l, int k) {
    return fmt::format("{}:SH_DEGREE_{}_COEF_{}", kExtension, l, k);
  }

  std::uint64_t attribute(const json& attributes, const std::string& name) const {
    if (member(attributes, name.c_str()).is_null()) throw Error("has splats without the attribute " + name);
    return natural(attributes, name.c_str(), 0);
  }

  void read_hints(const json& extension, bool is_first, SplatCloud& c) const {
    SplatHints hints = c.hints;
    const auto choose = [&](const char* name, const char* fallback,
                            std::initializer_list<const char*> known) {
      const json& value = member(extension, name);
      const std::string text = value.is_string() ? value.get<std::string>() : fallback;
      for (const char* k : known)
        if (text == k) return text;
      c.notes.push_back(fmt::format("has the {} \"{}\", which is not known: {} is used", name,
                                    text.substr(0, 60), fallback));
      return std::string(fallback);
    };
    choose("kernel", "ellipse", {"ellipse"});
    hints.colors =
        choose("colorSpace", "srgb_rec709_display", {"srgb_rec709_display", "lin_rec709_display"})[0] == 'l'
            ? SplatHints::Colors::linear
            : SplatHints::Colors::srgb;
    hints.sorting = choose("sortingMethod", "cameraDistance", {"cameraDistance", "zDepth"})[0] == 'z'
                        ? SplatHints::Sorting::z_depth
                        : SplatHints::Sorting::camera_distance;
    hints.projection = choose("projection", "perspective", {"perspective", "tangential"})[0] == 't'
                           ? SplatHints::Projection::tangential
                           : SplatHints::Projection::perspective;
    if (!is_first && !(hints == c.hints))
      throw Error(
          "has splats of different colour spaces, sorting methods or projections, which cannot be blended together");
    c.hints = hints;
  }

  void append(const PlacedPrimitive& placed, int degree, bool is_first, SplatCloud& c) {
    const json& attributes = member(*placed.primitive, "attributes");
    read_hints(member(member(*placed.primitive, "extensions"), kExtension), is_first, c);
    const std::string prefix = std::string(kExtension) + ":";
    const auto positions = gltf_.read(attribute(attributes, "POSITION"), 3, "POSITION");
    const std::size_t n = positions.count;
    const auto read = [&](const std::string& name, std::size_t width) {
      auto numbers = gltf_.read(attribute(attributes, name), width, name.c_str());
      if (numbers.count != n)
        throw Error(fmt::format("has {} elements for {}, but {} positions", numbers.count, name, n));
      return numbers;
    };
    if (n == 0) throw Error("has splats without positions");
    const auto rotations = read(prefix + "ROTATION", 4), scales = read(prefix + "SCALE", 3),
               opacities = read(prefix + "OPACITY", 1);
    const std::size_t first = c.size();
    c.resize(first + n, degree);
    const auto& r = placed.at.rotation;
    const bool turns = std::abs(r[0]) < 1 - 1e-9;
    const int own = degree_of(*placed.primitive);
    if (turns && own > 0)
      throw Error(
          "has splats with spherical harmonics in a node that rotates them, which is not supported: rotate them in the scene");
    std::size_t uneven = 0;
    const float* q = rotations.values.data();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t to = first + i;
      c.positions[to] = placed.at.to_world.point(
          {positions.values[3 * i], positions.values[3 * i + 1], positions.values[3 * i + 2]});
      const double x = q[4 * i], y = q[4 * i + 1], z = q[4 * i + 2], w = q[4 * i + 3];
      uneven += std::abs(w * w + x * x + y * y + z * z - 1) > 0.02;
      c.rotations[to] = {
          float(r[0] * w - r[1] * x - r[2] * y - r[3] * z), float(r[0] * x + r[1] * w + r[2] * z - r[3] * y),
          float(r[0] * y - r[1] * z + r[2] * w + r[3] * x), float(r[0] * z + r[1] * y - r[2] * x + r[3] * w)};
      for (int k = 0; k < 3; ++k)
        c.scales[to][k] = float(placed.at.scale * double(scales.values[3 * i + std::size_t(k)]));
      c.opacities[to] = opacities.values[i];
      std::fill_n(&c.harmonics[3 * c.coefficients() * to], 3 * c.coefficients(), 0.f);
    }
    if (uneven > 0)
      c.notes.push_back(
          fmt::format("has {} splats whose rotation is no unit quaternion: they are normalised", uneven));
    std::size_t term = 0;
    for (int l = 0; l <= own; ++l)
      for (int k = 0; k < 2 * l + 1; ++k, ++term) {
        const auto colors = read(harmonic_name(l, k), 3);
        for (std::size_t i = 0; i < n; ++i)
          std::copy_n(&colors.values[3 * i], 3, &c.harmonics[3 * (c.coefficients() * (first + i) + term)]);
      }
  }

  GltfDocument gltf_;
  std::vector<PlacedPrimitive> primitives_;
  std::size_t others_ = 0;
  int nodes_ = 0;
};

}  // namespace

SplatCloud read_gltf(const Path& file, const SharedBytes& bytes, const SplatFileOptions&) {
  return GltfSplats(file, bytes).read();
}

}  // namespace aureole::splat_reader
