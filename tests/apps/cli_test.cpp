// SPDX-License-Identifier: Apache-2.0
// The program as a user meets it: exit codes, messages, files; every kind of bad input is a located error
// with exit code 2 and nothing written.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "aureole/core/image.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

using Outcome = ProgramEnd;

/// `largest_file`: writing more than so many bytes to a file fails, as on a full disc; 0: no limit.
pid_t start(const std::vector<std::string>& arguments, const std::filesystem::path& log,
            rlim_t largest_file = 0) {
  return start_program({}, arguments, log, [&] {
    if (largest_file == 0) return;
    const rlimit limit{largest_file, largest_file};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0 || ::signal(SIGXFSZ, SIG_IGN) == SIG_ERR) _exit(97);
  });
}

class Cli : public ::testing::Test {
protected:
  Outcome run(const std::vector<std::string>& arguments, rlim_t largest_file = 0) {
    const auto log = folder.path / "log.txt";
    int status = 0;
    waitpid(start(arguments, log, largest_file), &status, 0);
    return program_end(status, log);
  }
  std::string out() const { return (folder.path / "out.exr").string(); }
  std::string scene(const std::string& text, const std::string& name = "scene.xml") {
    return folder.write(name, text).string();
  }

  /// A scene of one shape element after the usual rest.
  static std::string with(const std::string& element) {
    std::string text = small_scene_text();
    return text.insert(text.rfind("</scene>"), element + "\n");
  }
  /// Rendering must end with exit code 2, mention `message`, and write nothing.
  void refused(const std::string& text, const std::string& message,
               const std::vector<std::string>& extra = {}) {
    std::vector<std::string> arguments{"render", scene(text), "-o", out(), "--spp", "1"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    refused_arguments(arguments, message);
    const Outcome o = run(arguments);
    EXPECT_NE(o.output.find("scene.xml:"), std::string::npos) << "no location in: " << o.output;
  }
  void refused_arguments(const std::vector<std::string>& arguments, const std::string& message) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.exit_code, 2) << o.output;
    EXPECT_NE(o.output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << o.output;
    for (const char* file : {"out.exr", "out.png", "out.state"})
      EXPECT_FALSE(std::filesystem::exists(folder.path / file)) << file << " was written";
  }
  TemporaryFolder folder;
};

TEST_F(Cli, RendersAndSaysWhere) {
  const Outcome o = run({"render", scene(small_scene_text()), "-o", out(), "--spp", "4"});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(o.output.find("out.exr"), std::string::npos);
  EXPECT_EQ(o.output.find('\r'), std::string::npos) << "progress must be quiet when not a terminal";
  ExrAttributes a;
  const Image image = read_image(out(), &a);
  EXPECT_EQ(image.width, 40);
  EXPECT_EQ(image.channels.size(), 4u);
  EXPECT_EQ(a.integers["aureole:spp"], 4);
  for (const char* name : {"aureole:scene", "aureole:scene_hash", "aureole:version", "aureole:seed"})
    EXPECT_FALSE(a.strings[name].empty()) << name;
  EXPECT_GT(a.floats["aureole:seconds"], 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path / "out.png"));
}

TEST_F(Cli, APartWithoutItsStateIsAFailure) {
  // A black picture is small, its state is not.
  std::string text = small_scene_text();
  for (std::size_t i; (i = text.find("<emitter")) != std::string::npos;)
    text.erase(i, text.find("</emitter>", i) + 10 - i);
  const std::string s = scene(text);
  const std::vector<std::string> part{"render", s, "-o", out(), "--samples", "0:16"};
  const Outcome kept = run(part);
  EXPECT_EQ(kept.exit_code, 0) << kept.output;
  const auto state = folder.path / "out.state";
  const auto size = std::filesystem::file_size(state);
  ASSERT_LT(std::filesystem::file_size(out()), size / 2);
  std::filesystem::remove(state);

  const Outcome lost = run(part, size / 2);
  EXPECT_EQ(lost.exit_code, 1) << lost.output;
  EXPECT_NE(lost.output.find("no state file"), std::string::npos) << lost.output;
  EXPECT_FALSE(std::filesystem::exists(state));
  EXPECT_TRUE(std::filesystem::exists(out())) << "the picture is not lost";
  // A whole picture needs no state.
  const Outcome whole = run({"render", s, "-o", out(), "--spp", "16"}, size / 2);
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}

