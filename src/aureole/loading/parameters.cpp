// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/parameters.h"

#include <algorithm>
#include <cctype>

namespace aureole {

namespace {

/// Limit of the total length of all substituted values: nested definitions such as b = $a$a double the length
/// each time.
constexpr std::size_t kMaxInserted = std::size_t(1) << 26;

bool is_identifier(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

Parameters::Parameters(const std::vector<std::pair<std::string, std::string>>& defines) {
  for (const auto& [name, value] : defines) {
    if (Parameter* known = find(name))
      known->value = value;
    else
      parameters_.push_back({name, value, true, false, false});
  }
}

Parameters::Parameter* Parameters::find(std::string_view name) {
  for (Parameter& p : parameters_)
    if (p.name == name) return &p;
  return nullptr;
}

void Parameters::add_default(const std::string& name, const std::string& value) {
  if (Parameter* known = find(name))
    known->has_default = true;
  else
    parameters_.push_back({name, value, false, true, false});
}

Parameters::Parameter* Parameters::longest_match(std::string_view text) {
  Parameter* best = nullptr;
  for (Parameter& p : parameters_) {
    if (p.name.empty() || !text.starts_with(p.name)) continue;
    if (text.size() > p.name.size() && is_identifier(text[p.name.size()])) continue;
    if (!best || p.name.size() > best->name.size()) best = &p;
  }
  return best;
}

std::string Parameters::substitute(std::string_view text, const SourceLocation& where) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
      result += text[++i];
      continue;
    }
    if (text[i] != '$') {
      result += text[i];
      continue;
    }
    const std::string_view rest = text.substr(i + 1);
    if (Parameter* p = longest_match(rest)) {
      p->used = true;
      inserted_ += p->value.size();
      if (inserted_ > kMaxInserted)
        throw Error(where, "the values of $" + p->name + " and other parameters make the scene longer than " +
                               std::to_string(kMaxInserted >> 20) + " MiB");
      result += p->value;
      i += p->name.size();
      continue;
    }
    const auto end = std::find_if_not(rest.begin(), rest.end(), is_identifier);
    const std::string name(rest.begin(), end);
    if (name.empty())
      throw Error(where, "a $ must be followed by the name of a parameter; write \\$ for the character");
    std::vector<std::string> names;
    for (const Parameter& p : parameters_) names.push_back(p.name);
    const std::string near = nearest_name(name, names);
    throw Error(where, "undefined $" + name +
                           (near.empty() ? "; define it with -D " + name +
                                               "=... or, before its first use, with <default name=\"" + name +
                                               "\" value=\"...\"/>"
                                         : "; did you mean $" + near + "?"));
  }
  return result;
}

void Parameters::report_unused(const std::string& file, Diagnostics& diagnostics) const {
  for (const Parameter& p : parameters_) {
    if (!p.from_command_line || p.used) continue;
    std::vector<std::string> names;
    for (const Parameter& other : parameters_)
      if (!other.from_command_line || other.used) names.push_back(other.name);
    diagnostics.error({file, 0, 0}, "-D " + p.name + "=" + p.value + " is not used: the scene has no $" +
                                        p.name + did_you_mean(p.name, names));
  }
}

}  // namespace aureole
