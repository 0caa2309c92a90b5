// SPDX-License-Identifier: Apache-2.0
// file_format: the format that a film asks for, the pictures that .hdr and .pfm can hold, and the files.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "aureole/render/output.h"
#include "tests/harness/paths.h"
#include "tests/harness/properties_builder.h"
#include "tests/loading/load_text.h"
#include "tests/render/small_scene.h"

namespace aureole::test {
namespace {

Development development(std::vector<std::string> names) {
  Development d;
  d.names = std::move(names);
  return d;
}
std::string problem(const std::vector<std::string>& names, const std::string& file, int replicates = 1) {
  try {
    require_format(development(names), replicates, file);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(FileFormat, SaysWhatAFileCannotHold) {
  const std::vector<std::string> rgb = {"R", "G", "B"}, y = {"Y"};
  for (const char* file : {"a.exr", "a.hdr", "a.rgbe", "a.pfm"}) {
    EXPECT_EQ(problem(rgb, file), "");
    EXPECT_EQ(problem(y, file), "");
    EXPECT_EQ(problem({"R", "G", "B", "A"}, file), "");
  }
  EXPECT_EQ(problem({"X", "Y", "Z"}, "a.exr", 16), "");
  EXPECT_NE(problem(rgb, "a.pfm", 16).find("variances"), std::string::npos);
  EXPECT_NE(problem({"X", "Y", "Z"}, "a.hdr").find("channels"), std::string::npos);
  EXPECT_NE(problem({"R", "G", "B", "depth"}, "a.pfm").find("depth"), std::string::npos);
  EXPECT_NE(problem({"S0.550,00nm"}, "a.pfm").find("S0.550"), std::string::npos);
  EXPECT_NE(problem(rgb, "a.jpg").find(".pfm"), std::string::npos);
}

TEST(FileFormat, FilmsAskForEndingsAndFormats) {
  Diagnostics notes;
  const auto film = [&](const std::string& content) {
    return testing::build<Film>("<film type='hdrfilm'>" + content + "</film>",
                                testing::make_context(360, 830, &notes));
  };
  const auto set = [](const char* name, const char* value) {
    return std::string("<string name='") + name + "' value='" + value + "'/>";
  };
  EXPECT_EQ(film("")->file_extension(), ".exr");
  EXPECT_EQ(film(set("file_format", "rgbe"))->file_extension(), ".hdr");
  EXPECT_EQ(film(set("file_format", "pfm") + set("pixel_format", "luminance"))->channel_names(),
            std::vector<std::string>{"Y"});
  EXPECT_TRUE(notes.notes().empty());
  EXPECT_EQ(film(set("file_format", "pfm") + set("pixel_format", "rgba"))->channel_names().size(), 3u);
  EXPECT_EQ(film(set("file_format", "rgbe") + set("pixel_format", "luminance"))->channel_names().size(), 3u);
  EXPECT_EQ(film(set("component_format", "uint32"))->pixel_type(), ExrPixel::float32);
  film("<boolean name='compensate' value='true'/>");
  EXPECT_EQ(notes.notes().size(), 4u) << ::testing::PrintToString(notes.notes());
}

TEST(FileFormat, TheProgramWritesThem) {
  const TemporaryFolder folder;
  const std::string text = small_scene_text(20, 12);
  const auto with = [&](const std::string& format) {
    std::string t = text;
    const std::string old = "<string name=\"pixel_format\" value=\"rgba\"/>";
    t.replace(t.find(old), old.size(), "<string name=\"file_format\" value=\"" + format + "\"/>");
    return folder.write(format + ".xml", t).string();
  };
  const auto run = [&](const std::string& arguments) {
    const int status = std::system(("cd " + folder.path.string() + " && " + aureole_binary().string() +
                                    " render --spp 16 --threads 1 -q " + arguments + " > " +
                                    (folder.path / "log").string() + " 2>&1")
                                       .c_str());
    return WEXITSTATUS(status);
  };
  ASSERT_EQ(run(with("openexr")), 0);
  ASSERT_EQ(run(with("pfm")), 0);
  ASSERT_EQ(run(with("rgbe")), 0);
  const Image exr = read_image(folder.path / "openexr.exr"), pfm = read_image(folder.path / "pfm.pfm"),
              hdr = read_image(folder.path / "rgbe.hdr");
  ASSERT_EQ(pfm.width, exr.width);
  ASSERT_EQ(hdr.height, exr.height);
  for (const char* name : {"R", "G", "B"})
    for (int y = 0; y < exr.height; ++y)
      for (int x = 0; x < exr.width; ++x) {
        const float v = exr.at(x, y, size_t(exr.channel(name)));
        float largest = 0;
        for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, exr.at(x, y, c));
        EXPECT_EQ(pfm.at(x, y, size_t(pfm.channel(name))), v);
        EXPECT_NEAR(hdr.at(x, y, size_t(hdr.channel(name))), std::max(v, 0.f), largest / 255);
      }
  EXPECT_TRUE(std::filesystem::exists(folder.path / "pfm.png"));
  // The name given by the user decides the format; formats that cannot hold the picture are refused before
  // rendering.
  const std::string out = (folder.path / "named.exr").string();
  EXPECT_EQ(run(with("pfm") + " -o " + out), 0);
  EXPECT_EQ(read_image(out).pixels, exr.pixels);
  EXPECT_EQ(run(with("pfm") + " --replicates 2"), 2);
  EXPECT_EQ(run(with("pfm") + " -o " + (folder.path / "a.tif").string()), 2);
}

}  // namespace
}  // namespace aureole::test
