// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/parse.h"

#include <algorithm>
#include <charconv>
#include <pugixml.hpp>
#include <sstream>

#include "aureole/core/input_file.h"
#include "aureole/loading/encoding.h"
#include "aureole/loading/parameters.h"

namespace aureole {

namespace fs = std::filesystem;

namespace {

/// Limits of nested elements and nested includes, since loading is recursive, and of the number of included
/// files, which may double with every level. The limits are far above real scenes and far below the size of
/// stack and memory.
constexpr int kDeepestElement = 256, kDeepestInclude = 32, kMaxIncludes = 1000;

/// Returns the content of a file, or nothing, with an error that begins with `problem`.
std::optional<std::string> text_of(const fs::path& file, const SourceLocation& where,
                                   const std::string& problem, Diagnostics& diagnostics) {
  try {
    return read_text_file(file, kMaxSceneBytes);
  } catch (const Error& e) {
    diagnostics.error(where, problem + ": " + e.message());
    return {};
  }
}

/// Converts positions in the text that pugixml parses to lines and columns. pugixml parses in place, so that
/// its names and values point into `buffer`, while `original` keeps the line ends that it overwrites.
class LocatedText {
public:
  LocatedText(std::string text, const std::string& file)
      : buffer(text), original_(std::move(text)), file_(file) {
    for (std::size_t i = 0; i < original_.size(); ++i) {
      if (i % kBlock == 0) counts_.push_back(characters_);
      characters_ += begins_character(i);
      if (original_[i] == '\n') line_starts_.push_back(i + 1);
    }
  }

  SourceLocation at(std::size_t offset) const {
    offset = std::min(offset, original_.size());
    // Positions are mostly requested in order: they lie in the line of the last one or in the next line.
    const auto is_in = [&](std::size_t line) {
      return line_starts_[line] <= offset &&
             (line + 1 == line_starts_.size() || offset < line_starts_[line + 1]);
    };
    if (!is_in(last_line_) && (last_line_ + 1 == line_starts_.size() || !is_in(++last_line_)))
      last_line_ = std::size_t(std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) -
                               line_starts_.begin()) -
                   1;
    return {file_, int(last_line_) + 1,
            1 + int(characters_before(offset) - characters_before(line_starts_[last_line_]))};
  }
  /// Returns an unknown line for pointers outside the text, such as the empty value of an attribute.
  SourceLocation at(const char* p, std::size_t back = 0) const {
    if (p < buffer.data() || p > buffer.data() + buffer.size()) return {file_, 0, 0};
    return at(std::size_t(p - buffer.data()) - back);
  }

  std::string buffer;

private:
  bool begins_character(std::size_t i) const {  // whether a UTF-8 character begins at byte i
    return (static_cast<unsigned char>(original_[i]) & 0xC0) != 0x80;
  }
  std::size_t characters_before(std::size_t offset) const {
    if (offset == original_.size()) return characters_;
    std::size_t count = counts_[offset / kBlock];
    for (std::size_t i = offset - offset % kBlock; i < offset; ++i) count += begins_character(i);
    return count;
  }

  /// The number of characters before each block of bytes, so that a position in a long line is found quickly.
  static constexpr std::size_t kBlock = 64;
  std::string original_;
  FileName file_;
  std::vector<std::size_t> line_starts_{0}, counts_;
  mutable std::size_t last_line_ = 0;  ///< line of the last position, counted from 0
  std::size_t characters_ = 0;
};

SceneVersion parse_version(const Node& root, Diagnostics& diagnostics) {
  SceneVersion version{3, 0, 0};
  const Attribute* a = root.find("version");
  if (!a) {
    diagnostics.error(root.where, "<" + root.tag + "> needs a version: write version=\"3.0.0\"");
    return version;
  }
  const char *p = a->value.data(), *end = p + a->value.size();
  for (int i = 0; i < 3; ++i) {
    const auto [next, problem] = std::from_chars(p, end, version[std::size_t(i)]);
    const bool last = i == 2;
    if (problem != std::errc() || (last ? next != end : next == end || *next != '.')) {
      diagnostics.error(a->where, "the version \"" + a->value + "\" is not of the form \"3.0.0\"");
      return {3, 0, 0};
    }
    p = next + 1;
  }
  return version;
}

class Parser {
public:
  Parser(Parameters& parameters, Diagnostics& diagnostics)
      : parameters_(parameters), diagnostics_(diagnostics) {}

