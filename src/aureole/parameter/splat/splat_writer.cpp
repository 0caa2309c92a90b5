// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/splat/splat_writer.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

/// Appends numbers as bytes, little-endian like the machine.
class SplatBytes {
public:
  template <class T>
  void add(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add_text(const std::string& text) { bytes_ += text; }
  std::string& bytes() { return bytes_; }

private:
  std::string bytes_;
};

float logit(float p) {
  const double limited = std::clamp(double(p), 1e-7, 1 - 1e-7);
  return float(std::log(limited / (1 - limited)));
}

std::string ply_of_gaussians(const SplatCloud& c, std::vector<std::string>& notes) {
  if (c.hints.colors == SplatHints::Colors::linear)
    notes.push_back(
        "PLY does not say that the colours are linear: state color_space \"linear\" where it is read");
  SplatBytes out;
  const std::size_t rest = c.coefficients() - 1;
  out.add_text(fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", c.size()));
  const auto property = [&](const std::string& name) { out.add_text("property float " + name + "\n"); };
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"}) property(name);
  for (std::size_t k = 0; k < 3 * rest; ++k) property(fmt::format("f_rest_{}", k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    property(name);
  out.add_text("end_header\n");
  std::size_t flat = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    out.add(c.positions[i]), out.add(Vec3{});
    const float* h = c.harmonics_of(i);
    for (int k = 0; k < 3; ++k) out.add(h[k]);
    for (std::size_t color = 0; color < 3; ++color)
      for (std::size_t k = 0; k < rest; ++k) out.add(h[3 * (k + 1) + color]);
    out.add(logit(c.opacities[i]));
    for (int k = 0; k < 3; ++k) {
      constexpr float kSmallest = 1e-12f;
      flat += c.scales[i][k] < kSmallest;
      out.add(std::log(std::max(c.scales[i][k], kSmallest)));
    }
    out.add(c.rotations[i]);
  }
  if (flat > 0)
    notes.push_back(fmt::format("{} scales of 0 have no logarithm: they are written as 1e-12", flat));
  return std::move(out.bytes());
}

std::string ply_of_points(const SplatCloud& c, std::vector<std::string>& notes) {
  SplatBytes out;
  out.add_text(fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", c.size()));
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"})
    out.add_text(std::string("property float ") + name + "\n");
  for (const char* name : {"red", "green", "blue"})
    out.add_text(std::string("property uchar ") + name + "\n");
  out.add_text("end_header\n");
  std::size_t clipped = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const auto [w, x, y, z] = c.rotations[i];
    out.add(c.positions[i]);
    out.add(Vec3{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)});
    out.add(c.scales[i].x);
    for (int k = 0; k < 3; ++k) {
      const float color = 0.5f + kHarmonic0 * c.harmonics_of(i)[k];
      clipped += color > 1.002f || color < -0.002f;
      out.add(std::uint8_t(std::lround(255 * std::clamp(color, 0.f, 1.f))));
    }
  }
  if (clipped > 0) notes.push_back(fmt::format("{} colours lie outside of [0, 1] and are clipped", clipped));
  return std::move(out.bytes());
}

/// Compresses by gzip without a time stamp, so that equal clouds give equal files.
std::string gzip_of(const std::string& bytes) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string out;
  std::size_t read = 0;
  int status = Z_OK;
  std::vector<char> room(1 << 18);
  while (status != Z_STREAM_END) {
    const std::size_t given = std::min<std::size_t>(bytes.size() - read, 1 << 30);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + read));
    stream.avail_in = unsigned(given);
    stream.next_out = reinterpret_cast<Bytef*>(room.data()), stream.avail_out = unsigned(room.size());
    status = deflate(&stream, read + given == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    read += given - stream.avail_in;
    out.append(room.data(), room.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return out;
}

std::string spz_of(const SplatCloud& c, std::vector<std::string>& notes) {
  SplatBytes out;
  std::size_t clipped = 0;
  // Number of fractional bits of the 24-bit positions: as many as the farthest position allows.
  float farthest = 0;
  for (const Vec3& p : c.positions) farthest = std::max(farthest, max_component(abs(p)));
  int bits = 12;
  while (bits > 0 && std::ldexp(farthest, bits) > 8388607) --bits;
  if (std::ldexp(farthest, bits) > 8388607)
    throw Error(fmt::format("a coordinate of {:g} is too far for .spz, which ends at 8388607", farthest));
  const auto byte = [&](float value) {
    clipped += !(value > -0.51f && value < 255.51f);
    out.add(std::uint8_t(std::lround(std::clamp(value, 0.f, 255.f))));
  };
  out.add(std::uint32_t(0x5053474e)), out.add(std::uint32_t(3)), out.add(std::uint32_t(c.size()));
  for (const int v : {c.degree, bits, int(c.hints.antialiased), 0}) out.add(std::uint8_t(v));
  for (const Vec3& p : c.positions)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t fixed = std::int32_t(std::lround(std::ldexp(p[k], bits)));
      for (const int shift : {0, 8, 16}) out.add(std::uint8_t(std::uint32_t(fixed) >> shift));
    }
  for (const float o : c.opacities) byte(255 * o);
  for (std::size_t i = 0; i < c.size(); ++i)
    for (int k = 0; k < 3; ++k) byte(c.harmonics_of(i)[k] * 0.15f * 255 + 127.5f);
  for (const Vec3& s : c.scales)
    for (int k = 0; k < 3; ++k) byte((std::log(std::max(s[k], 1e-12f)) + 10) * 16);
  for (const auto& q : c.rotations) {
    const float xyzw[4] = {q[1], q[2], q[3], q[0]};
    std::uint32_t largest = 0;
    for (std::uint32_t k = 1; k < 4; ++k)
      if (std::abs(xyzw[k]) > std::abs(xyzw[largest])) largest = k;
    const float sign = xyzw[largest] < 0 ? -1.f : 1.f;
    std::uint32_t packed = largest;
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (k == largest) continue;
      const float v = sign * xyzw[k];
      const auto magnitude =
          std::min<std::uint32_t>(511, std::uint32_t(std::lround(std::abs(v) * 1.41421356f * 511)));
      packed = packed << 10 | (v < 0 ? 512u : 0u) | magnitude;
    }
    out.add(packed);
  }
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t k = 3; k < 3 * c.coefficients(); ++k) byte(c.harmonics_of(i)[k] * 128 + 128);
  notes.push_back(
      fmt::format("positions are rounded to {:g}, all other numbers to 8 bits or 10", std::ldexp(1., -bits)));
  if (clipped > 0)
    notes.push_back(fmt::format("{} numbers lie outside of the range of .spz and are clipped", clipped));
  if (c.hints.colors == SplatHints::Colors::linear)
    notes.push_back(
        ".spz does not say that the colours are linear: state color_space \"linear\" where it is read");
  return gzip_of(out.bytes());
}

