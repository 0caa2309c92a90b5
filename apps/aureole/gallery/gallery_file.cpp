// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_file.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "gallery/gallery_plots.h"

namespace aureole {
namespace {

using Json = nlohmann::json;

SourceLocation place(const std::string& file, const std::string& text, std::size_t offset) {
  offset = std::min(offset, text.size());
  SourceLocation where{file, 1, 1};
  for (std::size_t i = 0; i < offset; ++i)
    text[i] == '\n' ? (++where.line, where.column = 1) : ++where.column;
  return where;
}

/// A JSON file that knows the line of every value, recorded in the parser's callbacks.
class JsonFile {
public:
  explicit JsonFile(const std::filesystem::path& path) : name_(path.string()) {
    if (const std::string fault = fault_of_input(path); !fault.empty())
      throw Error({name_, 0, 0}, fault + "; a gallery is a folder with a gallery.json");
    text_ = read_text_file(path, kMaxJsonBytes);
    try {
      root_ = Json::parse(Reader{&text_, 0, &offset_}, Reader{&text_, text_.size(), &offset_},
                          [this](int, Json::parse_event_t event, Json& value) {
                            follow(event, value);
                            return true;
                          });
    } catch (const Json::parse_error& e) {
      std::string what = e.what();
      if (const auto colon = what.find(": ", what.find("column")); colon != std::string::npos)
        what = what.substr(colon + 2);
      throw Error(place(name_, text_, e.byte > 0 ? e.byte - 1 : 0), "this is not valid JSON: " + what);
    }
  }
  const Json& root() const { return root_; }
  Error error(const std::string& pointer, const std::string& message) const {
    const auto at = offsets_.find(pointer);
    return Error(place(name_, text_, at == offsets_.end() ? 0 : at->second), message);
  }

private:
  /// An input iterator that counts the lines read so far.
  struct Reader {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;
    const std::string* text;
    std::size_t at;
    std::size_t* reached;
    reference operator*() const { return (*text)[*reached = at]; }
    Reader& operator++() { return ++at, *this; }
    Reader operator++(int) { return {text, at++, reached}; }
    bool operator==(const Reader& o) const { return at == o.at; }
    bool operator!=(const Reader& o) const { return at != o.at; }
  };

  void follow(Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (event == Event::key) {
      levels_.back().key = value.get<std::string>();
      return;
    }
    if (event == Event::object_end || event == Event::array_end) {
      levels_.pop_back();
      return;
    }
    std::string here = levels_.empty() ? "" : levels_.back().path + "/";
    if (!levels_.empty())
      here += levels_.back().index >= 0 ? std::to_string(levels_.back().index++) : levels_.back().key;
    // Only the line is exact for a string, since the parser has already reached the closing quote.
    offsets_[here] = offset_;
    if (event != Event::value) levels_.push_back({here, "", event == Event::array_start ? 0 : -1});
  }

