// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/build.h"

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "aureole/core/units.h"
#include "aureole/emitter/emitter.h"
#include "aureole/scene/aliases.h"
#include "aureole/scene/builder.h"
#include "aureole/scene/opened_scene.h"
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
    if (child.tag == "given") {  // for references to it
      builder_.object(child);
      return;
    }
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

/// Nodes on their way to objects.
class Loading {
public:
  Loading(ParsedScene& parsed, std::shared_ptr<OwnedContext> owned)
      : owned_(std::move(owned)), parsed_(parsed) {
    owned_->context.diagnostics = &owned_->diagnostics;
    owned_->context.length_unit_m = length_unit(parsed.root, diagnostics());
    references = resolve(parsed, diagnostics());
  }

  /// Calls `build` with a builder of objects for `grid`.
  template <class Build>
  void build(const SpectralGrid& grid, const LoadOptions& options, ObjectPool* pool, const Build& build) {
    owned_->context.grid = grid;
    if (pool && !pool->empty()) stop_at_errors();  // the grid may be none: the pool would be emptied for it
    if (pool) pool->begin(owned_->context);
    Builder builder(references, context(), diagnostics(), options.given, pool);
    owned_->context.scene = &builder;
    build(builder);
    owned_->context.scene = nullptr;
    stop_at_errors();
    adoptions = builder.take_adoptions();
    references.files.insert(references.files.end(), builder.files().begin(), builder.files().end());
  }

  void stop_at_errors() const {
    if (owned_->diagnostics.has_errors())
      throw ErrorList(in_file_order(owned_->diagnostics.errors(), parsed_.files));
  }
  std::vector<std::string> notes() const { return in_file_order(owned_->diagnostics.notes(), parsed_.files); }
  Diagnostics& diagnostics() { return owned_->diagnostics; }
  std::shared_ptr<const BuildContext> context() const { return {owned_, &owned_->context}; }

private:
  std::shared_ptr<OwnedContext> owned_;
  ParsedScene& parsed_;

public:
  References references;
  std::vector<Adoption> adoptions;
};

/// Text -> nodes as they are built from.
ParsedScene read_nodes(const std::filesystem::path& file, const std::optional<std::string>& text,
                       const LoadOptions& options, Diagnostics& diagnostics) {
  ParsedScene parsed = parse_scene(file, text, options.defines, diagnostics);
  if (parsed.root.tag != "scene" && diagnostics.has_errors())
    throw ErrorList(in_file_order(diagnostics.errors(), parsed.files));
  upgrade(parsed.root, diagnostics);
  return parsed;
}

/// The same for whole scenes.
ParsedScene read_scene_nodes(const std::filesystem::path& file, const std::optional<std::string>& text,
                             const LoadOptions& options, Diagnostics& diagnostics) {
  ParsedScene parsed = read_nodes(file, text, options, diagnostics);
  if (parsed.complete)
    apply_overrides(parsed.root, options, diagnostics);  // else what it looks for may be missing
  return parsed;
}

LoadedScene build_scene(ParsedScene& parsed, const std::shared_ptr<OwnedContext>& owned,
                        const LoadOptions& options, ObjectPool* pool, OpenedScene* opened) {
  Loading loading(parsed, owned);
  LoadedScene scene;
  scene.context = loading.context();
  scene.file = parsed.files.front()->path;
  loading.build(sensor_grid(parsed.root, loading.references, loading.diagnostics()), options, pool,
                [&](Builder& builder) {
                  SceneAssembly(scene, builder, loading.references, loading.diagnostics())
                      .run(parsed.root, parsed.complete);
                  if (opened) opened->objects = builder.built();
                });
  scene.hash = content_hash(parsed.root, loading.references);
  scene.notes = loading.notes();
  if (opened) opened->adoptions = std::move(loading.adoptions);
  return scene;
}

LoadedScene load(const std::filesystem::path& file, const std::optional<std::string>& text,
                 const LoadOptions& options) {
  const auto owned = std::make_shared<OwnedContext>();
  ParsedScene parsed = read_scene_nodes(file, text, options, owned->diagnostics);
  return build_scene(parsed, owned, options, nullptr, nullptr);
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
  const auto owned = std::make_shared<OwnedContext>();
  ParsedScene parsed = read_nodes(pretended_file, text, options, owned->diagnostics);
  Loading loading(parsed, owned);
  const auto is_object = [](const Node& node) { return !is_property(node) && node.tag != "alias"; };
  const auto last = std::find_if(parsed.root.children.rbegin(), parsed.root.children.rend(), is_object);
  if (last == parsed.root.children.rend()) {
    loading.stop_at_errors();
    throw Error(parsed.root.where, "there is no object");
  }
  LoadedObject loaded;
  loading.build(grid, options, nullptr, [&](Builder& builder) {
    for (const Node& child : parsed.root.children) {
      const Node* target = is_object(child) ? builder.target(child) : nullptr;
      if (!target) continue;
      if (object_family(*target).empty() && !is_unsupported_object(*target)) {
        loading.diagnostics().error(unknown_element(*target));
        continue;
      }
      ObjectPtr object = builder.object(child);
      if (&child == &*last) loaded.object = object, loaded.family = object_family(*target);
    }
  });
  loaded.context = loading.context();
  loaded.notes = loading.notes();
  return loaded;
}

std::unique_ptr<ParsedScene> open_scene(const std::filesystem::path& file,
                                        const std::optional<std::string>& text, const LoadOptions& options,
                                        std::vector<std::string>& notes) {
  Diagnostics diagnostics;
  auto parsed = std::make_unique<ParsedScene>(read_scene_nodes(file, text, options, diagnostics));
  if (diagnostics.has_errors()) throw ErrorList(in_file_order(diagnostics.errors(), parsed->files));
  notes = in_file_order(diagnostics.notes(), parsed->files);
  return parsed;
}

OpenedScene build_opened(ParsedScene& parsed, const LoadOptions& options, ObjectPool& pool) {
  OpenedScene opened;
  opened.scene = build_scene(parsed, std::make_shared<OwnedContext>(), options, &pool, &opened);
  return opened;
}

void complete(ParsedScene& parsed) {
  Diagnostics diagnostics;
  apply_overrides(parsed.root, {}, diagnostics);
  if (diagnostics.has_errors()) throw ErrorList(in_file_order(diagnostics.errors(), parsed.files));
}

}  // namespace aureole
