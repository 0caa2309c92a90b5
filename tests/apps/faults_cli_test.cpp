// SPDX-License-Identifier: Apache-2.0
// The program under faults: inputs and outputs that are no files, folders that vanish, limits of the system.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "aureole/core/image.h"
#include "harness/paths.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Faults : public ::testing::Test {
protected:
  struct Outcome {
    int exit_code;
    std::string output;  ///< stdout and stderr
  };
  /// Starts the program in the test's folder; `prepare` runs in the new process.
  pid_t start(const std::vector<std::string>& arguments, const std::function<void()>& prepare = {}) const {
    const fs::path log = folder.path / "log.txt";
    const pid_t pid = fork();
    if (pid == 0) {
      if (chdir(folder.path.c_str()) != 0 || !freopen(log.c_str(), "w", stdout) || dup2(1, 2) < 0) _exit(99);
      if (prepare) prepare();
      std::vector<char*> argv{const_cast<char*>(aureole_binary().c_str())};
      for (const auto& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
      argv.push_back(nullptr);
      execv(aureole_binary().c_str(), argv.data());
      _exit(98);
    }
    return pid;
  }
  /// Waits for the program's end; kills it, with exit code -SIGKILL, after 60 s.
  Outcome end_of(pid_t pid) const {
    int status = 0;
    for (int i = 0; waitpid(pid, &status, WNOHANG) == 0; ++i) {
      if (i == 6000) kill(pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(folder.path / "log.txt")};
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

}  // namespace
}  // namespace aureole::test
