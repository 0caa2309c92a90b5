// SPDX-License-Identifier: Apache-2.0
#include "harness/properties_builder.h"

#include <pugixml.hpp>

#include "aureole/asset/asset.h"
#include "aureole/core/units.h"
#include "aureole/plugin/registry.h"

namespace aureole::testing {

namespace {

std::vector<double> numbers(std::string text) {
  for (char& c : text)
    if (c == ',' || c == ' ' || c == '\t' || c == '\n') c = ' ';
  std::vector<double> found;
  for (std::size_t at = text.find_first_not_of(' '); at != std::string::npos;) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    found.push_back(parse_number(std::string_view(text).substr(at, end - at)));
    at = text.find_first_not_of(' ', end);
  }
  return found;
}

SpectrumLiteral spectrum(const std::string& text) {
  SpectrumLiteral s;
  if (text.find(':') == std::string::npos) {
    s.value = parse_number(text);
    return s;
  }
  s.kind = SpectrumLiteral::Kind::points;
  std::string split = text;
  for (char& c : split)
    if (c == ':') c = ',';
  const std::vector<double> all = numbers(split);
  for (std::size_t i = 0; i + 1 < all.size(); i += 2) s.nm.push_back(all[i]), s.values.push_back(all[i + 1]);
  return s;
}

Transform transform(const pugi::xml_node& node) {
  Transform t;
  for (const pugi::xml_node step : node.children()) {
    const std::string name = step.name();
    const double fallback = name == "scale" ? step.attribute("value").as_double(1) : 0;
    const double x = step.attribute("x").as_double(fallback), y = step.attribute("y").as_double(fallback),
                 z = step.attribute("z").as_double(fallback);
    if (name == "scale")
      t = Transform::scale(x, y, z) * t;
    else if (name == "translate")
      t = Transform::translate(x, y, z) * t;
    else if (name == "rotate")
      t = Transform::rotate(x, y, z, step.attribute("angle").as_double()) * t;
    else if (name == "lookat") {
      const auto point = [&](const char* key) {
        const std::vector<double> v = numbers(step.attribute(key).as_string());
        return std::array<double, 3>{v.at(0), v.at(1), v.at(2)};
      };
      t = Transform::look_at(point("origin"), point("target"), point("up")) * t;
    } else
      throw Error("unknown transform step \"" + name + "\"");
  }
  return t;
}

ObjectPtr build_node(const pugi::xml_node& node, const std::shared_ptr<const BuildContext>& context,
                     const FileResolver& resolve);

const PluginInfo* plugin_of(const pugi::xml_node& node) {
  const FamilyInfo* family =
      Registry::instance().family_of_element(node.name(), !node.attribute("type").empty());
  return family ? Registry::instance().find(family->name, node.attribute("type").as_string()) : nullptr;
}

Properties read_node(const pugi::xml_node& node, const PluginInfo* plugin,
                     const std::shared_ptr<const BuildContext>& context, const FileResolver& resolve) {
  const SourceLocation where{"snippet", 1, int(node.offset_debug())};
  const PluginInfo* described = plugin ? plugin : plugin_of(node);
  Properties p(node.attribute("type").as_string(), node.attribute("id").as_string(), where, context, plugin);
  for (const pugi::xml_node child : node.children()) {
    const std::string name = child.attribute("name").as_string(),
                      value = child.attribute("value").as_string();
    const std::string kind = child.name();
    const SourceLocation at{"snippet", 1, int(child.offset_debug())};
    if (kind == "float")
      p.add(name, parse_number(value), at);
    else if (kind == "integer")
      p.add(name, std::int64_t(parse_number(value)), at);
    else if (kind == "boolean")
      p.add(name, value == "true", at);
    else if (kind == "string")
      p.add(name, resolve && described && described->names_file(name) ? resolve(value).string() : value, at);
    else if (kind == "rgb") {
      SpectrumLiteral s;
      s.kind = SpectrumLiteral::Kind::rgb;
      const std::vector<double> c = numbers(value);
      for (int i = 0; i < 3; ++i) s.rgb[i] = c.size() == 3 ? c[i] : c.at(0);
      p.add(name, s, at);
    } else if (kind == "spectrum" && !child.attribute("type"))
      p.add(name, spectrum(value), at);
    else if (kind == "transform")
      p.add(name, transform(child), at);
    else if (kind == "animation") {
      std::vector<KeyFrame> frames;
      for (const pugi::xml_node frame : child.children())
        frames.push_back({frame.attribute("time").as_double(), transform(frame)});
      p.add(name, Motion(std::move(frames)), at);
    } else if (kind == "point" || kind == "vector") {
      const std::vector<double> c = value.empty() ? std::vector<double>{child.attribute("x").as_double(),
                                                                        child.attribute("y").as_double(),
                                                                        child.attribute("z").as_double()}
                                                  : numbers(value);
      p.add(name, Vec3{float(c.at(0)), float(c.at(1)), float(c.at(2))}, at);
    } else
      p.add(name, build_node(child, context, resolve), at);
  }
  return p;
}

ObjectPtr build_node(const pugi::xml_node& node, const std::shared_ptr<const BuildContext>& context,
                     const FileResolver& resolve) {
  const PluginInfo* plugin = plugin_of(node);
  if (!plugin)
    throw Error("unknown " + std::string(node.name()) + " \"" + node.attribute("type").as_string() + "\"");
  const Properties p = read_node(node, plugin, context, resolve);
  ObjectPtr object = make_element(*plugin, p);
  Diagnostics unused;
  p.report_unused(unused);
  unused.throw_if_errors();
  return object;
}

pugi::xml_document parse(const std::string& xml) {
  pugi::xml_document document;
  const auto result = document.load_string(xml.c_str());
  if (!result) throw Error("snippet: " + std::string(result.description()));
  return document;
}

}  // namespace

std::shared_ptr<const BuildContext> make_context(double min_nm, double max_nm, Diagnostics* diagnostics) {
  auto context = std::make_shared<BuildContext>();
  context->grid = SpectralGrid::over(min_nm, max_nm);
  context->diagnostics = diagnostics;
  return context;
}

Properties read_properties(const std::string& xml, const std::shared_ptr<const BuildContext>& context,
                           const FileResolver& resolve) {
  return read_node(parse(xml).first_child(), nullptr, context, resolve);
}

ObjectPtr build_object(const std::string& xml, const std::shared_ptr<const BuildContext>& context,
                       const FileResolver& resolve) {
  return build_node(parse(xml).first_child(), context, resolve);
}

}  // namespace aureole::testing
