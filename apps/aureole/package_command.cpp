// SPDX-License-Identifier: Apache-2.0
#include "package_command.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

namespace {

/// The arguments are the module and the words of the command.
constexpr const char* kProgram = R"py(import importlib, sys
module = sys.argv.pop(1)
try:
    main = importlib.import_module("aureole." + module).main
except ImportError as e:
    print(f"error: this command needs aureole's Python package: {e}", file=sys.stderr)
    sys.exit(2)
sys.exit(main())
)py";

/// The words of a process, as execvp takes them.
class ProcessWords {
public:
  ProcessWords(const std::string& module, const std::vector<std::string>& words)
      : all_{"python3", "-c", kProgram, module} {
    all_.insert(all_.end(), words.begin(), words.end());
    for (std::string& word : all_) pointers_.push_back(word.data());
    pointers_.push_back(nullptr);
  }
  char* const* get() const { return pointers_.data(); }

private:
  std::vector<std::string> all_;
  std::vector<char*> pointers_;
};

int run_package(const std::string& module, const std::vector<std::string>& words) {
  const ProcessWords arguments(module, words);
  std::signal(SIGPIPE, SIG_DFL);
  execvp(arguments.get()[0], arguments.get());
  throw Error(std::string("this command needs Python: python3 cannot be started: ") + std::strerror(errno));
}

}  // namespace

int run_in_package(const std::string& module, const std::vector<std::string>& words) {
  const ProcessWords arguments(module, words);
  pid_t child = 0;
  if (const int problem =
          posix_spawnp(&child, arguments.get()[0], nullptr, nullptr, arguments.get(), environ);
      problem != 0)
    throw Error(std::string("this command needs Python: python3 cannot be started: ") +
                std::strerror(problem));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

std::function<int()> declare_package_command(CommandOptions& options, const std::string& module) {
  auto words = std::make_shared<std::vector<std::string>>();
  options.pass_on(*words);
  return [=] { return run_package(module, *words); };
}

}  // namespace aureole
