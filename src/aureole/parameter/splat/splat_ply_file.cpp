// SPDX-License-Identifier: Apache-2.0
// PLY files of splats: those of 3D Gaussian splatting (Kerbl and others 2023; graphdeco-inria/gaussian-splatting), with
// logarithms of scales, logits of opacities and rotations w, x, y, z; and point clouds with colours, normals and radii.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>

#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/ply/ply_source.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole::splat_reader {

namespace {

/// The mapped bytes of a file; errors have at most a line, since `read_splat_file` adds the file.
class SplatText final : public FileText {
public:
  explicit SplatText(const SharedBytes& bytes) {
    const char* begin = reinterpret_cast<const char*>(bytes.bytes.data());
    set_bytes(begin, begin + bytes.size());
  }
  Error error(const std::string& message) const override { return Error(message); }
  Error error_at(const char* at, const std::string& message) const override {
    return Error({{}, int(std::min<std::size_t>(line_of(at), 1 << 30)), 0}, message);
  }
};

/// A property that is kept: its position in a record, and its index among the kept numbers.
struct KeptProperty {
  std::size_t index, offset, slot;
  ply::Type type;
};

template <bool kSwap>
float number_at(const char* at, ply::Type type) {
  const auto take = [&]<class T>(T) {
    char raw[sizeof(T)];
    std::memcpy(raw, at, sizeof(T));
    if constexpr (kSwap) std::reverse(raw, raw + sizeof(T));
    return float(std::bit_cast<T>(raw));
  };
  switch (type) {
    case ply::Type::int8:
      return take(std::int8_t());
    case ply::Type::uint8:
      return take(std::uint8_t());
    case ply::Type::int16:
      return take(std::int16_t());
    case ply::Type::uint16:
      return take(std::uint16_t());
    case ply::Type::int32:
      return take(std::int32_t());
    case ply::Type::uint32:
      return take(std::uint32_t());
    case ply::Type::int64:
      return take(std::int64_t());
    case ply::Type::uint64:
      return take(std::uint64_t());
    case ply::Type::float32:
      return take(float());
    case ply::Type::float64:
      return take(double());
  }
  return 0;
}

/// The element `vertex`; its properties are found by name.
class VertexTable {
public:
  VertexTable(const SplatText& text, const ply::Header& header) : text_(text), header_(header) {
    const char* at = header.body;
    for (const ply::Element& e : header.elements) {
      if (e.name == "vertex") {
        element_ = &e;
        break;
      }
      if (header.format == ply::Format::ascii || e.has_lists())
        throw Error("has the element \"" + e.name +
                    "\" before its vertices, which is not supported: put vertices first");
      const std::size_t size = e.least_bytes();
      if (size > 0 && e.count > std::size_t(text.end() - at) / size)
        throw Error(fmt::format("is truncated: {} times \"{}\" cannot be in it", e.count, e.name));
      at += e.count * size;
    }
    if (!element_) throw Error("has no element \"vertex\"");
    body_ = at;
    for (std::size_t i = 0; i < element_->properties.size(); ++i) {
      const ply::Property& p = element_->properties[i];
      if (p.is_list) throw Error("has lists in its vertices (\"" + p.name + "\"), as no splats have");
      if (!columns_.emplace(p.name, KeptProperty{i, stride_, 0, p.type}).second)
        throw Error("has the property \"" + p.name + "\" of its vertices twice");
      stride_ += ply::size_of(p.type);
    }
    if (stride_ == 0) throw Error("has vertices without properties");
    if (element_->count == 0) throw Error("holds no vertices");
    if (element_->count > kMaxSplats)
      throw Error(fmt::format("claims {} vertices; {} are possible", element_->count, kMaxSplats));
    const std::size_t least =
        header.format == ply::Format::ascii ? 2 * element_->properties.size() - 1 : stride_;
    if (element_->count > (std::size_t(text.end() - body_) + 1) / least)
      throw Error(fmt::format(
          "is truncated: {} vertices of at least {} bytes do not fit into the {} bytes behind its header",
          element_->count, least, text.end() - body_));
  }

  std::size_t count() const { return element_->count; }
  bool has(const std::string& name) const { return columns_.contains(name); }
  bool is_integer(const std::string& name) const { return columns_.at(name).type < ply::Type::float32; }
  ply::Type type(const std::string& name) const { return columns_.at(name).type; }

  /// Keeps a property. Throws Error if there is none of that name.
  void keep(const std::string& name) {
    const auto found = columns_.find(name);
    if (found == columns_.end())
      throw Error("has vertices without the property \"" + name + "\", which " + purpose_ + " needs");
    found->second.slot = kept_.size();
    kept_.push_back(found->second);
    used_.insert(name);
  }
  /// Sets the purpose of the properties, which errors state.
  void set_purpose(std::string purpose) { purpose_ = std::move(purpose); }

