// SPDX-License-Identifier: Apache-2.0
// The subcommands of `aureole`. One is a file that declares its options and ends with AUREOLE_COMMAND(...);
// no other file changes. The library that reads the command line is slow to compile: only command_line.cpp
// includes it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace aureole {

/// An option or, where its name has no dash, a positional argument.
class CommandOption {
public:
  /// Where the value goes; it is left as it is where the option is not given. A bool is a flag without a
  /// value.
  using Target = std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::string*,
                              std::vector<double>*, std::vector<std::string>*>;

  CommandOption(std::string names, Target target, std::string help)
      : names_(std::move(names)), help_(std::move(help)), target_(target) {}

  CommandOption& required() { return required_ = true, *this; }
  /// The help shows the value that the target has now as the default.
  CommandOption& shows_default() { return shows_default_ = true, *this; }
  /// The total number of values.
  CommandOption& takes(int values) { return values_ = values, *this; }
  /// The number of values each time that the option is given.
  CommandOption& takes_each_time(int values) { return values_each_time_ = values, *this; }
  /// The values may stand in one word.
  CommandOption& separated_by(char separator) { return separator_ = separator, *this; }
  CommandOption& between(double min, double max) { return min_ = min, max_ = max, *this; }
  CommandOption& one_of(std::vector<std::string> values) { return choices_ = std::move(values), *this; }

private:
  friend class CommandLine;
  std::string names_, help_;
  Target target_;
  bool required_ = false, shows_default_ = false;
  int values_ = 0, values_each_time_ = 0;  ///< 0: as the target's type says
  char separator_ = 0;
  double min_ = 0, max_ = 0;  ///< equal: any number
  std::vector<std::string> choices_;
};

class CommandOptions {
public:
  /// `names` is "-o,--output", or "scene" for a positional argument.
  template <class T>
  CommandOption& add(std::string names, T& target, std::string help) {
    return *options_.emplace_back(
        std::make_unique<CommandOption>(std::move(names), &target, std::move(help)));
  }
  const std::vector<std::unique_ptr<CommandOption>>& all() const { return options_; }

private:
  std::vector<std::unique_ptr<CommandOption>> options_;
};

struct Command {
  /// "pigment fit" is the command "fit" of the group "pigment", which is a command without `declare`.
  std::string name, help;
  /// Declares the options; returns the function that runs once they are read, whose value is the program's
  /// exit code. It may throw Error: the program then prints it and returns 2.
  std::function<std::function<int()>(CommandOptions&)> declare;
};

/// The registered commands, sorted by name.
std::vector<Command> commands();

struct CommandRegistration {
  explicit CommandRegistration(Command command);
};

/// AUREOLE_COMMAND("info", "Say what a scene holds", declare_info);
#define AUREOLE_COMMAND(name, help, declare) \
  static const ::aureole::CommandRegistration aureole_command_registration({name, help, declare})

/// Splits -D name=value options; throws Error for anything else.
std::vector<std::pair<std::string, std::string>> split_defines(const std::vector<std::string>& list);

}  // namespace aureole
