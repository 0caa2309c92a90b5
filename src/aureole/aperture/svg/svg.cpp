// SPDX-License-Identifier: Apache-2.0
#include "aureole/aperture/svg/svg.h"

#include <cmath>
#include <cstdio>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "aureole/aperture/svg/svg_path.h"
#include "aureole/core/error.h"
#include "aureole/core/input_file.h"

namespace aureole {

namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t(1) << 24;
constexpr int kMaxDepth = 64;

std::string_view local_name(const pugi::xml_node& node) {
  std::string_view name = node.name();
  if (name.starts_with("svg:")) name.remove_prefix(4);
  return name;
}

/// Reads the shapes of a document; it holds the attributes of the root that shapes depend on.
class SvgReader {
public:
  SvgReader(const pugi::xml_document& document, SvgOutline& outline)
      : document_(document), outline_(outline) {
    const pugi::xml_node root = document.document_element();
    // Percentages are relative to the viewBox, or else to the size of the document.
    if (const pugi::xml_attribute box = root.attribute("viewBox")) {
      double x, y;
      if (std::sscanf(box.value(), "%lf%*[ ,]%lf%*[ ,]%lf%*[ ,]%lf", &x, &y, &width_, &height_) != 4)
        width_ = height_ = 0;
    } else if (std::string_view(root.attribute("width").value()).find('%') == std::string_view::npos) {
      if (const auto w = root.attribute("width")) width_ = parse_svg_length(w.value(), 0);
      if (const auto h = root.attribute("height")) height_ = parse_svg_length(h.value(), 0);
    }
  }
  void read() { walk(document_, {}, 0); }

private:
  enum class Along { x, y, both };
  double length(const pugi::xml_node& node, const char* name, Along along) const {
    const pugi::xml_attribute a = node.attribute(name);
    const double whole = along == Along::x   ? width_
                         : along == Along::y ? height_
                                             : std::sqrt(0.5 * (width_ * width_ + height_ * height_));
    return a ? parse_svg_length(a.value(), whole) : 0;
  }
  double size(const pugi::xml_node& node, const char* name, Along along) const {
    const double v = length(node, name, along);
    if (v < 0) throw Error(std::string(name) + " must not be negative");
    return v;
  }
  bool add_shape(const pugi::xml_node& node);
  void use(const pugi::xml_node& node, const SvgTransform& transform, int depth);
  void visit(const pugi::xml_node& node, const SvgTransform& outer, int depth);
  void walk(const pugi::xml_node& parent, const SvgTransform& transform, int depth);

