// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "aureole/plugin/registry.h"
#include "aureole/shape/mesh/file_materials.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/mesh_file.h"
#include "aureole/shape/mesh/mesh_parts.h"
#include "aureole/shape/mesh/mesh_polygons.h"

namespace aureole {
namespace {

/// Reads the statements v, vt, vn and f, and collects the names of all others for a note.
class ObjReader {
public:
  ObjReader(MeshFile& file, bool flip_v) : file_(file), flip_v_(flip_v) {}

  template <class PlacePoint, class PlaceNormal>
  MeshData read(const PlacePoint& place_point, const PlaceNormal& place_normal);

  std::vector<std::string> remarks() const;
  /// Names of the materials that MeshData::materials indexes; the first is no material.
  const std::vector<std::string>& materials() const { return materials_; }
  const std::vector<std::string>& libraries() const { return libraries_; }

private:
  struct Corner {
    std::uint32_t v, vt, vn;
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  char* end_of_line(char* at);
  double number(Scanner& s, const char* what);
  std::uint32_t index(Scanner& s, std::size_t count, const char* what, bool must_precede);
  void face(Scanner& s);
  void other(std::string_view keyword, Scanner& s, const char* line);
  void finish();

  MeshFile& file_;
  const bool flip_v_;
  MeshData d_;
  std::vector<Corner> polygon_;
  std::vector<FannedPolygon> polygons_;
  std::size_t colored_vertices_ = 0;  ///< number of v statements with more than x, y, z and a weight
  std::size_t small_faces_ = 0;
  std::vector<std::string> materials_{""}, libraries_;
  std::map<std::string, std::uint32_t, std::less<>> material_index_;
  std::uint32_t material_ = 0;  ///< material of the following faces
  std::set<std::string, std::less<>> ignored_;
  std::vector<std::string> notes_;  ///< notes on polygons
};

/// Returns the end of the statement at `at`. A backslash before a newline continues the line and becomes a
/// blank.
char* ObjReader::end_of_line(char* at) {
  char* const end = file_.begin() + file_.size();
  for (char* from = at;;) {
    char* e = static_cast<char*>(std::memchr(from, '\n', std::size_t(end - from)));
    if (!e) return end;
    char* last = e;
    while (last > at && last[-1] == '\r') --last;
    if (last == at || last[-1] != '\\') return e;
    // Only the backslash is replaced, since replacing the newline would break the line count; below, blanks
    // include newlines.
    last[-1] = ' ';
    from = e + 1;
  }
}

double ObjReader::number(Scanner& s, const char* what) {
  double value;
  s.skip_white();
  if (!s.number(value)) throw file_.error_at(s.at, std::string("expected a number in ") + what);
  return value;
}

/// Reads an index and counts from 0. Positive indices may exceed `count` unless the values must precede: the
/// value may follow in the file, or be missing.
std::uint32_t ObjReader::index(Scanner& s, std::size_t count, const char* what, bool must_precede) {
  long long i;
  if (!s.integer(i)) throw file_.error_at(s.at, std::string("expected the index of a ") + what);
  const long long resolved = i < 0 ? i + (long long)count : i - 1;
  if (i == 0 || resolved < 0 || resolved >= (must_precede ? (long long)count : (long long)kNone))
    throw file_.error_at(s.at, std::string("there is no ") + what + " " + std::to_string(i) + "; " +
                                   std::to_string(count) + " precede this line");
  return std::uint32_t(resolved);
}

void ObjReader::face(Scanner& s) {
  polygon_.clear();
  for (s.skip_white(); s.at < s.end; s.skip_white()) {
    Corner c{index(s, d_.positions.size(), "vertex", true), kNone, kNone};
    const auto is_given = [&] { return s.at < s.end && !std::strchr("/ \t\r\n", *s.at); };
    if (s.at < s.end && *s.at == '/') {
      ++s.at;
      if (is_given()) c.vt = index(s, d_.uvs.size(), "texture coordinate", false);
      if (s.at < s.end && *s.at == '/') {
        ++s.at;
        if (is_given()) c.vn = index(s, d_.normals.size(), "normal", false);
      }
    }
    if (s.at < s.end && !std::strchr(" \t\r\n", *s.at)) throw file_.error_at(s.at, "malformed face");
    polygon_.push_back(c);
  }
  if (polygon_.size() < 3) {
    ++small_faces_;
    return;
  }
  // A face with any normal missing has no normals.
  if (std::any_of(polygon_.begin(), polygon_.end(), [](const Corner& c) { return c.vn == kNone; }))
    for (Corner& c : polygon_) c.vn = kNone;
  if (polygon_.size() > 3) polygons_.push_back({d_.triangles.size(), polygon_.size()});
  const Corner& a = polygon_[0];
  for (std::size_t i = 1; i + 1 < polygon_.size(); ++i) {
    const Corner &b = polygon_[i], &c = polygon_[i + 1];
    d_.triangles.push_back({a.v, b.v, c.v});
    d_.uv_triangles.push_back({a.vt, b.vt, c.vt});
    d_.normal_triangles.push_back({a.vn, b.vn, c.vn});
    if (materials_.size() > 1) d_.materials.push_back(material_);
  }
}

/// Returns the next word, in which a backslash before a blank makes the blank part of the word.
std::string escaped_word(Scanner& s) {
  std::string word(s.word());
  while (word.ends_with('\\') && s.at < s.end && *s.at == ' ') {
    word.back() = ' ';
    word += s.word();
  }
  return word;
}

void ObjReader::other(std::string_view keyword, Scanner& s, const char* line) {
  if (keyword == "usemtl") {
    const auto [found, is_new] = material_index_.try_emplace(std::string(s.rest()), materials_.size());
    if (is_new) materials_.push_back(found->first);
    material_ = found->second;
    d_.materials.resize(d_.triangles.size(), 0);  // the faces before the first statement have material 0
    return;
  }
  if (keyword == "mtllib") {
    // Adds one file name that contains blanks, or one of several names.
    const auto add = [&](std::string path) {
      std::replace(path.begin(), path.end(), '\\', '/');
      libraries_.push_back(std::move(path));
    };
    std::error_code ignored;
    Scanner whole = s;
    const std::filesystem::path folder = file_.path().parent_path();
    if (const std::string_view name = whole.rest(); std::filesystem::exists(folder / name, ignored))
      add(std::string(name));
    else
      for (std::string word = escaped_word(s); !word.empty(); word = escaped_word(s)) add(word);
    return;
  }
  static const std::set<std::string, std::less<>> kKnown = {"g", "o", "s", "maplib", "usemap", "shadow_obj"};
  if (kKnown.contains(keyword)) return;
  const bool text = std::all_of(keyword.begin(), keyword.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (!text || keyword.size() > 32) throw file_.error_at(line, "not an OBJ statement");
  ignored_.emplace(keyword);
}

template <class PlacePoint, class PlaceNormal>
MeshData ObjReader::read(const PlacePoint& place_point, const PlaceNormal& place_normal) {
  // Memory is reserved by the size of the file: a vertex or a face takes some 30 bytes.
  d_.positions.reserve(file_.size() / 80);
  d_.triangles.reserve(file_.size() / 60);
  for (char *at = file_.begin(), *eof = at + file_.size(); at < eof;) {
    char* const end = end_of_line(at);
    Scanner s{at, end};
    const std::string_view keyword = s.word();
    if (keyword == "v") {
      const double x = number(s, "v"), y = number(s, "v"), z = number(s, "v");
      d_.positions.push_back(place_point(x, y, z));
      if (double w, r; s.number(w) && s.number(r)) ++colored_vertices_;
    } else if (keyword == "vn") {
      const double x = number(s, "vn"), y = number(s, "vn"), z = number(s, "vn");
      d_.normals.push_back(place_normal(x, y, z));
    } else if (keyword == "vt") {
      const double u = number(s, "vt");
      double v = 0;
      if (!s.at_end() && !s.number(v)) throw file_.error_at(s.at, "expected a number in vt");
      d_.uvs.push_back({float(u), float(flip_v_ ? 1 - v : v)});
    } else if (keyword == "f") {
      face(s);
    } else if (!keyword.empty() && keyword[0] != '#') {
      other(keyword, s, at);
    }
    at = end + 1;
  }
  finish();
  return std::move(d_);
}

void ObjReader::finish() {
  if (d_.triangles.empty()) throw file_.error("no faces in the file");
  // Missing entries refer to a common value: texture coordinates (0, 0), or no normal.
  const auto resolve = [&](auto& values, std::vector<TriangleIndices>& indices, const char* what,
                           bool whole) {
    const auto last = std::uint32_t(values.size());
    bool any = false, missing = false;
    std::size_t dangling = 0;
    for (TriangleIndices& t : indices) {
      for (std::uint32_t& i : t)
        if (i != kNone && i >= last) i = kNone, ++dangling;
      if (whole && std::find(t.begin(), t.end(), kNone) != t.end()) t.fill(kNone);
      for (std::uint32_t& i : t) {
        (i == kNone ? missing : any) = true;
        if (i == kNone) i = last;
      }
    }
    if (dangling)
      notes_.push_back(std::to_string(dangling) + " corners of triangles refer to " + what +
                       " that are not in the file, and have none");
    if (!any)
      values.clear(), indices.clear();
    else if (missing)
      values.emplace_back();
  };
  resolve(d_.uvs, d_.uv_triangles, "texture coordinates", false);
  resolve(d_.normals, d_.normal_triangles, "normals", true);
  if (colored_vertices_)
    notes_.push_back(std::to_string(colored_vertices_) +
                     " colours of vertices ignored: `ply` files may have them");
  for (std::string& note : triangulate_polygons(d_, polygons_, file_)) notes_.push_back(std::move(note));
}

std::vector<std::string> ObjReader::remarks() const {
  std::vector<std::string> r = notes_;
  if (small_faces_) r.push_back(std::to_string(small_faces_) + " faces of fewer than three vertices dropped");
  for (const auto& keyword : ignored_) r.push_back("statements \"" + keyword + "\" ignored");
  return r;
}

class Obj final : public Mesh {
public:
  explicit Obj(const Properties& properties) : Mesh(properties) {
    MeshFile file(properties);
    ObjReader reader(file, properties.get_bool("flip_tex_coords", true));
    double center[3] = {0, 0, 0}, scale = 1;
    if (properties.get_bool("recenter", false)) recenter(file, center, scale);
    MeshData data = reader.read(
        [&](double x, double y, double z) {
          return place_point((x - center[0]) * scale, (y - center[1]) * scale, (z - center[2]) * scale);
        },
        [this](double x, double y, double z) { return place_normal(x, y, z); });
    for (std::string& remark : reader.remarks()) remarks_.push_back(std::move(remark));
    if (reader.materials().size() < 2) data.materials = {};
    build(std::move(data), "filename");
    if (reader.materials().size() < 2) return;
    auto materials = std::make_shared<FileMaterials>();
    materials->names = reader.materials();
    materials->used.assign(materials->names.size(), false);
    for (const std::uint32_t m : this->data().materials) materials->used[m] = true;
    for (const std::string& name : reader.libraries())
      materials->libraries.push_back(file.path().parent_path() / name);
    materials_ = std::move(materials);
  }

  std::shared_ptr<const FileMaterials> materials() const override { return materials_; }
  std::vector<ShapePtr> split(std::span<const std::size_t> part_of) const override {
    return split_mesh(properties(), data(), part_of);
  }

private:
  /// Finds the centre of all vertices, and the scale by which their largest extent becomes 2.
  static void recenter(MeshFile& file, double (&center)[3], double& scale) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const char *at = file.begin(), *eof = file.end(); at < eof;) {
      const char* newline = static_cast<const char*>(std::memchr(at, '\n', std::size_t(eof - at)));
      Scanner s{at, newline ? newline : eof};
      if (s.word() == "v")
        for (int i = 0; i < 3; ++i)
          if (double v; s.number(v)) low[i] = std::min(low[i], v), high[i] = std::max(high[i], v);
      at = newline ? newline + 1 : eof;
    }
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(low[i] + high[i])) return;
      center[i] = 0.5 * (low[i] + high[i]), extent = std::max(extent, high[i] - low[i]);
    }
    if (extent > 0) scale = 2 / extent;
  }