std::string glb_of(const SplatCloud& c, std::vector<std::string>& notes) {
  SplatBytes binary;
  std::string views, accessors, attributes;
  int count = 0;
  const std::size_t n = c.size();
  const auto accessor = [&](const std::string& name, const char* type, std::size_t width,
                            const std::string& more, const auto& value) {
    const std::size_t begin = binary.bytes().size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < width; ++k) binary.add(float(value(i, k)));
    const char* comma = count ? "," : "";
    views += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})", comma, begin,
                         binary.bytes().size() - begin);
    accessors += fmt::format(R"({}{{"bufferView":{},"componentType":5126,"count":{},"type":"{}"{}}})", comma,
                             count, n, type, more);
    attributes += fmt::format(R"({}"{}":{})", comma, name, count);
    ++count;
  };
  Bounds3 box;
  for (const Vec3& p : c.positions) box.extend(p);
  const std::string prefix = "KHR_gaussian_splatting:";
  accessor("POSITION", "VEC3", 3,
           fmt::format(R"(,"min":[{:.9g},{:.9g},{:.9g}],"max":[{:.9g},{:.9g},{:.9g}])", box.lower.x,
                       box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z),
           [&](std::size_t i, std::size_t k) { return c.positions[i][int(k)]; });
  accessor(prefix + "ROTATION", "VEC4", 4, "",
           [&](std::size_t i, std::size_t k) { return c.rotations[i][(k + 1) % 4]; });
  accessor(prefix + "SCALE", "VEC3", 3, "",
           [&](std::size_t i, std::size_t k) { return c.scales[i][int(k)]; });
  accessor(prefix + "OPACITY", "SCALAR", 1, "", [&](std::size_t i, std::size_t) { return c.opacities[i]; });
  std::size_t term = 0;
  for (int l = 0; l <= c.degree; ++l)
    for (int m = 0; m < 2 * l + 1; ++m, ++term)
      accessor(fmt::format("{}SH_DEGREE_{}_COEF_{}", prefix, l, m), "VEC3", 3, "",
               [&](std::size_t i, std::size_t k) { return c.harmonics_of(i)[3 * term + k]; });
  if (c.hints.antialiased)
    notes.push_back(
        "KHR_gaussian_splatting does not say that opacities are compensated for dilation: state compensation \"on\"");
  if (c.hints.sorting == SplatHints::Sorting::z_depth)
    notes.push_back(
        "KHR_gaussian_splatting sorts by the distance from the camera; these splats were to be sorted by depth");
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"aureole"}},"extensionsUsed":["KHR_gaussian_splatting"],"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"mode":0,"attributes":{{{}}},"extensions":{{"KHR_gaussian_splatting":)"
      R"({{"kernel":"ellipse","colorSpace":"{}","projection":"perspective","sortingMethod":"cameraDistance"}}}}}}]}}],)"
      R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}})",
      attributes, c.hints.colors == SplatHints::Colors::linear ? "lin_rec709_display" : "srgb_rec709_display",
      binary.bytes().size(), views, accessors);
  while (json.size() % 4 != 0) json += ' ';
  const std::size_t size = 12 + 8 + json.size() + 8 + binary.bytes().size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw Error(".glb ends at 4 GiB, but this cloud needs more: write .ply");
  SplatBytes out;
  out.add_text("glTF"), out.add(std::uint32_t(2)), out.add(std::uint32_t(size));
  out.add(std::uint32_t(json.size())), out.add(std::uint32_t(0x4E4F534A)), out.add_text(json);
  out.add(std::uint32_t(binary.bytes().size())), out.add(std::uint32_t(0x004E4942)),
      out.add_text(binary.bytes());
  return std::move(out.bytes());
}

