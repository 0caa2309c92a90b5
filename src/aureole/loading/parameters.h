// SPDX-License-Identifier: Apache-2.0
// The $name parameters of a scene file: `<default>` elements and -D on the command line.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

class Parameters {
public:
  /// Values given on the command line win over every <default>; of two for one name the last wins.
  explicit Parameters(const std::vector<std::pair<std::string, std::string>>& defines);

  /// A <default> element; has no effect where the name has a value already.
  void add_default(const std::string& name, const std::string& value);

  /// Replaces every $name by its value and \$ by $. A name ends where the identifier ends: with only `res`
  /// defined, `$resx` is undefined. Throws Error for undefined names.
  std::string substitute(std::string_view text, const SourceLocation& where);

  /// Reports every command-line value that the scene did not use.
  void report_unused(const std::string& file, Diagnostics& diagnostics) const;

private:
  struct Parameter {
    std::string name, value;
    bool from_command_line = false, has_default = false, used = false;
  };
  Parameter* find(std::string_view name);
  Parameter* longest_match(std::string_view text);

  std::vector<Parameter> parameters_;
  std::size_t inserted_ = 0;  ///< characters of values so far
};

}  // namespace aureole