TEST_F(Cli, OtherCommands) {
  const std::string s = scene(small_scene_text());
  const Outcome info = run({"info", s});
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_EQ(info.output.find("tables"), std::string::npos) << info.output;
  EXPECT_NE(run({"list", "bsdf"}).output.find("dielectric"), std::string::npos);
  EXPECT_EQ(run({"list", "bsfd"}).exit_code, 2);
  EXPECT_EQ(run({"--version"}).exit_code, 0);
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"rendr", s}).exit_code, 2);
  const Outcome pixel = run({"render", s, "--pixel", "20,14", "--samples", "0:2"});
  EXPECT_EQ(pixel.exit_code, 0);
  EXPECT_NE(pixel.output.find("depth 0"), std::string::npos) << pixel.output;
  EXPECT_EQ(run({"render", s, "--pixel", "200,14"}).exit_code, 2);
  const Outcome path = run({"render", s, "--integrator", "ptracer", "--pixel", "20,14", "--samples", "0:2"});
  EXPECT_EQ(path.exit_code, 0);
  EXPECT_NE(path.output.find("belong to no pixel"), std::string::npos) << path.output;
  EXPECT_NE(path.output.find("splats"), std::string::npos) << path.output;
}

TEST_F(Cli, MediumTellsItsFigures) {
  // 1 cm of it absorbs a decadic absorbance of 1: T = 0.1. The unit of the scene is the centimetre.
  const std::string s = scene(with(
      "<string name=\"length_unit\" value=\"cm\"/><shape type=\"cube\"><bsdf type=\"null\"/><medium "
      "name=\"interior\" type=\"solution\" id=\"ink\"><string name=\"solvent\" value=\"vacuum\"/><ingredient "
      "type=\"dye\"><float name=\"absorbance_1cm\" value=\"1\"/></ingredient></medium></shape><shape "
      "type=\"sphere\"><bsdf type=\"null\"/><medium name=\"interior\" type=\"homogeneous\" id=\"fog\"><float "
      "name=\"sigma_t\" value=\"0.02\"/><float name=\"albedo\" value=\"0.5\"/><phase type=\"hg\"><float "
      "name=\"g\" value=\"0.7\"/></phase></medium></shape>"));
  const auto figures = [&](const std::string& id) {
    const auto file = folder.path / (id + ".json");
    const Outcome o =
        run({"medium", s + "#" + id, "--json", file.string(), "--plot", file.string() + ".svg"});
    EXPECT_EQ(o.exit_code, 0) << o.output;
    return nlohmann::json::parse(file_content(file));
  };
  const auto ink = figures("ink"), fog = figures("fog");
  for (const auto& row : ink["wavelengths"]) {
    EXPECT_NEAR(double(row["transmittance"]), 0.1, 1e-5);
    EXPECT_NEAR(double(row["sigma_a"]), 230.2585, 1e-2);
    EXPECT_NEAR(double(row["absorbance"]), 1, 1e-5);
    EXPECT_NEAR(double(row["optical_density"]), 1, 1e-5);
    EXPECT_EQ(double(row["sigma_s"]), 0);
  }
  EXPECT_NEAR(double(ink["xyz_unscattered"][1]), 0.1, 1e-5);
  for (const auto& row : fog["wavelengths"]) {
    EXPECT_NEAR(double(row["sigma_s"]), 1, 1e-5);
    EXPECT_NEAR(double(row["mean_free_path"]), 0.5, 1e-6);
    EXPECT_NEAR(double(row["g"]), 0.7, 1e-4);
    // sigma_a = sigma_s = 1/m over 1 cm.
    EXPECT_NEAR(double(row["absorbance"]), 0.01 / std::log(10), 1e-7);
    EXPECT_NEAR(double(row["optical_density"]), 0.02 / std::log(10), 2e-7);
  }
  EXPECT_NE(file_content(folder.path / "fog.json.svg").find("</svg>"), std::string::npos);
  // A cell of 50 cm passes 1e-50 of the light, which single precision rounds to 0.
  const Outcome thick = run({"medium", s + "#ink", "--length", "50cm"});
  EXPECT_NE(thick.output.find("        50        50\n"), std::string::npos) << thick.output;
  EXPECT_NE(thick.output.find("A: absorbance lg(1/T) of 50cm"), std::string::npos) << thick.output;
  refused_arguments({"medium", s + "#fogg"}, "did you mean \"fog\"");
  refused_arguments({"medium", s}, "name one of the 2 media");
  refused_arguments({"medium", s + "#fog", "--length", "3"}, "unit");
  refused(
      with("<shape type=\"cube\"><bsdf type=\"null\"/><medium name=\"interior\" "
           "type=\"suspension\"><ingredient type=\"spheres\"><string name=\"radius\" value=\"1um\"/><float "
           "name=\"int_ior\" value=\"1.5\"/><float name=\"volume_fraction\" "
           "value=\"0.9\"/></ingredient></medium></shape>"),
      "more particles than fit");
}