  /// Calls `use(i, numbers)` for each vertex, in parallel where records have a fixed size; `numbers` are the kept
  /// properties in the order of `keep`.
  template <class Use>
  void read(const Use& use) const {
    if (header_.format == ply::Format::ascii) {
      std::vector<float> numbers(kept_.size());
      std::vector<std::size_t> slots(element_->properties.size(), kept_.size());
      for (const KeptProperty& k : kept_) slots[k.index] = k.slot;
      ply::TextSource source(text_, body_);
      for (std::size_t i = 0; i < count(); ++i) {
        for (const std::size_t slot : slots) {
          const double value = source.value(ply::Type::float64);
          if (slot < numbers.size()) numbers[slot] = float(value);
        }
        source.end_record();
        use(i, numbers.data());
      }
      has_more_lines_ = !source.finished();
      return;
    }
    if (header_.format == ply::Format::little_endian)
      read_binary<false>(use);
    else
      read_binary<true>(use);
  }

  /// Names of properties that have no effect.
  std::string unused() const {
    std::string names;
    for (const ply::Property& p : element_->properties)
      if (!used_.contains(p.name)) names += (names.empty() ? "" : ", ") + p.name;
    return names;
  }
  void ignore(const std::string& name) { used_.insert(name); }
  /// The bytes that are left behind the vertices of a binary file, or whether there are such lines in one of text, where no other
  /// elements follow.
  std::string rest() const {
    if (element_ != &header_.elements.back()) return "";
    if (header_.format == ply::Format::ascii) return has_more_lines_ ? "lines" : "";
    const auto left = std::size_t(text_.end() - body_) - stride_ * count();
    return left > 0 ? fmt::format("{} bytes", left) : "";
  }

private:
  template <bool kSwap, class Use>
  void read_binary(const Use& use) const {
    for_ranges(count(), [&](std::size_t begin, std::size_t end) {
      std::vector<float> numbers(kept_.size());
      for (std::size_t i = begin; i < end; ++i) {
        const char* record = body_ + stride_ * i;
        for (const KeptProperty& k : kept_) numbers[k.slot] = number_at<kSwap>(record + k.offset, k.type);
        use(i, numbers.data());
      }
    });
  }