  const pugi::xml_document& document_;
  SvgOutline& outline_;
  double width_ = 0, height_ = 0;
  int visited_ = 0;
};

/// Adds one of SVG's basic shapes; shapes without size are not drawn. Returns false for other elements.
bool SvgReader::add_shape(const pugi::xml_node& node) {
  const std::string_view name = local_name(node);
  if (name == "path")
    outline_.add_path(node.attribute("d").value());
  else if (name == "polygon" || name == "polyline")
    outline_.add_polygon(node.attribute("points").value());
  else if (name == "rect") {
    const double width = size(node, "width", Along::x), height = size(node, "height", Along::y);
    // If only one radius is given, it is used for both.
    const double rx = size(node, node.attribute("rx") ? "rx" : "ry", Along::x),
                 ry = size(node, node.attribute("ry") ? "ry" : "rx", Along::y);
    if (width > 0 && height > 0)
      outline_.add_rectangle(length(node, "x", Along::x), length(node, "y", Along::y), width, height, rx, ry);
  } else if (name == "circle" || name == "ellipse") {
    const bool circle = name == "circle";
    const double rx = size(node, circle ? "r" : "rx", circle ? Along::both : Along::x),
                 ry = size(node, circle ? "r" : "ry", circle ? Along::both : Along::y);
    if (rx > 0 && ry > 0)
      outline_.add_ellipse({length(node, "cx", Along::x), length(node, "cy", Along::y)}, rx, ry);
  } else
    return false;
  return true;
}

/// Draws the element that a <use> names, moved by its x and y.
void SvgReader::use(const pugi::xml_node& node, const SvgTransform& transform, int depth) {
  const pugi::xml_attribute plain = node.attribute("href");
  const std::string_view href = plain ? plain.value() : node.attribute("xlink:href").value();
  if (!href.starts_with('#')) throw Error("names no element of this file: its href must be \"#\" and an id");
  const std::string id(href.substr(1));
  const pugi::xml_node target =
      document_.find_node([&](const pugi::xml_node& n) { return id == n.attribute("id").value(); });
  if (!target) throw Error("no element has the id \"" + id + "\"");
  const SvgTransform moved =
      transform * SvgTransform{1, 0, 0, 1, length(node, "x", Along::x), length(node, "y", Along::y)};
  if (local_name(target) == "symbol" || local_name(target) == "svg") {
    if (target.attribute("viewBox"))
      throw Error("<" + std::string(local_name(target)) +
                  "> with a viewBox is not supported here: convert it to a path");
    walk(target, moved, depth + 1);
  } else {
    visit(target, moved, depth + 1);
  }
}

void SvgReader::visit(const pugi::xml_node& node, const SvgTransform& outer, int depth) {
  constexpr int kMaxVisited = 100000;
  if (depth > kMaxDepth)
    throw Error("groups and uses are nested more than " + std::to_string(kMaxDepth) + " deep");
  if (++visited_ > kMaxVisited)
    throw Error("more than " + std::to_string(kMaxVisited) + " elements are drawn, by uses within uses");
  const std::string_view name = local_name(node);
  if (std::string_view(node.attribute("display").value()) == "none" ||
      std::string_view(node.attribute("style").value()).find("display:none") != std::string_view::npos)
    return;
  SvgTransform transform = outer;
  try {
    if (name == "text" || name == "image") throw Error("is not supported: convert it to a path");
    transform = outer * SvgTransform::parse(node.attribute("transform").value());
    outline_.set_transform(transform);
    if (add_shape(node)) return;
    if (name == "use") return use(node, transform, depth);
  } catch (const Error& problem) {
    if (problem.message().starts_with('<')) throw;  // the message already names the element within a <use>
    const char* id = node.attribute("id").value();
    throw Error("<" + std::string(name) + ">" + (*id ? " \"" + std::string(id) + "\"" : "") + " at byte " +
                std::to_string(node.offset_debug()) + ": " + problem.message());
  }
  // Elements in defs, clip paths, markers and so on are not drawn directly.
  if (name == "svg" || name == "g" || name == "a") walk(node, transform, depth + 1);
}

void SvgReader::walk(const pugi::xml_node& parent, const SvgTransform& transform, int depth) {
  for (const pugi::xml_node node : parent.children())
    if (node.type() == pugi::node_element) visit(node, transform, depth);
}

}  // namespace

std::vector<optics::Ring> read_svg_rings(const std::filesystem::path& file) {
  std::string text;
  try {
    text = read_text_file(file, kMaxBytes);
  } catch (const Error& problem) {
    // without a location, so that the error is located at the parameter that names the file
    throw Error(problem.what());
  }
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer_inplace(text.data(), text.size());
  if (!result)
    throw Error(file.string() + " is not XML: " + result.description() + " at byte " +
                std::to_string(result.offset));
  if (local_name(document.document_element()) != "svg") throw Error(file.string() + " is not an SVG file");
  SvgOutline outline;
  try {
    SvgReader(document, outline).read();
    std::vector<optics::Ring> rings = outline.flattened(kSvgTolerance);
    // Subpaths of two points enclose no area.
    std::erase_if(rings, [](const optics::Ring& r) { return r.size() < 3; });
    if (rings.empty()) throw Error("has no path, polygon, rect, circle or ellipse with an inside");
    return rings;
  } catch (const Error& problem) {
    throw Error(file.string() + ": " + problem.message());
  }
}

}  // namespace aureole
