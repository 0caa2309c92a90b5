// SPDX-License-Identifier: Apache-2.0
// The program under faults: inputs and outputs that are no files, folders that vanish, limits of the system.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "aureole/core/image.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class Faults : public ::testing::Test {
protected:
  using Outcome = ProgramEnd;
  /// Starts the program in the test's folder; `prepare` runs in the new process.
  pid_t start(const std::vector<std::string>& arguments, const std::function<void()>& prepare = {}) const {
    return start_program(folder.path, arguments, folder.path / "log.txt", prepare);
  }
  /// Waits for the program's end; kills it, with exit code -SIGKILL, after 60 s.
  Outcome end_of(pid_t pid) const {
    int status = 0;
    for (int i = 0; waitpid(pid, &status, WNOHANG) == 0; ++i) {
      if (i == 6000) kill(pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return program_end(status, folder.path / "log.txt");
  }
  Outcome run(const std::vector<std::string>& arguments, const std::function<void()>& prepare = {}) const {
    return end_of(start(arguments, prepare));
  }
  void make_pipe(const std::string& name) const {
    ASSERT_EQ(::mkfifo((folder.path / name).c_str(), 0600), 0);
  }
  std::string scene() const { return folder.write("scene.xml", small_scene_text()).string(); }

  TemporaryFolder folder;
};

TEST_F(Faults, PipesAsInputsAreErrors) {
  make_pipe("pipe");
  folder.write("palette.csv", "");
  using Arguments = std::vector<std::string>;
  for (const Arguments& arguments :
       {Arguments{"render", "pipe"}, Arguments{"info", "pipe"}, Arguments{"merge", "pipe", "-o", "out.exr"},
        Arguments{"pigment", "fit", "pipe"}, Arguments{"pigment", "mix", "pipe", "a"},
        Arguments{"droplet-size", "pipe", "--pixel-angle", "0.05deg"},
        Arguments{"microstructure", "pipe", "--pixel-size", "1um", "-o", "out"},
        Arguments{"compare", "pipe", "pipe"}, Arguments{"layer", "pipe"}, Arguments{"medium", "pipe"}}) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.exit_code, 2) << arguments[0] << ": " << o.output;
    EXPECT_NE(o.output.find("not a regular file but a pipe"), std::string::npos)
        << arguments[0] << ": " << o.output;
  }
}

TEST_F(Faults, PipesAsOutputsAreErrorsBeforeTheWork) {
  make_pipe("out.exr");
  make_pipe("b.png");
  make_pipe("c.state");
  make_pipe("d.json");
  const std::string s = scene();
  for (const char* out : {"out.exr", "b.exr", "c.exr"}) {
    const Outcome o = run({"render", s, "-o", out, "--spp", "100000000"});
    EXPECT_EQ(o.exit_code, 2) << o.output;
    EXPECT_NE(o.output.find("cannot be written: it is a pipe"), std::string::npos) << o.output;
  }
  // The error of the output comes before that of the input, which is read first.
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"pigment", "fit", "none.csv", "--json", "d.json"},
        {"layer", "none.xml", "--json", "d.json"},
        {"droplet-size", "none.png", "-o", "d.json"}}) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.exit_code, 2) << o.output;
    EXPECT_NE(o.output.find("d.json: cannot be written: it is a pipe"), std::string::npos) << o.output;
  }
}