  /// Parses one file; returns false if it is not an XML document.
  bool parse(std::shared_ptr<SourceFile> file, std::string content, Node& root) {
    LocatedText text(to_utf8(std::move(content)), file->shown);
    scene.files.push_back(file);
    pugi::xml_document document;
    const auto result = document.load_buffer_inplace(text.buffer.data(), text.buffer.size(),
                                                     pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
      std::string what = result.description();
      diagnostics_.error(text.at(std::size_t(result.offset)), "not valid XML: " + what);
      return false;
    }
    const pugi::xml_node element = document.document_element();
    root = shell(element, text, file);
    file->version = parse_version(root, diagnostics_);
    const bool included = file->included_by != nullptr;
    if (!included && root.tag != "scene")
      diagnostics_.error(root.where, "the root element must be <scene>, not <" + root.tag + ">");
    add_children(element, text, file, root, 1);
    return true;
  }

  ParsedScene scene;

private:
  /// Returns the element without its children.
  Node shell(pugi::xml_node element, const LocatedText& text, const SourceFilePtr& file) {
    Node node{element.name(), {}, {}, text.at(element.name(), 1), file};
    const auto attributes = element.attributes();
    node.attributes.reserve(std::size_t(std::distance(attributes.begin(), attributes.end())));
    for (const pugi::xml_attribute a : attributes) {
      Attribute attribute{a.name(), a.value(), text.at(a.value())};
      if (attribute.where.line == 0) attribute.where = text.at(a.name());
      try {
        attribute.value = parameters_.substitute(a.value(), attribute.where);
      } catch (const Error& undefined) {
        diagnostics_.error(undefined);
        attribute.failed = true;
      }
      node.attributes.push_back(std::move(attribute));
    }
    return node;
  }

  void add_children(pugi::xml_node element, const LocatedText& text, const SourceFilePtr& file, Node& parent,
                    int depth) {
    if (depth > kDeepestElement) {
      diagnostics_.error(parent.where,
                         "elements are nested more than " + std::to_string(kDeepestElement) + " deep");
      return;
    }
    const auto children = element.children();
    parent.children.reserve(parent.children.size() +
                            std::size_t(std::distance(children.begin(), children.end())));
    for (const pugi::xml_node child : children) {
      if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
        const SourceLocation where = text.at(child.value());
        diagnostics_.error(where.line ? where : parent.where,
                           "text outside of attributes in <" + parent.tag + ">");
      }
      if (child.type() != pugi::node_element) continue;
      Node node = shell(child, text, file);
      if (node.tag == "default") {
        if (check_attributes(node, {"name", "value"}, {}, diagnostics_))
          parameters_.add_default(node.get("name"), node.get("value"));
      } else if (node.tag == "path") {
        add_search_folder(node, depth == 1);
      } else if (node.tag == "include") {
        include(node, parent);
      } else {
        add_children(child, text, file, node, depth + 1);
        parent.children.push_back(std::move(node));
      }
    }
  }

  void add_search_folder(const Node& node, bool at_root) {
    if (!at_root) diagnostics_.error(node.where, "<path> must be a child of <scene>");
    if (!check_attributes(node, {"value"}, {}, diagnostics_) || node.find("value")->failed) return;
    const fs::path folder = find_file(node.get("value"), *node.file, scene.search_folders);
    std::error_code ignored;
    if (folder.empty() || !fs::is_directory(folder, ignored))
      diagnostics_.error(node.find("value")->where, "no such folder: " + node.get("value"));
    else
      scene.search_folders.insert(scene.search_folders.begin(), folder);
  }

