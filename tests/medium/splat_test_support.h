// SPDX-License-Identifier: Apache-2.0
// Files of splats for tests.
#pragma once

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace aureole::test {

class SplatFolder {
public:
  SplatFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "aureole-splats-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~SplatFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    const auto file = path_ / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

/// A splat as a reader of this test suite thinks of it: opacity and scales as they are, the colour without a direction.
struct PlainSplat {
  std::array<double, 3> position{0, 0, 0}, scale{0.1, 0.1, 0.1};
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< w, x, y, z
  double opacity = 0.5;
  std::array<double, 3> color{0.5, 0.5, 0.5};
  std::vector<std::array<double, 3>> rest = {};  ///< harmonics above degree 0
};

constexpr double kPlainHarmonic0 = 0.28209479177387814;  // sqrt(1 / (4 pi))

inline std::vector<std::string> splat_properties(std::size_t rest) {
  std::vector<std::string> names = {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (std::size_t k = 0; k < 3 * rest; ++k) names.push_back("f_rest_" + std::to_string(k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    names.push_back(name);
  return names;
}

/// The numbers of a splat in the order of `splat_properties`.
inline std::vector<double> splat_numbers(const PlainSplat& s) {
  std::vector<double> v(s.position.begin(), s.position.end());
  for (const double c : s.color) v.push_back((c - 0.5) / kPlainHarmonic0);
  for (std::size_t c = 0; c < 3; ++c)
    for (const auto& r : s.rest) v.push_back(r[c]);
  v.push_back(std::log(s.opacity / (1 - s.opacity)));
  for (const double x : s.scale) v.push_back(std::log(x));
  v.insert(v.end(), s.rotation.begin(), s.rotation.end());
  return v;
}

enum class PlyKind { little, big, ascii };

inline std::string make_ply(const std::vector<std::string>& names,
                            const std::vector<std::vector<double>>& rows, PlyKind kind = PlyKind::little,
                            std::size_t claimed = 0) {
  const char* formats[] = {"binary_little_endian", "binary_big_endian", "ascii"};
  std::string s = std::string("ply\nformat ") + formats[int(kind)] + " 1.0\nelement vertex " +
                  std::to_string(claimed ? claimed : rows.size()) + "\n";
  for (const std::string& name : names) s += "property float " + name + "\n";
  s += "end_header\n";
  for (const auto& row : rows) {
    for (const double x : row) {
      if (kind == PlyKind::ascii) {
        char text[40];
        std::snprintf(text, sizeof text, "%.9g ", x);
        s += text;
        continue;
      }
      const float f = float(x);
      char raw[4];
      std::memcpy(raw, &f, 4);
      if (kind == PlyKind::big) std::swap(raw[0], raw[3]), std::swap(raw[1], raw[2]);
      s.append(raw, 4);
    }
    if (kind == PlyKind::ascii) s += "\n";
  }
  return s;
}

inline std::string make_ply(const std::vector<PlainSplat>& splats, PlyKind kind = PlyKind::little) {
  std::vector<std::vector<double>> rows;
  for (const PlainSplat& s : splats) rows.push_back(splat_numbers(s));
  return make_ply(splat_properties(splats.front().rest.size()), rows, kind);
}

inline std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace aureole::test
