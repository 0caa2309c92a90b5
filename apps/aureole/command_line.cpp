// SPDX-License-Identifier: Apache-2.0
// The command line: passes the options declared by the subcommands to CLI11.
#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "command.h"

namespace aureole {

class CommandLine {
public:
  CommandLine() : app_("aureole: a spectral renderer and toolkit for material appearance", "aureole") {
    app_.set_version_flag("--version", std::string("aureole ") + kVersion);
    app_.require_subcommand(1);
    for (const Command& command : commands()) add(command);
  }

  int run(int argc, char** argv) {
    if (argc > 1 && argv[1][0] != '-') require_command(argv[1]);
    try {
      app_.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      return app_.exit(e) == 0 ? 0 : 2;
    }
    return exit_code_;
  }

private:
  static void require_command(const std::string& name) {
    std::vector<std::string> names;
    for (const Command& command : commands()) names.push_back(command.name);
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    std::string hint = did_you_mean(name, names);
    if (hint.empty())
      for (const std::string& known : names) hint += (hint.empty() ? "; there are: " : ", ") + known;
    throw Error("unknown command \"" + name + "\"" + hint);
  }

  void add(const Command& command) {
    const std::size_t blank = command.name.rfind(' ');
    CLI::App* parent = &app_;
    if (blank != std::string::npos) parent = app_.get_subcommand(command.name.substr(0, blank));
    CLI::App* sub = parent->add_subcommand(command.name.substr(blank + 1), command.help);
    if (!command.declare) {
      sub->require_subcommand(1);
      return;
    }
    const auto& options = declared_.emplace_back(std::make_unique<CommandOptions>());
    const std::function<int()> action = command.declare(*options);
    for (const auto& option : options->all()) add(*sub, *option);
    sub->callback([this, action, all = options.get()] {
      for (const auto& option : all->all()) {
        const auto* file = std::get_if<std::string*>(&option->target_);
        if (option->names_output_ && file && !(*file)->empty()) require_writable(**file);
      }
      exit_code_ = action();
    });
  }

  static void add(CLI::App& sub, const CommandOption& o) {
    CLI::Option* option = std::visit([&](auto* target) { return add(sub, o, *target); }, o.target_);
    option->required(o.required_);
    if (o.shows_default_) option->capture_default_str();
    if (o.separator_) option->delimiter(o.separator_);
    if (o.values_) option->expected(o.values_);
    if (o.values_each_time_) option->type_size(o.values_each_time_);
    if (!o.choices_.empty()) option->check(CLI::IsMember(o.choices_));
    // Each use of an option takes one value, since the next word may be a positional argument.
    if (o.values_each_time_ == 1) option->allow_extra_args(false);
  }
  static CLI::Option* add(CLI::App& sub, const CommandOption& o, bool& target) {
    return sub.add_flag(o.names_, target, o.help_);
  }
  template <class T>
  static CLI::Option* add(CLI::App& sub, const CommandOption& o, T& target) {
    CLI::Option* option = sub.add_option(o.names_, target, o.help_);
    if constexpr (std::is_arithmetic_v<T>)
      if (o.min_ < o.max_) option->check(CLI::Range(T(o.min_), T(o.max_)));
    return option;
  }

  CLI::App app_;
  std::vector<std::unique_ptr<CommandOptions>> declared_;
  int exit_code_ = 0;
};

int run_command_line(int argc, char** argv) {
  try {
    return CommandLine().run(argc, argv);
  } catch (const ErrorList& list) {
    for (const auto& line : list.errors()) std::fprintf(stderr, "error: %s\n", line.c_str());
  } catch (const Error& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: not enough memory\n");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
  }
  return 2;
}

}  // namespace aureole