  void include(const Node& node, Node& parent) {
    const Attribute* name = node.find("filename");
    if (!check_attributes(node, {"filename"}, {"name"}, diagnostics_) || name->failed) {
      scene.complete = false;
      return;
    }
    auto file = std::make_shared<SourceFile>();
    file->path = find_file(name->value, *node.file, scene.search_folders);
    file->included_by = node.file;
    file->included_at = node.where;
    auto content = text_of(file->path, name->where, "cannot read the included file \"" + name->value + "\"",
                           diagnostics_);
    if (!content) {
      scene.complete = false;
      return;
    }
    int depth = 1;
    std::error_code ignored;
    for (const SourceFile* f = node.file.get(); f; f = f->included_by.get(), ++depth) {
      if (!fs::equivalent(f->path, file->path, ignored)) continue;
      diagnostics_.error(name->where, "recursive include: \"" + name->value + "\" includes itself");
      return;
    }
    if (depth > kDeepestInclude || scene.files.size() > kMaxIncludes) {
      if (scene.complete)
        diagnostics_.error(name->where, "more than " + std::to_string(kMaxIncludes) +
                                            " files are included, or more than " +
                                            std::to_string(kDeepestInclude) + " by one another");
      scene.complete = false;
      return;
    }
    file->shown = shown_path(name->value, *file, *node.file);

    Node root;
    if (!parse(file, std::move(*content), root)) {
      scene.complete = false;
    } else if (root.tag == "scene") {
      for (Node& child : root.children) parent.children.push_back(std::move(child));
    } else {
      std::erase_if(root.attributes, [](const Attribute& a) { return a.name == "version"; });
      if (const Attribute* given = node.find("name")) root.set("name", given->value);
      parent.children.push_back(std::move(root));
    }
  }

  /// Returns the included file's path, relative or absolute like the including file's.
  static std::string shown_path(const std::string& name, const SourceFile& file, const SourceFile& from) {
    const fs::path beside = (fs::path(from.shown).parent_path() / name).lexically_normal();
    std::error_code ignored;
    return fs::equivalent(beside, file.path, ignored) ? beside.string() : file.path.string();
  }

  Parameters& parameters_;
  Diagnostics& diagnostics_;
};

}  // namespace

fs::path find_file(const std::string& filename, const SourceFile& from,
                   const std::vector<fs::path>& folders) {
  const fs::path name = filename;
  std::error_code ignored;
  if (filename.empty()) return {};
  // a name with backslashes that does not exist as it is written may be a Windows path
  const auto of_windows = [&] {
    std::string slashed = filename;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    return slashed == filename ? fs::path() : find_file(slashed, from, folders);
  };
  if (name.is_absolute()) return fs::exists(name, ignored) ? name : of_windows();
  for (const SourceFile* f = &from; f; f = f->included_by.get())
    if (fs::exists(f->folder() / name, ignored)) return (f->folder() / name).lexically_normal();
  for (const fs::path& folder : folders)
    if (fs::exists(folder / name, ignored)) return (folder / name).lexically_normal();
  return of_windows();
}

ParsedScene parse_scene(const fs::path& file, const std::optional<std::string>& text,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Diagnostics& diagnostics) {
  auto source = std::make_shared<SourceFile>();
  source->path = fs::absolute(file).lexically_normal();
  source->shown = file.string();
  std::string content;
  if (text) {
    content = *text;
  } else {
    auto read = text_of(file, {source->shown, 0, 0}, "cannot read the scene file", diagnostics);
    if (!read) return {{}, {}, {source}, false};
    content = std::move(*read);
  }
  Parameters parameters(defines);
  Parser parser(parameters, diagnostics);
  if (!parser.parse(source, std::move(content), parser.scene.root)) {
    parser.scene.complete = false;
    // with a missing file no error is reported, since that file may use the definitions
  } else if (parser.scene.complete) {
    parameters.report_unused(source->shown, diagnostics);
  }
  return std::move(parser.scene);
}

}  // namespace aureole
