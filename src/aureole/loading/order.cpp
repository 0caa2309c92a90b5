// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/order.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace aureole {

namespace {

/// Line and column pairs, from the main file through its includes down to the location.
using Place = std::vector<int>;

Place place_in(const SourceFile* file, int line, int column) {
  Place place{line, column};
  for (; file->included_by; file = file->included_by.get())
    place.insert(place.begin(), {file->included_at.line, file->included_at.column});
  return place;
}

/// Returns the file that a message is about, or null; sets the line and the column.
const SourceFile* read_place(const std::string& message, const std::vector<SourceFilePtr>& files, int& line,
                             int& column) {
  for (const SourceFilePtr& file : files) {
    if (!message.starts_with(file->shown + ":")) continue;
    const char *p = message.data() + file->shown.size() + 1, *end = message.data() + message.size();
    line = column = 0;
    const auto after_line = std::from_chars(p, end, line);
    if (after_line.ptr != p && after_line.ptr < end) std::from_chars(after_line.ptr + 1, end, column);
    return file.get();
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> in_file_order(const std::vector<std::string>& messages,
                                       const std::vector<SourceFilePtr>& files) {
  std::vector<std::pair<Place, std::string>> placed;
  std::vector<std::string> others;
  for (const std::string& message : messages) {
    int line = 0, column = 0;
    const SourceFile* file = read_place(message, files, line, column);
    if (!file) {
      others.push_back(message);
      continue;
    }
    std::string text = message;
    for (const SourceFile* f = file; f->included_by; f = f->included_by.get())
      text += "\n  included from " + f->included_at.str();
    placed.emplace_back(place_in(file, line, column), std::move(text));
  }
  std::stable_sort(placed.begin(), placed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> sorted;
  for (auto& [place, text] : placed) sorted.push_back(std::move(text));
  sorted.insert(sorted.end(), others.begin(), others.end());
  return sorted;
}

}  // namespace aureole
