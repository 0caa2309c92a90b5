// SPDX-License-Identifier: Apache-2.0
// Errors with source locations. Wrong input is an `Error`, with a location in a file if there is one.
// `Diagnostics` collects errors, so that a user sees all problems of a scene at once.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace aureole {

/// The name of a file in messages. Each name is stored once per process, so that the locations of a large file
/// take little memory and are copied fast.
class FileName {
public:
  FileName() = default;
  FileName(const std::string& name);
  FileName(const char* name) : FileName(std::string(name)) {}

  const std::string& str() const;
  operator const std::string&() const { return str(); }
  bool empty() const { return !name_; }
  friend bool operator==(FileName a, FileName b) { return a.name_ == b.name_; }

private:
  const std::string* name_ = nullptr;  ///< the stored name; null for an empty name
};

/// A position in a text file. `line` and `column` count from 1; 0 means unknown.
struct SourceLocation {
  FileName file;
  int line = 0;
  int column = 0;

  /// Returns "file:line:column", without unknown parts.
  std::string str() const;
};

/// An error in the user's input. The applications catch it, print it and exit with code 2.
class Error : public std::runtime_error {
public:
  explicit Error(const std::string& message) : std::runtime_error(message), message_(message) {}
  Error(const SourceLocation& where, const std::string& message)
      : std::runtime_error(where.file.empty() ? message : where.str() + ": " + message),
        where_(where),
        message_(message) {}

  const SourceLocation& where() const { return where_; }
  const std::string& message() const { return message_; }

private:
  SourceLocation where_;
  std::string message_;
};

/// Collects errors and notes while a file is read. Identical entries are kept once.
class Diagnostics {
public:
  void error(const SourceLocation& where, const std::string& message);
  void error(const Error& e) { error(e.where(), e.message()); }
  void note(const SourceLocation& where, const std::string& message);

  bool has_errors() const { return !errors_.empty(); }
  const std::vector<std::string>& errors() const { return errors_; }
  const std::vector<std::string>& notes() const { return notes_; }

  /// Throws one `ErrorList` with all collected errors, if there are any.
  void throw_if_errors() const;

private:
  void add_once(std::vector<std::string>& list, const SourceLocation& where, const std::string& message);

  std::vector<std::string> errors_, notes_;
  /// entries of both lists, for a fast search: a scene may have 100,000 problems
  std::unordered_set<std::string> known_;
};

/// Several errors in one exception; `what()` joins them by newlines.
class ErrorList : public Error {
public:
  explicit ErrorList(std::vector<std::string> errors);
  const std::vector<std::string>& errors() const { return errors_; }

private:
  std::vector<std::string> errors_;
};

/// Returns the candidate nearest to `name` in edit distance (case-insensitive), or an empty string if none is
/// similar.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// Returns `"; did you mean \"x\"?"` for the nearest candidate, or an empty string.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);
/// Returns `did_you_mean`, or "; there are: a, b, c" if no candidate is near.
std::string did_you_mean_or_all(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace aureole
