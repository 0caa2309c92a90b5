// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/build.h"

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "aureole/core/units.h"
#include "aureole/emitter/emitter.h"
#include "aureole/scene/aliases.h"
#include "aureole/scene/builder.h"
#include "aureole/scene/order.h"
#include "aureole/scene/overrides.h"
#include "aureole/scene/sensor_grid.h"
#include "aureole/scene/upgrade.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/shape.h"

namespace aureole {

namespace {

/// Objects may add notes for as long as they live, so that the messages must live as long as the context.
struct OwnedContext {
  BuildContext context;
  Diagnostics diagnostics;
};

/// "mm" or "2.5mm" in metres.
double parse_length_unit(const Node& node) {
  if (node.tag != "string")
    throw Error(node.where, "length_unit needs a unit: write <string name=\"length_unit\" value=\"mm\"/>");
  const std::string text = node.get("value");
  const bool starts_with_number = !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) ||
                                                    text[0] == '.' || text[0] == '-' || text[0] == '+');
  const double unit = parse_length_m(starts_with_number ? text : "1" + text);
  if (!(unit > 0)) throw Error("must be positive, got \"" + text + "\"");
  return unit;
}

double length_unit(const Node& root, Diagnostics& diagnostics) {
  double unit = 1;
  const Node* first = nullptr;
  for (const Node& child : root.children) {
    if (!is_property(child) || child.get("name") != "length_unit") continue;
    if (first) diagnostics.error(child.where, "length_unit is given twice: first at " + first->where.str());
    first = &child;
    if (!check_attributes(child, {"name", "value"}, {}, diagnostics) || child.find("value")->failed) continue;
    try {
      unit = parse_length_unit(child);
    } catch (const Error& e) {
      diagnostics.error(child.find("value")->where, "length_unit: " + e.message());
    }
  }
  return unit;
}

/// The children of <scene>, built in order.
class SceneAssembly {
public:
  SceneAssembly(LoadedScene& scene, Builder& builder, const References& references, Diagnostics& diagnostics)
      : scene_(scene), builder_(builder), references_(references), diagnostics_(diagnostics) {}

  void run(const Node& root, bool complete) {
    check_attributes(root, {}, {"version", "id", "name", "type"}, diagnostics_);
    for (const Node& child : root.children) add(child);
    // A shape that could not be built may hold the sensor.
    if (!sensor_ && complete && !shape_failed_) diagnostics_.error(root.where, "the scene has no <sensor>");
  }

private:
  void add(const Node& child) {
    if (is_property(child)) {
      if (child.get("name") != "length_unit")
        diagnostics_.error(child.where, "unknown parameter \"" + child.get("name") + "\" of the scene" +
                                            did_you_mean(child.get("name"), {"length_unit"}));
      return;
    }
    if (child.tag == "alias") return;
    const Node* node = builder_.target(child);
    if (!node) return;  // a bad <ref>, reported
    const std::string family = object_family(*node);
    if (family.empty() && !is_unsupported_object(*node)) {
      diagnostics_.error(unknown_element(*node));
    } else if (family == "sensor" && sensor_) {
      if (node != sensor_ && !references_.nested.contains(node))
        diagnostics_.note(node->where, "only the first sensor is used; this one is ignored");
    } else if (family == "integrator" && integrator_) {
      if (node != integrator_)
        diagnostics_.error(node->where,
                           "a scene has one integrator: the first is at " + integrator_->where.str());
    } else {
      keep(*node, family, builder_.object(*node));
    }
  }

  void keep(const Node& node, const std::string& family, const ObjectPtr& object) {
    if (family == "sensor") sensor_ = &node, scene_.sensor = object;
    if (family == "integrator") integrator_ = &node, scene_.integrator = object;
    if (!object) {
      shape_failed_ |= family == "shape";
      return;
    }
    if (family == "shape") {
      append_shape(node, object);
      take_sensor(node, dynamic_cast<const Shape&>(*object));
    }
    if (family != "emitter" || references_.nested.contains(&node)) return;
    if (is_surface_emitter(node.get("type")))
      diagnostics_.note(node.where, "no shape uses this emitter: it has no effect");
    else
      append(scene_.emitters, object);
  }

  /// The sensor that sits on a shape is one of the scene's.
  void take_sensor(const Node& node, const Shape& shape) {
    if (!shape.sensor()) return;
    if (!sensor_)
      sensor_ = &node, scene_.sensor = shape.sensor();
    else if (scene_.sensor != shape.sensor() && !references_.nested.contains(&node))
      diagnostics_.note(shape.sensor()->properties().where(),
                        "only the first sensor is used; this one is ignored");
  }

  /// The shape, or what stands for it in the scene.
  void append_shape(const Node& node, const ObjectPtr& object) {
    const auto* shape = dynamic_cast<const Shape*>(object.get());
    if (!shape || !shape->parts()) return append(scene_.shapes, object);
    if (shape->parts()->empty() && !references_.nested.contains(&node))
      diagnostics_.note(node.where, "nothing of this " + node.get("type") + " is rendered: it has no effect");
    for (const auto& part : *shape->parts()) append(scene_.shapes, part);
  }

  template <class T>
  void append(std::vector<std::shared_ptr<T>>& list, const ObjectPtr& object) {
    auto typed = std::dynamic_pointer_cast<T>(object);
    if (!typed)
      throw std::logic_error("the plug-in \"" + object->properties().type() +
                             "\" is registered in a wrong family");
    if (appended_.insert(object.get()).second) list.push_back(std::move(typed));
  }

  LoadedScene& scene_;
  Builder& builder_;
  const References& references_;
  Diagnostics& diagnostics_;
  const Node *sensor_ = nullptr, *integrator_ = nullptr;
  bool shape_failed_ = false;
  std::unordered_set<const Object*> appended_;
};

LoadedScene load(const std::filesystem::path& file, const std::optional<std::string>& text,
                 const LoadOptions& options) {
  const auto owned = std::make_shared<OwnedContext>();
  Diagnostics& diagnostics = owned->diagnostics;
  owned->context.diagnostics = &diagnostics;

  ParsedScene parsed = parse_scene(file, text, options.defines, diagnostics);
  const auto stop_at_errors = [&] {
    if (diagnostics.has_errors()) throw ErrorList(in_file_order(diagnostics.errors(), parsed.files));
  };
  if (parsed.root.tag != "scene") stop_at_errors();
  upgrade(parsed.root, diagnostics);
  if (parsed.complete)
    apply_overrides(parsed.root, options, diagnostics);  // else what it looks for may be missing
  owned->context.length_unit_m = length_unit(parsed.root, diagnostics);
  References references = resolve(parsed, diagnostics);
  owned->context.grid = sensor_grid(parsed.root, references, diagnostics);

  LoadedScene scene;
  scene.context = std::shared_ptr<const BuildContext>(owned, &owned->context);
  scene.file = parsed.files.front()->path;
  Builder builder(references, scene.context, diagnostics);
  owned->context.scene = &builder;
  SceneAssembly(scene, builder, references, diagnostics).run(parsed.root, parsed.complete);
  owned->context.scene = nullptr;
  stop_at_errors();
  references.files.insert(references.files.end(), builder.files().begin(), builder.files().end());
  scene.hash = content_hash(parsed.root, references);
  scene.notes = in_file_order(diagnostics.notes(), parsed.files);
  return scene;
}

}  // namespace

LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options) {
  return load(file, {}, options);
}

LoadedScene load_scene_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                   const LoadOptions& options) {
  return load(pretended_file, text, options);
}

}  // namespace aureole