TEST_F(Cli, CompareTellsSameFromDifferent) {
  const std::string s = scene(small_scene_text());
  const auto file = [&](const char* name) { return (folder.path / name).string(); };
  ASSERT_EQ(run({"render", s, "-o", file("a.exr"), "--replicates", "16", "--spp", "16"}).exit_code, 0);
  ASSERT_EQ(run({"render", s, "-o", file("b.exr"), "--replicates", "16", "--spp", "16", "--seed", "5",
                 "--sampler", "independent"})
                .exit_code,
            0);
  std::string brighter = small_scene_text();
  brighter.replace(brighter.find("8, 7, 5"), 7, "9, 7, 5");
  ASSERT_EQ(run({"render", scene(brighter, "brighter.xml"), "-o", file("c.exr"), "--replicates", "16",
                 "--spp", "16"})
                .exit_code,
            0);
  const Outcome same = run({"compare", file("a.exr"), file("b.exr")});
  EXPECT_EQ(same.exit_code, 0) << same.output;
  const Outcome different = run({"compare", file("a.exr"), file("c.exr"), "--z-map", file("z.png")});
  EXPECT_EQ(different.exit_code, 1) << different.output;
  EXPECT_TRUE(std::filesystem::exists(file("z.png")));
  EXPECT_EQ(run({"compare", file("a.exr"), file("none.exr")}).exit_code, 2);
}

TEST_F(Cli, CompareJudgesFewReplicatesByStudentsT) {
  const std::string s = scene(small_scene_text());
  const auto file = [&](const std::string& name) { return (folder.path / name).string(); };
  const auto render = [&](const std::string& name, const std::string& replicates, const std::string& seed) {
    ASSERT_EQ(run({"render", s, "-o", file(name), "--replicates", replicates, "--spp", "16", "--seed", seed,
                   "--sampler", "independent"})
                  .exit_code,
              0);
  };
  for (const char* n : {"2", "3", "4"}) {
    render("a.exr", n, "1");
    render("b.exr", n, "2");
    const Outcome same = run({"compare", file("a.exr"), file("b.exr")});
    EXPECT_EQ(same.exit_code, 0) << n << ": " << same.output;
    EXPECT_NE(same.output.find("the same within noise"), std::string::npos) << same.output;
  }
  // Variances of two replicates against a picture without variances, one degree of freedom, judge nothing.
  render("a.exr", "2", "1");
  render("one.exr", "1", "2");
  const Outcome few = run({"compare", file("a.exr"), file("one.exr")});
  EXPECT_NE(few.output.find("UNDECIDED: the variances are those of too few"), std::string::npos)
      << few.output;
  EXPECT_EQ(few.exit_code, 1);
}