  struct Level {
    std::string path, key;
    int index;
  };
  std::string name_, text_;
  std::size_t offset_ = 0;
  Json root_;
  std::vector<Level> levels_;
  std::map<std::string, std::size_t> offsets_;
};

/// One object of the file. Reading a member checks its type; `finish` reports unknown members.
class Members {
public:
  Members(const JsonFile& file, const Json& value, std::string pointer)
      : file_(file), value_(value), pointer_(std::move(pointer)) {
    if (!value.is_object()) throw error("expected an object, { ... }");
  }
  Error error(const std::string& message) const { return file_.error(pointer_, message); }
  Error error(const std::string& name, const std::string& message) const {
    return file_.error(pointer_ + "/" + name, "\"" + name + "\": " + message);
  }
  bool has(const std::string& name) {
    known_.push_back(name);
    return value_.contains(name);
  }
  const Json& get(const std::string& name) {
    if (!has(name)) throw error("the member \"" + name + "\" is missing");
    return value_[name];
  }
  std::string text(const std::string& name) {
    const Json& v = get(name);
    if (!v.is_string()) throw error(name, "expected a text");
    return v.get<std::string>();
  }
  std::string text(const std::string& name, const std::string& fallback) {
    return has(name) ? text(name) : fallback;
  }
  double number(const std::string& name, double low, double high) {
    const Json& v = get(name);
    if (!v.is_number() || !(v.get<double>() >= low && v.get<double>() <= high))
      throw error(name, fmt::format("expected a number from {:g} to {:g}", low, high));
    return v.get<double>();
  }
  std::int64_t integer(const std::string& name, double low, double high) {
    const double v = number(name, low, high);
    if (v != std::floor(v)) throw error(name, "expected a whole number");
    return std::int64_t(v);
  }
  Members member(const std::string& name) { return {file_, get(name), pointer_ + "/" + name}; }
  std::vector<Members> list(const std::string& name) {
    const Json& v = get(name);
    if (!v.is_array()) throw error(name, "expected a list, [ ... ]");
    std::vector<Members> out;
    for (std::size_t i = 0; i < v.size(); ++i)
      out.emplace_back(file_, v[i], pointer_ + "/" + name + "/" + std::to_string(i));
    return out;
  }
  std::vector<Members> list_if(const std::string& name) {
    return has(name) ? list(name) : std::vector<Members>{};
  }
  /// Reads members with arbitrary names.
  Defines defines(const std::string& name) {
    Defines out;
    if (!has(name)) return out;
    if (!value_[name].is_object()) throw error(name, "expected an object, { ... }");
    for (const auto& [key, v] : value_[name].items()) {
      if (!v.is_string() && !v.is_number() && !v.is_boolean())
        throw error(name, "the value of \"" + key + "\" must be a text or a number");
      out.emplace_back(key, v.is_string() ? v.get<std::string>() : v.dump());
    }
    return out;
  }
  const Json& json() const { return value_; }
  void finish() const {
    for (const auto& [key, v] : value_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        throw file_.error(pointer_ + "/" + key,
                          "there is no member \"" + key + "\" here" + did_you_mean(key, known_));
  }

private:
  const JsonFile& file_;
  const Json& value_;
  std::string pointer_;
  std::vector<std::string> known_;
};

PictureEffort read_effort(Members m, const PictureEffort* size) {
  PictureEffort effort;
  if (m.has("size")) {
    const Json& s = m.get("size");
    const auto good = [](const Json& v) {
      return v.is_number_integer() && v.get<std::int64_t>() >= 1 && v.get<std::int64_t>() <= 16384;
    };
    if (!s.is_array() || s.size() != 2 || !good(s[0]) || !good(s[1]))
      throw m.error("size", "expected [width, height] in pixels, each from 1 to 16384");
    effort.width = s[0].get<int>(), effort.height = s[1].get<int>();
  } else if (size) {
    effort = *size;
  } else {
    throw m.error("the member \"size\" is missing: [width, height]");
  }
  effort.samples = 0, effort.seconds = 0;
  if (m.has("spp") == m.has("time")) throw m.error("give either \"spp\" or \"time\"");
  if (m.has("spp"))
    effort.samples = m.integer("spp", 1, 1e9);
  else
    effort.seconds = m.number("time", 0.01, 1e6);
  m.finish();
  return effort;
}

std::vector<Axis> read_axes(Members& m, const std::string& name) {
  std::vector<Axis> axes;
  for (Members& a : m.list_if(name)) {
    Axis axis;
    for (Members& v : a.list("values")) {
      axis.push_back({v.text("label"), v.defines("defines")});
      v.finish();
    }
    a.finish();
    if (axis.empty()) throw a.error("an axis needs values");
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// Adds the values at position `i` of nested axes.
void add_defines(Defines& out, const std::vector<Axis>& axes, std::size_t i) {
  for (std::size_t k = axes.size(); k-- > 0; i /= axes[k].size())
    for (const auto& d : axes[k][i % axes[k].size()].defines) out.push_back(d);
}

PictureTable read_table(Members& m, const std::filesystem::path& folder, const std::string& stem) {
  PictureTable table;
  GalleryPicture picture;
  table.caption = m.text("caption", "");
  const std::string scene = m.text("scene");
  picture.scene = (folder / scene).lexically_normal();
  if (!std::filesystem::is_regular_file(picture.scene))
    throw m.error("scene", "there is no file " + picture.scene.string());
  picture.defines = m.defines("defines");
  if (m.has("tone")) {
    Members tone = m.member("tone");
    if (tone.has("exposure")) picture.tone.exposure = tone.number("exposure", -40, 40);
    if (tone.has("compression")) picture.tone.compression = tone.number("compression", 0, 1e9);
    tone.finish();
  }
  for (const GallerySize size : {kPreviewSize, kFullSize})
    picture.effort[size] = read_effort(m.member(name_of(size)), nullptr);
  table.rows = read_axes(m, "rows");
  table.columns = read_axes(m, "columns");
  if (m.has("reference")) {
    Members r = m.member("reference");
    table.reference = picture;
    table.reference->name = stem + "-reference";
    for (const auto& d : r.defines("defines")) table.reference->defines.push_back(d);
    for (const GallerySize size : {kPreviewSize, kFullSize})
      table.reference->effort[size] = read_effort(r.member(name_of(size)), &picture.effort[size]);
    r.finish();
  }
  const std::size_t rows = PictureTable::count(table.rows), columns = PictureTable::count(table.columns);
  if (rows * columns > 10000) throw m.error("this is a table of more than 10000 pictures");
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      GalleryPicture p = picture;
      p.name = stem;
      if (rows > 1) p.name += fmt::format("-{}", i + 1);
      if (columns > 1) p.name += fmt::format("-{}", j + 1);
      add_defines(p.defines, table.rows, i);
      add_defines(p.defines, table.columns, j);
      table.pictures.push_back(std::move(p));
    }
  m.finish();
  return table;
}

}  // namespace

std::size_t PictureTable::count(const std::vector<Axis>& axes) {
  std::size_t n = 1;
  for (const Axis& a : axes) n = std::min<std::size_t>(n * a.size(), 1 << 20);
  return n;
}

Gallery read_gallery(const std::filesystem::path& folder) {
  const JsonFile file(folder / "gallery.json");
  Members root(file, file.root(), "");
  Gallery gallery;
  gallery.title = root.text("title");
  gallery.introduction = root.text("introduction", "");
  std::set<std::string> ids;
  for (Members& m : root.list("figures")) {
    GalleryFigure f;
    f.id = m.text("id");
    if (f.id.empty() || f.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != f.id.npos)
      throw m.error("id", "write small letters, digits and _ only: files are called so");
    if (!ids.insert(f.id).second) throw m.error("id", "there is another figure \"" + f.id + "\"");
    f.title = m.text("title");
    f.counterpart = m.text("counterpart", "");
    f.caption = m.text("caption");
    f.agreement = m.text("agreement", "");
    if (m.has("needs")) {
      Members needs = m.member("needs");
      const std::string needed = needs.text("file"), how = needs.text("how");
      if (!std::filesystem::exists(folder / needed))
        f.missing = (folder / needed).string() + " is missing: " + how;
      needs.finish();
    }
    auto tables = m.list_if("renders");
    for (std::size_t i = 0; i < tables.size(); ++i)
      f.tables.push_back(
          read_table(tables[i], folder,
                     tables.size() > 1 ? f.id + char('a' + int(std::min<std::size_t>(i, 25))) : f.id));
    if (tables.size() > 26) throw m.error("renders", "at most 26");
    auto plots = m.list_if("plots");
    for (std::size_t i = 0; i < plots.size(); ++i) {
      GalleryPlot plot;
      plot.name = fmt::format("{}-plot{}", f.id, i + 1);
      plot.kind = plots[i].text("kind");
      plot.caption = plots[i].text("caption", "");
      plot.parameters = plots[i].json();
      plot.folder = folder;
      try {
        check_plot(plot);
      } catch (const Error& e) {
        throw plots[i].error(e.message());
      }
      f.plots.push_back(std::move(plot));
    }
    if (f.tables.empty() && f.plots.empty()) throw m.error("a figure needs \"renders\" or \"plots\"");
    m.finish();
    gallery.figures.push_back(std::move(f));
  }
  root.finish();
  if (gallery.figures.empty()) throw root.error("figures", "there are none");
  return gallery;
}

}  // namespace aureole
