// SPDX-License-Identifier: Apache-2.0
// The subcommands of `aureole`. A subcommand is a file that declares its options and ends with
// AUREOLE_COMMAND(...); no other file changes. The command line library is slow to compile, so only
// command_line.cpp includes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace aureole {

/// An option or, if its name has no dash, a positional argument.
class CommandOption {
public:
  /// The variable that receives the value; it is unchanged if the option is not given. A bool is a flag
  /// without a value. An optional tells a value that equals the default from an option that is not given.
  using Target = std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::optional<int>*,
                              std::optional<std::int64_t>*, std::optional<double>*, std::string*,
                              std::vector<double>*, std::vector<std::string>*>;

  CommandOption(std::string names, Target target, std::string help)
      : names_(std::move(names)), help_(std::move(help)), target_(target) {}

  CommandOption& required() { return required_ = true, *this; }
  /// Makes the help show the target's current value as the default.
  CommandOption& shows_default() { return shows_default_ = true, *this; }
  /// Sets the total number of values. Without it, and without `takes_each_time`, each use of an option takes one word.
  CommandOption& takes(int values) { return values_ = values, *this; }
  /// Sets the number of values per use of the option.
  CommandOption& takes_each_time(int values) { return values_each_time_ = values, *this; }
  /// Allows several values in one word, separated by `separator`.
  CommandOption& separated_by(char separator) { return separator_ = separator, *this; }
  CommandOption& between(double min, double max) { return min_ = min, max_ = max, *this; }
  CommandOption& one_of(std::vector<std::string> values) { return choices_ = std::move(values), *this; }
  /// Marks the value, or each of several, as the name of a file that the command writes: the program ends with an error
  /// before the command runs if it cannot be written, if another output has the name, or if it is a file that the command reads.
  CommandOption& names_output() { return kind_ = FileKind::output, *this; }
  /// Marks the value, or each of several, as the name of a file that the command reads, or of a part of one ("file#part"). Words
  /// that are names of no file do not matter. Positional arguments that are not outputs are inputs without this mark.
  CommandOption& names_input() { return kind_ = FileKind::input, *this; }
  /// Marks an input that an output may replace, since the command has read all of it before it writes.
  CommandOption& names_replaceable_input() { return kind_ = FileKind::replaceable_input, *this; }

private:
  friend class CommandLine;
  enum class FileKind { none, input, replaceable_input, output };
  std::string names_, help_;
  Target target_;
  FileKind kind_ = FileKind::none;
  bool required_ = false, shows_default_ = false;
  /// numbers of values of the option; 0: determined by the target's type
  int values_ = 0, values_each_time_ = 0;
  char separator_ = 0;
  double min_ = 0, max_ = 0;  ///< bounds of the value; equal: none
  std::vector<std::string> choices_;
};

class CommandOptions {
public:
  /// Adds an option; `names` is "-o,--output", or "scene" for a positional argument.
  template <class T>
  CommandOption& add(std::string names, T& target, std::string help) {
    return *options_.emplace_back(
        std::make_unique<CommandOption>(std::move(names), &target, std::move(help)));
  }
  /// Makes `words` receive all that follows the command's name, options included, for a command that another program reads.
  void pass_on(std::vector<std::string>& words) { words_ = &words; }
  const std::vector<std::unique_ptr<CommandOption>>& all() const { return options_; }

private:
  friend class CommandLine;
  std::vector<std::unique_ptr<CommandOption>> options_;
  std::vector<std::string>* words_ = nullptr;
};

struct Command {
  /// name of the command, such as "pigment fit" for the command "fit" of the group "pigment"; a group is a
  /// command without `declare`
  std::string name, help;
  /// Declares the options and returns the function that runs after they are read. Its return value is the
  /// program's exit code. It may throw Error, which the program prints before it returns 2.
  std::function<std::function<int()>(CommandOptions&)> declare;
};

/// All registered commands, sorted by name.
std::vector<Command> commands();

struct CommandRegistration {
  explicit CommandRegistration(Command command);
};

/// Registers a command: AUREOLE_COMMAND("info", "List the content of a scene", declare_info);
#define AUREOLE_COMMAND(name, help, declare) \
  static const ::aureole::CommandRegistration aureole_command_registration({name, help, declare})

/// A file of a command, by the option that names it ("--csv"), or by what it is ("the target").
struct NamedFile {
  std::string named_by;
  std::filesystem::path file;
};

/// Adds files that the command of this process writes. Throws Error where two outputs are one file, or an output is an input.
/// Commands call it for outputs whose names they derive; it has been called for options with `names_output`.
void add_outputs(const std::vector<NamedFile>& outputs);

/// Adds files that the command of this process reads. Throws Error where an output is an input. It has been called for positional
/// arguments and for options with `names_input`; `load_options` calls it for all files of a scene.
void add_inputs(const std::vector<NamedFile>& inputs);

/// Splits options -D name=value; throws Error for any other form.
std::vector<std::pair<std::string, std::string>> split_defines(const std::vector<std::string>& list);

}  // namespace aureole
