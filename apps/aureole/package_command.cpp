// SPDX-License-Identifier: Apache-2.0
#include "package_command.h"

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

int run_package(const std::string& module, const std::vector<std::string>& words) {
  std::vector<std::string> all{"python3", "-c", kProgram, module};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  execvp(arguments[0], arguments.data());
  throw Error(std::string("this command needs Python: python3 cannot be started: ") + std::strerror(errno));
}

}  // namespace

std::function<int()> declare_package_command(CommandOptions& options, const std::string& module) {
  auto words = std::make_shared<std::vector<std::string>>();
  options.pass_on(*words);
  return [=] { return run_package(module, *words); };
}

}  // namespace aureole
