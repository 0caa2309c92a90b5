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

/// What is left of a text once it is read: nodes, and a builder that makes objects of them.
class Loading {
public:
  Loading(const std::filesystem::path& file, const std::optional<std::string>& text,
          const LoadOptions& options)
      : owned_(std::make_shared<OwnedContext>()),
        parsed(parse_scene(file, text, options.defines, owned_->diagnostics)) {
    owned_->context.diagnostics = &owned_->diagnostics;
    if (parsed.root.tag != "scene") stop_at_errors();
    upgrade(parsed.root, diagnostics());
    if (parsed.complete)
      apply_overrides(parsed.root, options, diagnostics());  // else what it looks for may be missing
    owned_->context.length_unit_m = length_unit(parsed.root, diagnostics());
    references = resolve(parsed, diagnostics());
  }

  /// Calls `build` with a builder of objects for `grid`.
  template <class Build>
  void build(const SpectralGrid& grid, const LoadOptions& options, const Build& build) {
    owned_->context.grid = grid;
    Builder builder(references, context(), diagnostics(), options.given);
    owned_->context.scene = &builder;
    build(builder);
    owned_->context.scene = nullptr;
    stop_at_errors();
    references.files.insert(references.files.end(), builder.files().begin(), builder.files().end());
  }

  void stop_at_errors() {
    if (diagnostics().has_errors()) throw ErrorList(in_file_order(diagnostics().errors(), parsed.files));
  }
  std::vector<std::string> notes() const { return in_file_order(owned_->diagnostics.notes(), parsed.files); }
  Diagnostics& diagnostics() { return owned_->diagnostics; }
  std::shared_ptr<const BuildContext> context() const { return {owned_, &owned_->context}; }

private:
  std::shared_ptr<OwnedContext> owned_;

public:
  ParsedScene parsed;
  References references;
};

LoadedScene load(const std::filesystem::path& file, const std::optional<std::string>& text,
                 const LoadOptions& options) {
  Loading loading(file, text, options);
  LoadedScene scene;
  scene.context = loading.context();
  scene.file = loading.parsed.files.front()->path;
  const ParsedScene& parsed = loading.parsed;
  loading.build(sensor_grid(loading.parsed.root, loading.references, loading.diagnostics()), options,
                [&](Builder& builder) {
                  SceneAssembly(scene, builder, loading.references, loading.diagnostics())
                      .run(parsed.root, parsed.complete);
                });
  scene.hash = content_hash(parsed.root, loading.references);
  scene.notes = loading.notes();
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

LoadedObject load_object_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                     const SpectralGrid& grid, const LoadOptions& options) {
  Loading loading(pretended_file, text, options);
  const Node* last = nullptr;
  for (const Node& child : loading.parsed.root.children)
    if (!is_property(child) && child.tag != "alias") last = &child;
  if (!last) {
    loading.stop_at_errors();
    throw Error(loading.parsed.root.where, "there is no object");
  }
  LoadedObject loaded;
  loading.build(grid, options, [&](Builder& builder) {
    for (const Node& child : loading.parsed.root.children)
      if (!is_property(child) && child.tag != "alias") {
        const Node* target = builder.target(child);
        const bool known = target && (!object_family(*target).empty() || is_unsupported_object(*target));
        if (target && !known) loading.diagnostics().error(unknown_element(*target));
        ObjectPtr object = known ? builder.object(child) : nullptr;
        if (&child == last && object) loaded.object = object, loaded.family = object_family(*target);
      }
  });
  loaded.context = loading.context();
  loaded.notes = loading.notes();
  return loaded;
}

}  // namespace aureole
