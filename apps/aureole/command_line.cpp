// SPDX-License-Identifier: Apache-2.0
// The command line: passes the options declared by the subcommands to CLI11.
#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <system_error>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "command.h"
#include "interruption.h"

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
    require_entries(argc, argv);
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

  /// Throws Error for a list with an empty entry ("20,,60"), which CLI11 would leave out without a word.
  void require_entries(int argc, char** argv) const {
    std::string name;
    const CommandOptions* options = nullptr;
    int first = 1;
    for (; first < argc && argv[first][0] != '-'; ++first) {
      name += (name.empty() ? "" : " ") + std::string(argv[first]);
      const auto found = named_.find(name);
      if (found == named_.end()) break;
      options = found->second;
    }
    if (!options) return;
    for (const auto& option : options->all()) {
      if (!option->separator_) continue;
      const std::string names = "," + option->names_ + ",";
      for (int i = first; i < argc; ++i) {
        const std::string word = argv[i];
        const std::size_t equals = word.find('=');
        const std::string called = word.substr(0, equals);
        if (called.empty() || called[0] != '-' || names.find("," + called + ",") == std::string::npos)
          continue;
        if (equals != std::string::npos)
          require_entries(called, word.substr(equals + 1), option->separator_);
        else if (i + 1 < argc)
          require_entries(called, argv[i + 1], option->separator_);
      }
    }
  }
  static void require_entries(const std::string& option, const std::string& list, char separator) {
    std::size_t begin = 0;
    for (int entry = 1;; ++entry) {
      const std::size_t end = std::min(list.find(separator, begin), list.size());
      if (list.find_first_not_of(' ', begin) >= end)
        throw Error(option + ": entry " + std::to_string(entry) + " of \"" + list + "\" is empty");
      if (end == list.size()) return;
      begin = end + 1;
    }
  }

  void add(const Command& command) {
    const std::size_t blank = command.name.rfind(' ');
    CLI::App* parent = &app_;
    if (blank != std::string::npos) parent = app_.get_subcommand(command.name.substr(0, blank));
    CLI::App* sub = parent->add_subcommand(command.name.substr(blank + 1), command.help);
    if (!command.declare) {
      named_[command.name] = nullptr;
      sub->require_subcommand(1);
      return;
    }
    const auto& options = declared_.emplace_back(std::make_unique<CommandOptions>());
    named_[command.name] = options.get();
    const std::function<int()> action = command.declare(*options);
    for (const auto& option : options->all()) add(*sub, *option);
    if (options->words_) {
      sub->prefix_command();
      sub->set_help_flag();
    }
    sub->callback([this, action, sub, all = options.get()] {
      if (all->words_) *all->words_ = sub->remaining();
      require_outputs(*all);
      exit_code_ = action();
    });
  }

  /// The files that the values of an option name, by its last name, "--output".
  static std::vector<NamedFile> files_of(const CommandOption& option) {
    const std::string name = option.names_.substr(option.names_.rfind(',') + 1);
    std::vector<NamedFile> files;
    if (const auto* one = std::get_if<std::string*>(&option.target_); one && !(*one)->empty())
      files.push_back({name, **one});
    if (const auto* several = std::get_if<std::vector<std::string>*>(&option.target_))
      for (const std::string& file : **several) files.push_back({name, file});
    return files;
  }

  /// Throws Error for outputs that cannot be written, or that are files of other options or of the positional arguments.
  static void require_outputs(const CommandOptions& options) {
    using Kind = CommandOption::FileKind;
    for (const auto& option : options.all()) {
      const bool is_positional = option->names_[0] != '-';
      if (option->kind_ != Kind::input && !(is_positional && option->kind_ == Kind::none)) continue;
      for (const NamedFile& file : files_of(*option)) {
        const std::string name = (is_positional ? "the " : "") + file.named_by, text = file.file.string();
        add_inputs({{name, text}});
        // A target such as scene.xml#id is a part of a file.
        if (const std::size_t mark = text.rfind('#'); mark != text.npos)
          add_inputs({{name, text.substr(0, mark)}});
      }
    }
    for (const auto& option : options.all()) {
      if (option->kind_ != Kind::output) continue;
      const std::vector<NamedFile> outputs = files_of(*option);
      add_outputs(outputs);
      for (const NamedFile& output : outputs) require_writable(output.file);
    }
  }

  static void add(CLI::App& sub, const CommandOption& o) {
    CLI::Option* option = std::visit([&](auto* target) { return add(sub, o, *target); }, o.target_);
    option->required(o.required_);
    if (o.shows_default_) option->capture_default_str();
    if (o.separator_) option->delimiter(o.separator_);
    if (o.values_) option->expected(o.values_);
    if (o.values_each_time_) option->type_size(o.values_each_time_);
    if (!o.choices_.empty()) option->check(CLI::IsMember(o.choices_));
    // The library reads no text as the number 0, and commands take it for an option that is not given.
    if (!std::holds_alternative<bool*>(o.target_))
      option->check([](const std::string& text) { return std::string(text.empty() ? "needs a value" : ""); });
    // Each use of an option takes the number of values that it states, or else one: the next word may be a
    // positional argument.
    if (!option->get_positional()) option->allow_extra_args(false);
  }
  static CLI::Option* add(CLI::App& sub, const CommandOption& o, bool& target) {
    return sub.add_flag(o.names_, target, o.help_);
  }
  template <class T>
  static CLI::Option* add(CLI::App& sub, const CommandOption& o, T& target) {
    CLI::Option* option = sub.add_option(o.names_, target, o.help_);
    if constexpr (std::is_same_v<T, std::uint64_t>)  // the library wraps negative numbers around
      option->check([](const std::string& text) {
        return std::string(text.find('-') != text.npos ? text + " is negative" : "");
      });
    using Number = typename NumberOf<T>::type;
    if constexpr (std::is_arithmetic_v<Number>)
      if (o.min_ < o.max_) option->check(CLI::Range(Number(o.min_), Number(o.max_)));
    if constexpr (std::is_floating_point_v<Number>)
      if (o.min_ < o.max_)  // a NaN lies within every range of CLI11
        option->check([](const std::string& text) {
          return CLI::detail::to_lower(text).find("nan") == text.npos ? "" : text + " is not a number";
        });
    return option;
  }

  template <class T>
  struct NumberOf {
    using type = T;
  };
  template <class T>
  struct NumberOf<std::optional<T>> {
    using type = T;
  };

  CLI::App app_;
  std::vector<std::unique_ptr<CommandOptions>> declared_;
  std::map<std::string, const CommandOptions*> named_;  ///< by the commands' names; null for groups
  int exit_code_ = 0;
};

