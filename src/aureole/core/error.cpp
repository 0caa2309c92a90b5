// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/error.h"

#include <algorithm>
#include <mutex>

#include "aureole/core/letter_case.h"

namespace aureole {

FileName::FileName(const std::string& name) {
  static std::mutex mutex;
  // the set is never destroyed, since locations refer to its names
  static auto& names = *new std::unordered_set<std::string>;
  if (name.empty()) return;
  const std::lock_guard lock(mutex);
  name_ = &*names.insert(name).first;
}

const std::string& FileName::str() const {
  static const std::string none;
  return name_ ? *name_ : none;
}

std::string SourceLocation::str() const {
  std::string s = file;
  if (line > 0) s += ":" + std::to_string(line);
  if (line > 0 && column > 0) s += ":" + std::to_string(column);
  return s;
}

namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string s;
  for (const auto& l : lines) s += (s.empty() ? "" : "\n") + l;
  return s;
}

size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

void Diagnostics::add_once(std::vector<std::string>& list, const SourceLocation& where,
                           const std::string& message) {
  std::string text = where.file.empty() ? message : where.str() + ": " + message;
  if (known_.insert((&list == &errors_ ? "e" : "n") + text).second) list.push_back(std::move(text));
}

void Diagnostics::error(const SourceLocation& where, const std::string& m) { add_once(errors_, where, m); }
void Diagnostics::note(const SourceLocation& where, const std::string& m) { add_once(notes_, where, m); }

void Diagnostics::throw_if_errors() const {
  if (has_errors()) throw ErrorList(errors_);
}

ErrorList::ErrorList(std::vector<std::string> errors) : Error(joined(errors)), errors_(std::move(errors)) {}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string wanted = lower_case(name);
  std::string best;
  // Largest number of letters that may differ, a third: enough for typing errors, while unrelated words are
  // not suggested.
  size_t best_distance = std::max<size_t>(2, wanted.size() / 3) + 1;
  for (const auto& c : candidates) {
    const std::string candidate = lower_case(c);
    size_t d = edit_distance(wanted, candidate);
    if (wanted.size() >= 4 && candidate.size() > wanted.size() && candidate.find(wanted) != std::string::npos)
      d = std::min<size_t>(d, 2);
    if (d < best_distance) best_distance = d, best = c;
  }
  return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string best = nearest_name(name, candidates);
  return best.empty() ? "" : "; did you mean \"" + best + "\"?";
}

std::string did_you_mean_or_all(std::string_view name, const std::vector<std::string>& candidates) {
  std::string text = did_you_mean(name, candidates);
  if (!text.empty() || candidates.empty()) return text;
  for (const std::string& candidate : candidates) text += (text.empty() ? "; there are: " : ", ") + candidate;
  return text;
}

}  // namespace aureole
