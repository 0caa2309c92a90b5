// SPDX-License-Identifier: Apache-2.0
#include "aureole/aperture/svg/svg.h"

#include <cmath>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "aureole/aperture/svg/svg_path.h"
#include "aureole/core/error.h"

namespace aureole {

namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t(1) << 24;
constexpr int kMaxDepth = 64;

std::string_view local_name(const pugi::xml_node& node) {
  std::string_view name = node.name();
  if (name.starts_with("svg:")) name.remove_prefix(4);
  return name;
}

double length(const pugi::xml_node& node, const char* name, double fallback = 0) {
  const pugi::xml_attribute a = node.attribute(name);
  return a ? parse_svg_length(a.value()) : fallback;
}

double size(const pugi::xml_node& node, const char* name) {
  const double v = length(node, name);
  if (v < 0) throw Error(std::string(name) + " must not be negative");
  return v;
}

/// Adds one of SVG's basic shapes; shapes without size are not drawn. Returns false for other elements.
bool add_shape(const pugi::xml_node& node, SvgOutline& outline) {
  const std::string_view name = local_name(node);
  if (name == "path")
    outline.add_path(node.attribute("d").value());
  else if (name == "polygon" || name == "polyline")
    outline.add_polygon(node.attribute("points").value());
  else if (name == "rect") {
    const double width = size(node, "width"), height = size(node, "height");
    // If only one radius is given, it is used for both.
    const double rx = size(node, node.attribute("rx") ? "rx" : "ry"),
                 ry = size(node, node.attribute("ry") ? "ry" : "rx");
    if (width > 0 && height > 0)
      outline.add_rectangle(length(node, "x"), length(node, "y"), width, height, rx, ry);
  } else if (name == "circle" || name == "ellipse") {
    const bool circle = name == "circle";
    const double rx = size(node, circle ? "r" : "rx"), ry = size(node, circle ? "r" : "ry");
    if (rx > 0 && ry > 0) outline.add_ellipse({length(node, "cx"), length(node, "cy")}, rx, ry);
  } else
    return false;
  return true;
}

void walk(const pugi::xml_node& parent, const SvgTransform& outer, int depth, SvgOutline& outline) {
  if (depth > kMaxDepth) throw Error("groups are nested more than " + std::to_string(kMaxDepth) + " deep");
  for (const pugi::xml_node node : parent.children()) {
    if (node.type() != pugi::node_element) continue;
    const std::string_view name = local_name(node);
    if (std::string_view(node.attribute("display").value()) == "none" ||
        std::string_view(node.attribute("style").value()).find("display:none") != std::string_view::npos)
      continue;
    const auto locate = [&](const Error& problem) {
      const char* id = node.attribute("id").value();
      return Error("<" + std::string(name) + ">" + (*id ? " \"" + std::string(id) + "\"" : "") + " at byte " +
                   std::to_string(node.offset_debug()) + ": " + problem.message());
    };
    SvgTransform transform = outer;
    try {
      if (name == "use" || name == "text" || name == "image")
        throw Error("is not supported: convert it to a path");
      transform = outer * SvgTransform::parse(node.attribute("transform").value());
      outline.set_transform(transform);
      if (add_shape(node, outline)) continue;
    } catch (const Error& problem) {
      throw locate(problem);
    }
    // Elements in defs, clip paths, markers and so on are not drawn directly.
    if (name == "svg" || name == "g" || name == "a") walk(node, transform, depth + 1, outline);
  }
}

}  // namespace

std::vector<optics::Ring> read_svg_rings(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::file_size(file, ignored) > kMaxBytes)
    throw Error(file.string() + " has more than " + std::to_string(kMaxBytes) + " bytes");
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_file(file.c_str());
  if (!result)
    throw Error(file.string() + " is not XML: " + result.description() + " at byte " +
                std::to_string(result.offset));
  if (local_name(document.document_element()) != "svg") throw Error(file.string() + " is not an SVG file");
  SvgOutline outline;
  try {
    walk(document, {}, 0, outline);
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