namespace {

/// The error number of a failed print to standard output, or 0.
int output_error = 0;

/// Returns the exit code of a command that ended with `code`: a failed print to standard output is an error,
/// while messages on standard error may be lost.
int code_with_output(int code) {
  if (std::fflush(stdout) != 0 && output_error == 0) output_error = errno;
  if (std::ferror(stdout) && output_error == 0) output_error = EIO;
  if (output_error == 0) return code;
  // A closed pipe is no error, since a reader that has read enough, such as head, closes it.
  if (output_error != EPIPE)
    std::fprintf(stderr, "error: standard output cannot be written: %s\n", std::strerror(output_error));
  return code == 0 ? 1 : code;
}

int run_commands(int argc, char** argv) {
  try {
    return CommandLine().run(argc, argv);
  } catch (const ErrorList& list) {
    for (const auto& line : list.errors()) std::fprintf(stderr, "error: %s\n", line.c_str());
  } catch (const Error& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    if (is_interrupted()) return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: not enough memory\n");
  } catch (const std::system_error& e) {
    if (std::ferror(stdout))
      output_error = e.code().value();
    else
      std::fprintf(stderr, "error: %s\n", e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
  }
  return 2;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  open_standard_streams();
  // SIGPIPE is ignored, since a closed pipe of standard error must not end a job of hours. Errors of standard
  // output are checked at the end.
  std::signal(SIGPIPE, SIG_IGN);
  return code_with_output(run_commands(argc, argv));
}

}  // namespace aureole