TEST_F(Faults, AFolderThatVanishesDoesNotCostThePicture) {
  const std::string s = scene();
  fs::create_directory(folder.path / "gone");
  const pid_t pid = start({"render", s, "-o", "gone/a.exr", "--spp", "1000000", "--time", "2", "-q"});
  for (int i = 0; i < 500 && fs::is_empty(folder.path / "gone"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(
      std::chrono::milliseconds(700));  // until the outputs are checked and the work begins
  fs::remove_all(folder.path / "gone");
  const Outcome o = end_of(pid);
  EXPECT_EQ(o.exit_code, 1) << o.output;
  EXPECT_NE(o.output.find("there is no folder gone"), std::string::npos) << o.output;
  EXPECT_NE(o.output.find("the picture is in"), std::string::npos) << o.output;
  std::vector<std::string> rescued;
  for (const auto& entry : fs::directory_iterator(folder.path))
    if (entry.path().filename().string().starts_with("rescued-"))
      rescued.push_back(entry.path().extension().string());
  std::sort(rescued.begin(), rescued.end());
  EXPECT_EQ(rescued, (std::vector<std::string>{".exr", ".png", ".state"})) << o.output;
}

TEST_F(Faults, LongNamesAreCheckedBeforeTheWork) {
  const std::string s = scene();
  const Outcome good = run({"render", s, "-o", std::string(245, 'a') + ".exr", "--spp", "1", "-q"});
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_TRUE(fs::exists(folder.path / (std::string(245, 'a') + ".exr")));
  const Outcome part = run({"render", s, "-o", std::string(249, 'b') + ".exr", "--samples", "0:16", "-q"});
  EXPECT_EQ(part.exit_code, 0) << part.output;
  const Outcome bad = run({"render", s, "-o", std::string(251, 'a') + ".exr", "--spp", "100000000"});
  EXPECT_EQ(bad.exit_code, 2) << bad.output;
  EXPECT_NE(bad.output.find("257 bytes"), std::string::npos) << bad.output;
}

TEST_F(Faults, OneProgramWritesAPicture) {
  const std::string s = scene();
  const fs::path lock = folder.path / ".a.aureole-lock";
  const std::vector<std::string> endless{"render", s, "-o", "a.exr", "--spp", "100000000", "-q"},
      // The pictures of both have one PNG and one state.
      short_one{"render", s, "-o", "a.pfm", "--spp", "1", "-q", "--restart"};
  const pid_t first = start(endless);
  for (int i = 0; i < 1000 && !fs::exists(lock); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const Outcome second = run(short_one);
  EXPECT_EQ(second.exit_code, 2) << second.output;
  EXPECT_NE(second.output.find("is being written by another program"), std::string::npos) << second.output;
  kill(first, SIGKILL);
  EXPECT_EQ(end_of(first).exit_code, -SIGKILL);
  EXPECT_TRUE(fs::exists(lock));
  const Outcome third = run(short_one);
  EXPECT_EQ(third.exit_code, 0) << third.output;
  EXPECT_FALSE(fs::exists(lock));
}

void redirect(int descriptor, const char* file) {
  const int d = open(file, O_WRONLY | O_CLOEXEC);
  if (d < 0 || dup2(d, descriptor) < 0) _exit(96);
}
void redirect_to_closed_pipe(int descriptor) {
  int ends[2];
  if (pipe(ends) != 0 || dup2(ends[1], descriptor) < 0 || close(ends[0]) != 0 || close(ends[1]) != 0)
    _exit(96);
  signal(SIGPIPE, SIG_DFL);
}

TEST_F(Faults, MessagesMayBeLostAndResultsNot) {
  const std::vector<std::string> arguments{"render", scene(), "-o", "a.exr", "--spp", "4"};
  const std::vector<std::function<void()>> lost{[] { redirect(2, "/dev/full"); }, [] { close(2); },
                                                [] { redirect_to_closed_pipe(2); }};
  for (std::size_t i = 0; i < lost.size(); ++i) {
    fs::remove(folder.path / "a.exr");
    EXPECT_EQ(run(arguments, lost[i]).exit_code, 0) << i;
    EXPECT_EQ(read_image(folder.path / "a.exr").width, 40) << i;
  }
  const std::vector<std::function<void()>> unwritten{[] { redirect(1, "/dev/full"); }, [] { close(1); },
                                                     [] { redirect_to_closed_pipe(1); }};
  for (std::size_t i = 0; i < unwritten.size(); ++i) {
    fs::remove(folder.path / "a.exr");
    EXPECT_EQ(run(arguments, unwritten[i]).exit_code, 1) << i;
    EXPECT_TRUE(fs::exists(folder.path / "a.exr")) << i;
    const int code = run({"docs"}, unwritten[i]).exit_code;
    EXPECT_TRUE(code == 1 || code == 2) << i << ": " << code;
  }
}

TEST_F(Faults, ThreadsThatCannotBeMade) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers map more memory than the limits of this test";
  const std::string s = scene();
  const Outcome one = run({"render", s, "-o", "one.exr", "--spp", "16", "--threads", "1", "-q"});
  ASSERT_EQ(one.exit_code, 0) << one.output;
  const Image expected = read_image(folder.path / "one.exr");
  for (const rlim_t kib : {200000, 300000, 500000})
    for (const char* threads : {"40", "400"}) {
      const Outcome o = run({"render", s, "-o", "many.exr", "--spp", "16", "--threads", threads}, [kib] {
        const rlimit limit{kib * 1024, kib * 1024};
        if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(97);
      });
      EXPECT_EQ(o.exit_code, 0) << kib << ", " << threads << ": " << o.output;
      if (o.exit_code != 0) continue;
      EXPECT_NE(o.output.find("threads are used: the system refuses more"), std::string::npos) << o.output;
      EXPECT_EQ(read_image(folder.path / "many.exr").pixels, expected.pixels);
    }
}

}  // namespace
}  // namespace aureole::test