std::string usda_of(const SplatCloud& c, std::vector<std::string>& notes) {
  Bounds3 box;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const float reach = 3 * max_component(c.scales[i]);  // standard deviations
    box.extend(c.positions[i] - Vec3{reach, reach, reach}),
        box.extend(c.positions[i] + Vec3{reach, reach, reach});
  }
  std::string out = fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"Splats\"\n    doc = \"written by aureole\"\n    metersPerUnit = 1\n"
      "    upAxis = \"Y\"\n)\n\ndef ParticleField3DGaussianSplat \"Splats\"\n{{\n"
      "    float3[] extent = [({:.9g}, {:.9g}, {:.9g}), ({:.9g}, {:.9g}, {:.9g})]\n",
      box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
  const auto array = [&](const char* declaration, std::size_t count, std::size_t width, const auto& value) {
    auto to = std::back_inserter(out);
    fmt::format_to(to, "    {} = [", declaration);
    for (std::size_t i = 0; i < count; ++i) {
      out += i > 0 ? ", " : "";
      out += width > 1 ? "(" : "";
      for (std::size_t k = 0; k < width; ++k)
        fmt::format_to(to, "{}{:.9g}", k > 0 ? ", " : "", float(value(i, k)));
      out += width > 1 ? ")" : "";
    }
    out += "]\n";
  };
  const std::size_t n = c.size();
  array("point3f[] positions", n, 3, [&](std::size_t i, std::size_t k) { return c.positions[i][int(k)]; });
  array("quatf[] orientations", n, 4, [&](std::size_t i, std::size_t k) { return c.rotations[i][k]; });
  array("float3[] scales", n, 3, [&](std::size_t i, std::size_t k) { return c.scales[i][int(k)]; });
  array("float[] opacities", n, 1, [&](std::size_t i, std::size_t) { return c.opacities[i]; });
  out += fmt::format("    uniform int radiance:sphericalHarmonicsDegree = {}\n", c.degree);
  array("float3[] radiance:sphericalHarmonicsCoefficients", n * c.coefficients(), 3,
        [&](std::size_t i, std::size_t k) { return c.harmonics[3 * i + k]; });
  out += fmt::format(
      "    uniform token projectionModeHint = \"{}\"\n    uniform token sortingModeHint = \"{}\"\n}}\n",
      c.hints.projection == SplatHints::Projection::tangential ? "tangential" : "perspective",
      c.hints.sorting == SplatHints::Sorting::z_depth ? "zDepth" : "cameraDistance");
  if (c.hints.antialiased)
    notes.push_back(
        "USD does not say that opacities are compensated for dilation: state compensation \"on\"");
  if (c.hints.colors == SplatHints::Colors::linear)
    notes.push_back(
        "USD does not say that the colours are linear: state color_space \"linear\" where it is read");
  return out;
}

}  // namespace

const std::vector<std::string>& splat_extensions() {
  static const std::vector<std::string> kExtensions = {".ply", ".spz", ".glb", ".usda"};
  return kExtensions;
}

std::vector<std::string> write_splat_file(const std::filesystem::path& file, const SplatCloud& cloud) {
  std::vector<std::string> notes;
  const std::string extension = lower_extension(file);
  std::string bytes;
  try {
    if (extension == ".ply" && cloud.kind == SplatCloud::Kind::points)
      bytes = ply_of_points(cloud, notes);
    else if (extension == ".ply")
      bytes = ply_of_gaussians(turned_axes(cloud, "RDF"), notes);
    else if (extension == ".spz")
      bytes = spz_of(cloud, notes);
    else if (extension == ".glb")
      bytes = glb_of(cloud, notes);
    else if (extension == ".usda")
      bytes = usda_of(cloud, notes);
    else
      throw Error("has the extension \"" + extension + "\"; splats are written as .ply, .spz, .glb or .usda");
  } catch (const Error& problem) {
    throw Error({file.string(), 0, 0}, problem.message());
  }
  write_file_atomically(file, bytes);
  return notes;
}

}  // namespace aureole
