// SPDX-License-Identifier: Apache-2.0
// Files and volumes for the tests of grids.
#pragma once

#include <unistd.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "aureole/volume/volume.h"
#include "harness/properties_builder.h"

namespace aureole::test {

/// A folder for files of volumes, removed at the end.
class VolumeFolder {
public:
  VolumeFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "aureole-volume-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~VolumeFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

/// The bytes of a .vol file; parts may be changed before they are written.
struct VolFile {
  std::string magic = "VOL";
  std::uint8_t version = 3;
  std::int32_t encoding = 1, width = 1, height = 1, depth = 1, channels = 1;
  std::array<float, 6> box{0, 0, 0, 1, 1, 1};
  std::string data;

  template <class Number>
  void set_data(const std::vector<Number>& numbers) {
    data.assign(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  }
  std::string bytes() const {
    std::string s = magic + char(version);
    const auto add = [&](const auto& v) { s.append(reinterpret_cast<const char*>(&v), sizeof v); };
    for (const std::int32_t v : {encoding, width, height, depth, channels}) add(v);
    for (const float v : box) add(v);
    return s + data;
  }
};

inline VolFile make_vol(const std::array<int, 3>& size, int channels, const std::vector<float>& values) {
  VolFile vol;
  vol.width = size[0], vol.height = size[1], vol.depth = size[2], vol.channels = channels;
  vol.set_data(values);
  return vol;
}

inline std::filesystem::path write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

/// A <volume type="gridvolume"> of that file.
inline std::string grid_xml(const std::filesystem::path& file, const std::string& parameters = "") {
  return "<volume type=\"gridvolume\"><string name=\"filename\" value=\"" + file.string() + "\"/>" +
         parameters + "</volume>";
}

/// A <volume type="gridvolume"> of that file over [-1, 1]^3, which `steps` of a transform then move, as the parameter `name`.
inline std::string grid_over_cube(const std::filesystem::path& file, const std::string& name,
                                  const std::string& parameters, const std::string& steps = "") {
  std::string all = grid_xml(file, parameters +
                                       "<transform name=\"to_world\"><translate x=\"-0.5\" y=\"-0.5\" "
                                       "z=\"-0.5\"/><scale value=\"2\"/>" +
                                       steps + "</transform>");
  return all.insert(all.find(' '), " name=\"" + name + "\"");
}

inline VolumePtr build_grid(const std::filesystem::path& file, const std::string& parameters = "") {
  return testing::build<Volume>(grid_xml(file, parameters));
}

inline std::string choice(const std::string& name, const std::string& value) {
  return "<string name=\"" + name + "\" value=\"" + value + "\"/>";
}

template <std::invocable F>
std::string error_thrown_by(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace aureole::test