TEST_F(Cli, CompareTakesLayersOneByOne) {
  Image a{2,
          1,
          {"R", "G", "B", "depth.T", "albedo.R", "albedo.A", "variance.R"},
          std::vector<float>(14, 0.5f),
          false};
  Image b = a;
  b.at(1, 0, 3) = 100;
  write_exr(folder.path / "a.exr", a, ExrPixel::float32, {});
  write_exr(folder.path / "b.exr", b, ExrPixel::float32, {});
  const Outcome r = run({"compare", (folder.path / "a.exr").string(), (folder.path / "b.exr").string()});
  const auto section = [&](const std::string& layer) {
    const std::size_t from = r.output.find("layer      " + layer + "\n");
    if (from == std::string::npos) return std::string();
    return r.output.substr(from, r.output.find("\nlayer", from) - from);
  };
  EXPECT_NE(section("colour").find("verdict    identical"), std::string::npos) << r.output;
  EXPECT_NE(section("albedo").find("channels   albedo.R\n"), std::string::npos) << r.output;
  EXPECT_NE(section("albedo").find("verdict    identical"), std::string::npos) << r.output;
  EXPECT_NE(section("depth").find("max        99.5 at (1, 0)"), std::string::npos) << r.output;
}

TEST_F(Cli, ResumesToTheSameBitsAfterKill) {
  const std::string s = scene(small_scene_text(160, 120));
  const std::string whole = (folder.path / "whole.exr").string();
  ASSERT_EQ(run({"render", s, "-o", whole, "--samples", "0:80"}).exit_code, 0);
  const auto state = folder.path / "out.state";
  // SIGKILL shortly after the first checkpoint appears.
  const pid_t pid = start({"render", s, "-o", out(), "--spp", "80", "--checkpoint", "0.05", "--threads", "1"},
                          folder.path / "killed.txt");
  for (int i = 0; i < 2000 && !std::filesystem::exists(state); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(pid, SIGKILL);
  int status = 0;
  waitpid(pid, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it finished before it could be killed: make it longer";
  ASSERT_TRUE(std::filesystem::exists(state));
  EXPECT_FALSE(std::filesystem::exists(out()));
  const Outcome resumed = run({"render", s, "-o", out(), "--spp", "80", "--resume", "--threads", "2"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_NE(resumed.output.find("resuming"), std::string::npos);
  EXPECT_EQ(read_image(out()).pixels, read_image(whole).pixels);
}

TEST_F(Cli, AnEarlierJobsSamplesAreNotLost) {
  const std::string s = scene(small_scene_text());
  folder.write("out.state", "precious");
  const Outcome refused = run({"render", s, "-o", out(), "--spp", "4"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.output.find("--resume"), std::string::npos) << refused.output;
  EXPECT_EQ(file_content(folder.path / "out.state"), "precious");
  EXPECT_FALSE(std::filesystem::exists(out()));
  EXPECT_EQ(run({"render", s, "-o", out(), "--spp", "4", "--restart"}).exit_code, 0);
}

TEST_F(Cli, NanIsNeverIdentical) {
  Image image{2, 2, {"R", "G", "B"}, std::vector<float>(12, 0.5f), false};
  write_exr(folder.path / "a.exr", image, ExrPixel::float32, {});
  image.pixels[4] = std::numeric_limits<float>::quiet_NaN();
  write_exr(folder.path / "b.exr", image, ExrPixel::float32, {});
  EXPECT_EQ(run({"compare", (folder.path / "a.exr").string(), (folder.path / "b.exr").string()}).exit_code,
            1);
  EXPECT_EQ(run({"compare", (folder.path / "b.exr").string(), (folder.path / "b.exr").string()}).exit_code,
            1);
  EXPECT_EQ(run({"compare", (folder.path / "a.exr").string(), (folder.path / "a.exr").string()}).exit_code,
            0);
}

TEST_F(Cli, CtrlCWritesWhatIsDoneAndSaysHowToResume) {
  const std::string s = scene(small_scene_text(160, 120));
  const pid_t pid = start({"render", s, "-o", out(), "--spp", "4000"}, folder.path / "log.txt");
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  kill(pid, SIGINT);
  int status = 0;
  waitpid(pid, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(file_content(folder.path / "log.txt").find("--resume"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(out()));
  EXPECT_TRUE(std::filesystem::exists(folder.path / "out.state"));
}

TEST_F(Cli, UnknownCommandsNameTheNearestOne) {
  refused_arguments({"rendr", "scene.xml"}, "unknown command \"rendr\"; did you mean \"render\"?");
  refused_arguments(
      {"xyzzyxyzzy"},
      "there are: bake, cache, cache clear, cache limit, cache list, cache size, cluster, color, compare, convert, convert-bsdf, denoise,");
}

TEST_F(Cli, OptionsOfSeveralValuesLeaveArgumentsAlone) {
  const Outcome r = run({"droplet-size", "--fov", "20", "--mask", "10", "10", "5", "no-such-photo.jpg"});
  EXPECT_NE(r.output.find("no-such-photo.jpg: no such file"), std::string::npos) << r.output;
}

TEST_F(Cli, DocsOfOnePluginAndWholeSummaries) {
  const Outcome one = run({"docs", "diffuse"});
  EXPECT_NE(one.output.find("### bsdf `diffuse`"), std::string::npos) << one.output;
  EXPECT_EQ(one.output.find("### bsdf `plastic`"), std::string::npos);
  EXPECT_NE(run({"docs", "difuse"}).output.find("did you mean \"diffuse\"?"), std::string::npos);
  // The point of a number ends no summary.
  const std::string list = run({"list"}).output;
  EXPECT_EQ(list.find(" 0\n"), std::string::npos) << list;
}

TEST_F(Cli, UnknownIntegratorsListTheOthers) {
  const Outcome r = run({"render", scene(small_scene_text()), "-o", out(), "--integrator", "xyzzyxyzzy"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find("there are: aov, bdpt"), std::string::npos) << r.output;
}

TEST_F(Cli, TheFirstCheckpointComesEarly) {
  const std::string s = scene(small_scene_text(160, 120));
  const pid_t pid =
      start({"render", s, "-o", out(), "--spp", "1000000", "--threads", "1"}, folder.path / "log.txt");
  for (int i = 0; i < 100 && !std::filesystem::exists(folder.path / "out.state"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path / "out.state"));
}

TEST_F(Cli, ThePngCompressesBrightnessAsAsked) {
  const std::string s = scene(small_scene_text());
  ASSERT_EQ(run({"render", s, "-o", out(), "--spp", "16", "--tonemap", "asinh:20:-1"}).exit_code, 0);
  const Image linear = read_image(out()), png = read_image(folder.path / "out.png");
  for (int x = 0; x < linear.width; ++x) {
    double y[2], rgb[2][3];
    for (std::size_t c = 0; c < 3; ++c) {
      const char* const name = std::array{"R", "G", "B"}[c];
      rgb[0][c] = 0.5 * double(linear.at(x, linear.height / 2, std::size_t(linear.channel(name))));
      rgb[1][c] = srgb_decode(png.at(x, linear.height / 2, std::size_t(png.channel(name))));
    }
    for (int k = 0; k < 2; ++k) y[k] = 0.2126 * rgb[k][0] + 0.7152 * rgb[k][1] + 0.0722 * rgb[k][2];
    EXPECT_NEAR(y[1], std::min(1.0, std::asinh(20 * y[0]) / std::asinh(20.0)), 0.01);
  }
  std::filesystem::remove(out());
  std::filesystem::remove(folder.path / "out.png");
  for (const char* bad : {"filmic", "asinh:", "asinh:-1", "asinh:1:2:3", "asinh:nan"})
    refused_arguments({"render", s, "-o", out(), "--tonemap", bad}, "expected asinh");
}

TEST_F(Cli, PartsMergeAndStrangersAreRefused) {
  const std::string s = scene(small_scene_text());
  const auto file = [&](const char* name) { return (folder.path / name).string(); };
  ASSERT_EQ(run({"render", s, "-o", file("whole.exr"), "--spp", "48"}).exit_code, 0);
  ASSERT_EQ(run({"render", s, "-o", file("a.exr"), "--samples", "0:32"}).exit_code, 0);
  ASSERT_EQ(run({"render", s, "-o", file("b.exr"), "--samples", "32:48"}).exit_code, 0);
  ASSERT_EQ(run({"render", s, "-o", file("c.exr"), "--samples", "16:48"}).exit_code, 0);
  ASSERT_EQ(run({"render", s, "-o", file("d.exr"), "--samples", "32:48", "--seed", "9"}).exit_code, 0);
  const Outcome merged = run({"merge", file("a.state"), file("b.state"), "-o", out()});
  EXPECT_EQ(merged.exit_code, 0) << merged.output;
  EXPECT_EQ(read_image(out()).pixels, read_image(file("whole.exr")).pixels);
  std::filesystem::remove(out());
  std::filesystem::remove(folder.path / "out.png");
  std::filesystem::remove(folder.path / "out.state");
  refused_arguments({"merge", file("a.state"), file("c.state"), "-o", out()}, "overlap");
  refused_arguments({"merge", file("a.state"), file("d.state"), "-o", out()}, "seed");
  refused_arguments({"merge", file("a.state"), s, "-o", out()}, "not a complete state file");
  refused_arguments({"merge", file("a.exr.state"), file("b.state"), "-o", out()},
                    "the state of " + file("a.exr") + " is " + file("a.state"));
  refused_arguments({"merge", file("e.exr"), "-o", out()},
                    "is " + file("e.state") + ", which is not there either");
  refused_arguments({"render", s, "-o", out(), "--samples", "8:48"}, "multiple of 16");
}

TEST_F(Cli, BadScenes) {
  refused(with(R"(<bsdf type="difuse" id="b"/>)"), "did you mean \"diffuse\"");
  refused(with(R"(<bsdf type="diffuse" id="b"><rgb name="reflectence" value="0.5"/></bsdf>)"),
          "did you mean \"reflectance\"");
  refused(with(R"(<bsdf type="diffuse" id="glass"/><shape type="cube"><ref id="glas"/></shape>)"),
          "did you mean \"glass\"");
  refused(with(R"(<shape type="sphere"><string name="radius" value="big"/></shape>)"), "radius");
  refused(with(R"(<shape type="sphere"><float name="radius" value="big"/></shape>)"), "\"big\"");
  refused(with(R"(<shape type="obj"><string name="filename" value="none.obj"/></shape>)"), "none.obj");
  refused(with(R"(<shape type="sphere"><float name="radius" value="nan"/></shape>)"), "nan");
  refused(with(R"(<shape type="sphere"><float name="radius" value="-1"/></shape>)"), "radius");
  refused(with(R"(<shape type="cube"><transform name="to_world"><scale value="0"/></transform></shape>)"),
          "singular");
  refused(with(R"(<include filename="scene.xml"/>)"), "include");
  refused(
      with(
          R"(<bsdf type="twosided" id="a"><ref id="b"/></bsdf><bsdf type="twosided" id="b"><ref id="a"/></bsdf>)"),
      "circular");
  refused(with(R"(<shape type="sphere"><float name="radius" value="$size"/></shape>)"), "$size");
  refused(with(""), "-D", {"-D", "unused=1"});
  refused(with(R"(<emitter type="point"><rgb name="intensity" value="-1"/></emitter>)"), "intensity");
  refused(with(R"(<bsdf type="diffuse"><rgb name="reflectance" value="1.5"/></bsdf>)"), "reflectance");
  refused(
      with(
          R"(<shape type="rectangle"><bsdf type="correlated_scatterers"><float name="radius" value="5"/><float name="area_fraction" value="0.5"/></bsdf></shape>)"),
      "unit");
  refused(
      with(
          R"(<shape type="rectangle"><bsdf type="correlated_scatterers"><string name="radius" value="5 furlongs"/><float name="area_fraction" value="0.5"/></bsdf></shape>)"),
      "furlongs");
  refused(
      with(
          R"(<shape type="rectangle"><bsdf type="correlated_scatterers"><string name="radius" value="5um"/><float name="area_fraction" value="0.8"/></bsdf></shape>)"),
      "area_fraction");
  refused("<scene version=\"3.0.0\"><shape></scene>", "scene.xml");
}

TEST_F(Cli, TruncatedFilesAreLocatedErrors) {
  const std::filesystem::path assets = source_dir() / "tests/references/scenes";
  for (const auto& [type, file] :
       {std::pair{"ply", "meshes/hill_little.ply"}, {"serialized", "meshes/pair.serialized"}}) {
    const std::string bytes = file_content(assets / file);
    ASSERT_FALSE(bytes.empty());
    folder.write("cut.bin", bytes.substr(0, bytes.size() / 2));
    refused(with("<shape type=\"" + std::string(type) +
                 "\"><string name=\"filename\" value=\"cut.bin\"/></shape>"),
            "cut.bin");
  }
  folder.write("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  refused(with(R"(<shape type="obj"><string name="filename" value="cut.obj"/></shape>)"), "cut.obj");
  const std::string exr = file_content(assets / "textures/sky_colour.exr");
  ASSERT_FALSE(exr.empty());
  folder.write("cut.exr", exr.substr(0, exr.size() / 2));
  refused(with(R"(<emitter type="envmap"><string name="filename" value="cut.exr"/></emitter>)"), "cut.exr");
}

TEST_F(Cli, EveryProblemAtOnce) {
  const Outcome o = run({"render",
                         scene(with("<bsdf type=\"difuse\" id=\"b\"/>\n<shape type=\"sphere\"><float "
                                    "name=\"radius\" value=\"-1\"/></shape>\n"
                                    "<shape type=\"cube\"><ref id=\"nothing\"/></shape>")),
                         "-o", out()});
  EXPECT_EQ(o.exit_code, 2);
  EXPECT_NE(o.output.find("difuse"), std::string::npos) << o.output;
  EXPECT_NE(o.output.find("radius"), std::string::npos) << o.output;
  EXPECT_NE(o.output.find("nothing"), std::string::npos) << o.output;
}

TEST_F(Cli, BadArguments) {
  const std::string s = scene(small_scene_text());
  refused_arguments({"render", s, "-o", out(), "--spp", "0"}, "--spp 0");
  refused_arguments({"render", s, "-o", out(), "--spp", "many"}, "spp");
  refused_arguments({"render", s, "-o", (folder.path / "no/such/out.exr").string()}, "no folder");
  refused_arguments({"render", s, "-o", folder.path.string()}, ".exr");
  refused_arguments({"render", s, "-o", "/proc/out.exr"}, "not writable");
  refused_arguments({"render", s, "-o", out(), "--samples", "10"}, "--samples");
  refused_arguments({"render", s, "-o", out(), "--samples", "32:16"}, "nothing to render");
  refused_arguments({"render", s, "-o", out(), "--replicates", "0"}, "--replicates");
  refused_arguments({"render", s, "-o", out(), "--sampler", "sobl"}, "sobol");
  refused_arguments({"render", s, "-o", out(), "--adaptive", "some"}, "display");
  refused_arguments({"render", s, "-o", out(), "--adaptive", "display", "--integrator", "ptracer"},
                    "leave light on any pixel");
  refused_arguments({"render", s, "-o", out(), "--integrator", "pth"}, "path");
  refused_arguments({"render", (folder.path / "none.xml").string(), "-o", out()}, "none.xml");
  refused_arguments({"render", scene(small_scene_text(1000000, 1000000), "huge.xml"), "-o", out()}, "GiB");
  refused_arguments({"render", s, "-o", out(), "-D", "nothing"}, "-D name=value");
}

TEST_F(Cli, TheSizeOfTablesIsPrinted) {
  const Outcome o = run({"info", scene(with(R"(<shape type="rectangle"><bsdf type="layered" id="coat">
      <medium type="homogeneous"><float name="sigma_t" value="1e5"/></medium>
      <string name="thickness" value="20um"/><integer name="directions" value="24"/>
      <integer name="azimuths" value="4"/><bsdf type="diffuse"/></bsdf></shape>)"))});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  const std::size_t at = o.output.find("tables ");
  ASSERT_NE(at, std::string::npos) << o.output;
  EXPECT_NE(o.output.find("layered              coat ", at), std::string::npos) << o.output;
  EXPECT_EQ(o.output.find(" 0.00 MB", at), std::string::npos) << o.output;
}

TEST_F(Cli, DegenerateTrianglesAreDroppedWithACount) {
  folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
  const Outcome o =
      run({"info", scene(with(R"(<shape type="obj"><string name="filename" value="flat.obj"/></shape>)"))});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(o.output.find("2 degenerate"), std::string::npos) << o.output;
}

}  // namespace
}  // namespace aureole::test
