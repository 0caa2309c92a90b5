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
  /// Values given on the command line override every <default>; of two values for one name, the last one
  /// wins.
  explicit Parameters(const std::vector<std::pair<std::string, std::string>>& defines);

  /// Adds a <default> element; it has no effect if the name already has a value.
  void add_default(const std::string& name, const std::string& value);

  /// Replaces every $name by its value and \$ by $. A name ends where the identifier ends: with only `res`
  /// defined, `$resx` is undefined. Throws Error for undefined names.
  std::string substitute(std::string_view text, const SourceLocation& where);

  /// Reports every value from the command line that the scene does not use.
  void report_unused(const std::string& file, Diagnostics& diagnostics) const;

private:
  struct Parameter {
    std::string name, value;
    bool from_command_line = false, has_default = false, used = false;
  };
  Parameter* find(std::string_view name);
  Parameter* longest_match(std::string_view text);

  std::vector<Parameter> parameters_;
  std::size_t inserted_ = 0;  ///< total characters of substituted values
};

}  // namespace aureole