  std::shared_ptr<const FileMaterials> materials_;
};

AUREOLE_PLUGIN(
    Obj, "shape", "obj",
    PluginDoc{
        .summary =
            "A mesh from a Wavefront OBJ file: v, vt, vn and f with polygons (convex or not) "
            "and negative indices. Groups are ignored. A nested bsdf applies to the whole mesh. "
            "Without one (and without an emitter) each material of the file is the BSDF of the scene "
            "that has its name as id, or is made from the .mtl file: Kd, map_Kd, Ks, Ns, d, map_d, and as `principled` Pr, Pm, Ps, Pc, Pcr, aniso and their maps. "
            "Without vn, normals are computed from positions, weighted by angle.",
        .source = "Normals: Thuermer & Wuethrich 1998, \"Computing vertex normals from polygonal facets\".",
        .parameters = mesh_parameters(
            {{"filename", "file", "", "required", "the OBJ file"},
             {"flip_tex_coords", "boolean", "", "true", "replace the texture coordinate v by 1 - v"},
             {"recenter", "boolean", "", "false",
              "move the box of all vertices to the origin and scale its largest extent "
              "to 2, before `to_world`"}}),
        .examples = {R"(<shape type="obj">
  <string name="filename" value="mesh.obj"/>
  <boolean name="face_normals" value="true"/>
  <boolean name="flip_tex_coords" value="false"/>
  <boolean name="flip_normals" value="false"/>
  <transform name="to_world"><rotate x="1" angle="90"/></transform>
  <bsdf type="diffuse"/>
  <emitter type="area"><float name="radiance" value="1"/></emitter>
</shape>)"}});

}  // namespace
}  // namespace aureole
