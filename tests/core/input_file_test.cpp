// SPDX-License-Identifier: Apache-2.0
// Files are read if they are regular files, and by every reader in the same way: a pipe that nobody writes to
// must not block, a device without an end must not fill the memory.
#include "aureole/core/input_file.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <functional>

#include "aureole/aperture/svg/svg.h"
#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/instrument/microscopy/micrograph.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/loading/load.h"
#include "aureole/loading/values.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/parameter/palette_file.h"
#include "aureole/parameter/vdb/vdb_file.h"
#include "aureole/parameter/voxel_data.h"
#include "aureole/plugin/registry.h"
#include "aureole/render/state.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::string message_of(const std::function<void()>& f) {
  try {
    f();
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

/// Paths that are no regular files, and what they are called.
std::vector<std::pair<fs::path, std::string>> irregular_paths(const TemporaryFolder& folder) {
  const fs::path pipe = folder.path / "pipe", link = folder.path / "link",
                 socket_path = folder.path / "socket";
  EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("pipe", link);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  EXPECT_LT(socket_path.string().size(), sizeof address.sun_path);
  socket_path.string().copy(address.sun_path, sizeof address.sun_path - 1);
  const int s = ::socket(AF_UNIX, SOCK_STREAM, 0);
  EXPECT_EQ(::bind(s, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(s);
  return {{pipe, "pipe"},
          {link, "pipe"},
          {socket_path, "socket"},
          {folder.path, "folder"},
          {"/dev/zero", "device"}};
}

TEST(InputFile, RegularFilesOnly) {
  const TemporaryFolder folder;
  for (const auto& [path, kind] : irregular_paths(folder)) {
    EXPECT_EQ(fault_of_input(path), "not a regular file but a " + kind);
    EXPECT_EQ(irregular_kind(path), "a " + kind);
    EXPECT_EQ(message_of([&path = path] { const InputFile file(path); }),
              path.string() + ": not a regular file but a " + kind);
  }
  EXPECT_EQ(fault_of_input(folder.path / "none"), "no such file");
  EXPECT_EQ(irregular_kind(folder.path / "none"), "");
  const fs::path file = folder.write("file", "0123456789");
  EXPECT_EQ(fault_of_input(file), "");
  InputFile input(file);
  char text[4] = {};
  input.read(text, 2);
  input.skip(5);
  EXPECT_EQ(input.left(), 3u);
  input.read(text, 3);
  EXPECT_STREQ(text, "789");
  EXPECT_EQ(message_of([&] { input.read(text, 1); }), file.string() + ": is truncated: 1 bytes are missing");
}

TEST(InputFile, EveryReaderRefusesWhatIsNoRegularFile) {
  const TemporaryFolder folder;
  bool unknown = false;
  const std::vector<std::pair<std::string, std::function<void(const fs::path&)>>> readers{
      {"image", [](const fs::path& p) { read_image(p); }},
      {"grid", [](const fs::path& p) { read_vol(p); }},
      {"volume", [](const fs::path& p) { read_scalar_grid(p); }},
      {"vdb", [&](const fs::path& p) { read_vdb_file(p, {}, unknown); }},
      {"spectrum", [](const fs::path& p) { read_spectrum_file(p); }},
      {"palette", [](const fs::path& p) { read_palette_file(p.string()); }},
      {"samples", [](const fs::path& p) { read_sample_file(p.string()); }},
      {"svg", [](const fs::path& p) { read_svg_rings(p); }},
      {"micrograph", [](const fs::path& p) { read_micrograph(p, {}); }},
      {"state", [](const fs::path& p) { RenderState::load(p); }},
      {"scene", [](const fs::path& p) { load_scene(p); }},
  };
  for (const auto& [path, kind] : irregular_paths(folder))
    for (const auto& [name, read] : readers) {
      const std::string message = message_of([&read = read, &path = path] { read(path); });
      EXPECT_NE(message.find("not a regular file but a " + kind), std::string::npos)
          << name << ": " << message;
    }
  // The kinds of samples that the name decides.
  for (const char* name : {"a.json", "a.cxf", "a.csv", "a.cgats"}) {
    ASSERT_EQ(::mkfifo((folder.path / name).c_str(), 0600), 0);
    EXPECT_NE(message_of([&] { read_sample_file((folder.path / name).string()); }).find("but a pipe"),
              std::string::npos);
  }
}

TEST(InputFile, EveryFileParameterOfAScene) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  int parameters = 0;
  for (const PluginInfo& plugin : Registry::instance().all())
    for (const ParameterDoc& row : plugin.doc.parameters) {
      if (row.type != "file") continue;
      ++parameters;
      const std::string element = "<" + plugin.family + " type=\"" + plugin.name + "\"><string name=\"" +
                                  row.name + "\" value=\"" + pipe.string() + "\"/></" + plugin.family + ">";
      const auto errors = test::errors_of(element);
      const bool said = std::any_of(errors.begin(), errors.end(), [](const std::string& e) {
        return e.find("not a regular file but a pipe") != std::string::npos;
      });
      EXPECT_TRUE(said) << element << ::testing::PrintToString(errors);
    }
  EXPECT_GE(parameters, 10);
  EXPECT_NE(test::error_of("<include filename=\"" + pipe.string() + "\"/>").find("but a pipe"),
            std::string::npos);
}

TEST(InputFile, SizesAreBounded) {
  const TemporaryFolder folder;
  // Files with holes: large, but of no blocks on the disc.
  const auto hole = [&](const char* name, const std::string& head, std::uintmax_t size) {
    const fs::path file = folder.write(name, head);
    fs::resize_file(file, size);
    return file;
  };
  constexpr std::uintmax_t kTiB = std::uintmax_t(1) << 40;
  EXPECT_NE(message_of([&] { read_spectrum_file(hole("a.spd", "400 1\n", kTiB)); }).find("limit of 33554432"),
            std::string::npos);
  EXPECT_NE(message_of([&] { load_scene(hole("a.xml", "<scene>", kTiB)); }).find("limit of 268435456"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read_svg_rings(hole("a.svg", "<svg>", kTiB)); }).find("limit of"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read_image(hole("a.exr", "\x76\x2f\x31\x01", kTiB)); }).find("limit of"),
            std::string::npos);
  EXPECT_NE(
      message_of([&] { RenderState::load(hole("a.state", "aureole", kTiB)); }).find("more than the memory"),
      std::string::npos);
}

}  // namespace
}  // namespace aureole