  const SplatText& text_;
  const ply::Header& header_;
  const ply::Element* element_ = nullptr;
  const char* body_ = nullptr;
  std::size_t stride_ = 0;
  mutable bool has_more_lines_ = false;  ///< behind the vertices of a file of text that was read
  std::map<std::string, KeptProperty> columns_;
  std::vector<KeptProperty> kept_;
  std::set<std::string> used_;
  std::string purpose_ = "a point";
};

/// Returns the degree of the harmonics by the number of properties f_rest_*.
int degree_of(const VertexTable& table, std::size_t& rest) {
  for (rest = 0; table.has(fmt::format("f_rest_{}", rest));) ++rest;
  for (std::size_t k = rest; k < 100; ++k)
    if (table.has(fmt::format("f_rest_{}", k)))
      throw Error(fmt::format("has the property f_rest_{}, but no f_rest_{}", k, rest));
  for (int degree = 0; degree <= 4; ++degree)
    if (rest == std::size_t(3 * ((degree + 1) * (degree + 1) - 1))) return degree;
  throw Error(fmt::format(
      "has {} properties f_rest_*; 0, 9, 24 or 45 are expected, for spherical harmonics of degree 0 to 3",
      rest));
}

SplatCloud read_gaussians(VertexTable& table) {
  SplatCloud c;
  c.format = "PLY of 3D Gaussian splatting", c.axes = "RDF";
  std::size_t rest;
  const int stored = degree_of(table, rest), degree = std::min(stored, kMaxHarmonicDegree);
  if (stored > degree)
    c.notes.push_back("has spherical harmonics of degree 4; those up to degree 3 are used");
  table.set_purpose("a Gaussian splat");
  // whether the splats are flat, as in 2D Gaussian splatting
  const bool is_flat = table.has("scale_1") && !table.has("scale_2");
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
                           is_flat ? "scale_1" : "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    table.keep(name);
  constexpr std::size_t kRest = 14;
  for (std::size_t k = 0; k < rest; ++k) table.keep(fmt::format("f_rest_{}", k));
  // ignored, since the original program writes normals of 0
  for (const char* name : {"nx", "ny", "nz"}) table.ignore(name);
  if (is_flat) c.notes.push_back("has two scales per splat: splats are flat, their third scale is 0");
  c.resize(table.count(), degree);
  const std::size_t terms = c.coefficients() - 1, channel = rest / 3;
  table.read([&](std::size_t i, const float* v) {
    c.positions[i] = {v[0], v[1], v[2]};
    c.opacities[i] = sigmoid(v[6]);
    c.scales[i] = {std::exp(v[7]), std::exp(v[8]), is_flat ? 0.f : std::exp(v[9])};
    c.rotations[i] = {v[10], v[11], v[12], v[13]};
    float* h = &c.harmonics[3 * c.coefficients() * i];
    for (std::size_t k = 0; k < 3; ++k) h[k] = v[3 + k];
    // coefficients are reordered, since all coefficients of red come first in the file
    for (std::size_t k = 0; k < terms; ++k)
      for (std::size_t color = 0; color < 3; ++color) h[3 * (k + 1) + color] = v[kRest + color * channel + k];
  });
  return c;
}

/// Returns the rotation from the z axis to a normal, or the identity for a normal of length 0.
std::array<float, 4> rotation_to(const Vec3& n) {
  const float l = length(n);
  if (!(l > 0) || !std::isfinite(l)) return {1, 0, 0, 0};
  const Vec3 u = n * (1 / l);
  if (u.z < -0.999999f) return {0, 1, 0, 0};
  const float w = std::sqrt(0.5f * (1 + u.z));
  return {w, -u.y / (2 * w), u.x / (2 * w), 0};
}

SplatCloud read_points(VertexTable& table, const SplatFileOptions& options) {
  SplatCloud c;
  c.kind = SplatCloud::Kind::points;
  c.format = "PLY of points", c.axes = "RUB";
  const auto has_all = [&](std::initializer_list<const char*> names) {
    return std::all_of(names.begin(), names.end(), [&](const char* n) { return table.has(n); });
  };
  std::vector<std::string> colors;
  for (const auto& names : {std::vector<std::string>{"red", "green", "blue"},
                            {"r", "g", "b"},
                            {"diffuse_red", "diffuse_green", "diffuse_blue"}})
    if (colors.empty() && table.has(names[0]) && table.has(names[1]) && table.has(names[2])) colors = names;
  std::string radius;
  for (const char* name : {"radius", "radii", "value", "scalar_radius"})
    if (radius.empty() && table.has(name) && std::string_view(name) != "value") radius = name;
  for (const char* name : {"x", "y", "z"}) table.keep(name);
  c.has_normals = has_all({"nx", "ny", "nz"});
  std::size_t slot = 3;
  const std::size_t normals = slot;
  if (c.has_normals) {
    for (const char* name : {"nx", "ny", "nz"}) table.keep(name);
    slot += 3;
  }
  const std::size_t color = slot;
  float color_scale = 1;
  if (!colors.empty()) {
    for (const std::string& name : colors) table.keep(name);
    slot += 3;
    if (table.is_integer(colors[0]))
      color_scale = table.type(colors[0]) == ply::Type::uint16 ? 1 / 65535.f : 1 / 255.f;
    else
      c.hints.colors = SplatHints::Colors::linear;
  } else {
    c.notes.push_back("has points without colours (red, green, blue): they are white");
  }
  const std::size_t radii = slot;
  if (!radius.empty()) {
    table.keep(radius);
    if (options.radius > 0)
      c.notes.push_back(
          "has points with radii: the radius that is stated for points without one has no effect");
  }
  const std::string unused = table.unused();
  if (!unused.empty()) c.notes.push_back("has properties of its points that have no effect: " + unused);
  c.resize(table.count(), 0);
  std::atomic<std::size_t> without_normal{0};
  table.read([&](std::size_t i, const float* v) {
    c.positions[i] = {v[0], v[1], v[2]};
    const float r = (radius.empty() ? options.radius : v[radii]) * options.radius_scale;
    c.scales[i] = {r, r, c.has_normals ? 0.f : r};
    c.rotations[i] = {1, 0, 0, 0};
    if (c.has_normals) {
      const Vec3 normal{v[normals], v[normals + 1], v[normals + 2]};
      without_normal += !(length(normal) > 0 && std::isfinite(length(normal)));
      c.rotations[i] = rotation_to(normal);
    }
    c.opacities[i] = 1;
    for (std::size_t k = 0; k < 3; ++k)
      c.harmonics[3 * i + k] = ((colors.empty() ? 1.f : v[color + k] * color_scale) - 0.5f) / kHarmonic0;
  });
  if (without_normal > 0)
    c.notes.push_back(fmt::format(
        "has {} of {} points with a normal that is not finite or has no length: their discs lie across the z axis of the file",
        without_normal.load(), c.size()));
  return c;
}

void note_rest(const VertexTable& table, SplatCloud& c) {
  if (const std::string rest = table.rest(); !rest.empty())
    c.notes.push_back(fmt::format(
        "has {} behind the {} vertices that its header states, which have no effect", rest, table.count()));
}

}  // namespace

SplatCloud read_ply(const Path&, const SharedBytes& bytes, const SplatFileOptions& options) {
  const SplatText text(bytes);
  const ply::Header header = ply::read_header(text);
  VertexTable table(text, header);
  if (table.has("packed_position"))
    throw Error(
        "is a compressed PLY (packed_position, packed_rotation), which is not read: convert it to a plain PLY or .spz");
  if (!table.has("f_dc_0")) {
    for (const char* name : {"scale_0", "rot_0", "f_rest_0"})
      if (table.has(name))
        throw Error(std::string("has the property ") + name + ", but no f_dc_0, f_dc_1 and f_dc_2");
    SplatCloud points = read_points(table, options);
    note_rest(table, points);
    return points;
  }
  SplatCloud c = read_gaussians(table);
  note_rest(table, c);
  const std::string unused = table.unused();
  if (!unused.empty()) c.notes.push_back("has properties of its splats that have no effect: " + unused);
  if (options.radius > 0)
    c.notes.push_back("holds Gaussian splats, which have scales: a radius has no effect");
  return c;
}

}  // namespace aureole::splat_reader
