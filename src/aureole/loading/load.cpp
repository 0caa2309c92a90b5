// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/load.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>

#include "aureole/core/parallel.h"
#include "aureole/core/units.h"
#include "aureole/loading/assembly.h"
#include "aureole/loading/builder.h"
#include "aureole/loading/node_notes.h"
#include "aureole/loading/order.h"
#include "aureole/loading/overrides.h"
#include "aureole/loading/sensor_grid.h"
#include "aureole/loading/stages.h"
#include "aureole/loading/upgrade.h"
#include "aureole/loading/values.h"
#include "aureole/loading/wanted_objects.h"
#include "aureole/plugin/late_notes.h"

namespace aureole {

namespace {

/// The context points to the diagnostics until the file is loaded.
struct OwnedContext {
  BuildContext context;
  Diagnostics diagnostics;
};

/// Returns a length unit such as "mm" or "2.5mm" in metres.
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

/// Returns the scene's default of the parameter `energy_preserving` of rough BSDFs; empty if it has none.
std::optional<bool> energy_preserving(const Node& root, Diagnostics& diagnostics) {
  std::optional<bool> chosen;
  const Node* first = nullptr;
  for (const Node& child : root.children) {
    if (!is_property(child) || child.get("name") != "energy_preserving") continue;
    if (first)
      diagnostics.error(child.where, "energy_preserving is given twice: first at " + first->where.str());
    first = &child;
    const auto value = property_value(child, diagnostics);
    if (!value) continue;
    if (const bool* b = std::get_if<bool>(&*value))
      chosen = *b;
    else
      diagnostics.error(
          child.where,
          "energy_preserving is true or false: write <boolean name=\"energy_preserving\" value=\"true\"/>");
  }
  return chosen;
}

/// An object of a file with its id, or an alias, and its element.
struct FoundObject {
  std::string id;
  ObjectPtr object;
  const Node* node;
};

/// Upgraded nodes, with the state needed to build objects from them.
class Loading {
public:
  Loading(ParsedScene& parsed, std::shared_ptr<OwnedContext> owned)
      : owned_(std::move(owned)), parsed_(parsed), references(parsed, owned_->diagnostics) {
    owned_->context.diagnostics = &owned_->diagnostics;
    owned_->context.length_unit_m = length_unit(parsed.root, diagnostics());
    owned_->context.energy_preserving = energy_preserving(parsed.root, diagnostics());
  }

  /// Calls `build` with a Builder whose spectra are tabulated on `grid`.
  template <class Build>
  void build(const SpectralGrid& grid, const LoadOptions& options, ObjectPool* pool, const Build& build) {
    owned_->context.grid = grid;
    // stops, since an invalid grid, caused by errors, would empty the pool
    if (pool && !pool->empty()) stop_at_errors();
    if (pool) pool->begin(owned_->context);
    Builder builder(references, context(), diagnostics(), options.given, options.progress, pool);
    owned_->context.models = pool ? pool->models() : std::make_shared<ModelCache>();
    owned_->context.tables = options.tables;
    {
      // Resets the context's pointer to the builder, whose lifetime ends first, also when loading is
      // cancelled.
      struct Lookup {
        BuildContext& context;
        ~Lookup() { context.scene = nullptr; }
      } const lookup{owned_->context};
      owned_->context.scene = &builder;
      build(builder);
    }
    stop_at_errors();
    references.files.insert(references.files.end(), builder.files().begin(), builder.files().end());
    if (options.check_files) options.check_files(all_files());
  }

  void stop_at_errors() const {
    if (owned_->diagnostics.has_errors())
      throw ErrorList(in_file_order(owned_->diagnostics.errors(), parsed_.files));
  }
  /// Returns the notes of all objects and ends their collection.
  std::vector<std::string> take_notes() {
    owned_->context.diagnostics = closed_diagnostics();
    return in_file_order(owned_->diagnostics.notes(), parsed_.files);
  }
  /// As `take_notes`, with those alone that are about wanted objects, or about no object.
  std::vector<std::string> take_notes_about(const std::vector<FoundObject>& found,
                                            const IsWanted& is_wanted) {
    owned_->context.diagnostics = closed_diagnostics();
    NodeNotes notes(parsed_.root, references, owned_->diagnostics.notes());
    for (const FoundObject& f : found)
      if (is_wanted(f.id, f.object)) notes.select(*f.node);
    return in_file_order(notes.selected(), parsed_.files);
  }
  Diagnostics& diagnostics() { return owned_->diagnostics; }
  std::shared_ptr<const BuildContext> context() const { return {owned_, &owned_->context}; }

private:
  /// The scene files and the files that they name.
  std::vector<std::filesystem::path> all_files() const {
    std::vector<std::filesystem::path> all = references.files;
    for (const SourceFilePtr& file : parsed_.files) all.push_back(file->path);
    return all;
  }

  std::shared_ptr<OwnedContext> owned_;
  ParsedScene& parsed_;

public:
  References references;
};

/// Parses text into upgraded nodes, ready for building objects.
ParsedScene read_nodes(const std::filesystem::path& file, const std::optional<std::string>& text,
                       const LoadOptions& options, Diagnostics& diagnostics) {
  ParsedScene parsed = parse_scene(file, text, options.defines, diagnostics);
  if (parsed.root.tag != "scene" && diagnostics.has_errors())
    throw ErrorList(in_file_order(diagnostics.errors(), parsed.files));
  upgrade(parsed.root, diagnostics);
  return parsed;
}

/// Parses text into the upgraded nodes of a whole scene, with the overrides of the command line.
ParsedScene read_scene_nodes(const std::filesystem::path& file, const std::optional<std::string>& text,
                             const LoadOptions& options, Diagnostics& diagnostics) {
  ParsedScene parsed = read_nodes(file, text, options, diagnostics);
  if (parsed.complete)
    apply_overrides(parsed.root, options, diagnostics);  // skipped if a file is missing: it may contain the
                                                         // objects to override
  return parsed;
}

/// Adds the objects of the children of `parent` and of their children to `found`.
void collect_objects(const Node& parent, const References& references, const NodeTable<ObjectPtr>& built,
                     std::vector<FoundObject>& found) {
  for (const Node& child : parent.children) {
    const bool alias = child.tag == "alias";
    const std::string id = child.get(alias ? "as" : "id");
    const Node* const node = alias ? references.ids.find(id).node : &child;
    if (node && built[*node]) found.push_back({id, built[*node], node});
    collect_objects(child, references, built, found);
  }
}

LoadedParts build_parts(ParsedScene& parsed, const std::shared_ptr<OwnedContext>& owned,
                        const LoadOptions& options, ObjectPool* pool, OpenedParts* opened) {
  Loading loading(parsed, owned);
  LoadedParts loaded;
  std::uint64_t elements = 0;
  const auto build = [&] {
    loading.build(sensor_grid(loading.references, loading.diagnostics()), options, pool,
                  [&](Builder& builder) {
                    SceneAssembly assembly(builder, loading.references, loading.diagnostics());
                    assembly.run(parsed.root, parsed.complete);
                    loaded.parts = std::move(assembly.parts);
                    loaded.integrator = std::move(assembly.integrator);
                    if (opened) opened->objects = builder.take_built();
                  });
  };
  run_together(build, [&] { elements = elements_hash(parsed.root, loading.references); });
  loaded.parts.context = loading.context();
  loaded.file = parsed.files.front()->path;
  loaded.hash = content_hash(elements, loading.references);
  loaded.files = loading.references.files;
  std::sort(loaded.files.begin(), loaded.files.end());
  loaded.files.erase(std::unique(loaded.files.begin(), loaded.files.end()), loaded.files.end());
  loaded.notes = loading.take_notes();
  return loaded;
}

}  // namespace

LoadedParts load_parts(const std::filesystem::path& file, const std::optional<std::string>& text,
                       const LoadOptions& options) {
  const auto owned = std::make_shared<OwnedContext>();
  ParsedScene parsed = read_scene_nodes(file, text, options, owned->diagnostics);
  return build_parts(parsed, owned, options, nullptr, nullptr);
}

LoadedScene make_scene(LoadedParts loaded, const Scene* previous) {
  LoadedScene made;
  made.integrator = std::dynamic_pointer_cast<const Integrator>(loaded.integrator);
  if (loaded.integrator && !made.integrator)
    throw std::logic_error("the plug-in \"" + loaded.integrator->properties().type() +
                           "\" is registered in a wrong family");
  if (made.integrator) {
    const SceneNeeds needs = made.integrator->needs();
    loaded.parts.diffraction = needs.diffraction, loaded.parts.adds_media = needs.adds_media;
  }
  try {
    made.scene = std::make_shared<const Scene>(std::move(loaded.parts), previous);
  } catch (const BeamWidthError& e) {
    throw made.integrator->properties().error("beam_width", e.message());
  }
  made.hash = loaded.hash;
  made.files = std::move(loaded.files);
  made.notes = std::move(loaded.notes);
  made.notes.insert(made.notes.end(), made.scene->notes().begin(), made.scene->notes().end());
  if (made.integrator)
    for (std::string& note : made.integrator->scene_notes(*made.scene)) made.notes.push_back(std::move(note));
  made.file = std::move(loaded.file);
  return made;
}

LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options) {
  return make_scene(load_parts(file, {}, options));
}

LoadedScene load_scene_from_string(const std::string& text, const std::filesystem::path& pretended_file,
                                   const LoadOptions& options) {
  return make_scene(load_parts(pretended_file, text, options));
}

LoadedObjects load_objects(const std::filesystem::path& file, const LoadOptions& options) {
  return load_wanted_objects(file, options, {});
}

LoadedObjects load_wanted_objects(const std::filesystem::path& file, const LoadOptions& options,
                                  const IsWanted& is_wanted) {
  const auto owned = std::make_shared<OwnedContext>();
  ParsedScene parsed = read_scene_nodes(file, {}, options, owned->diagnostics);
  Loading loading(parsed, owned);
  std::vector<FoundObject> found;
  loading.build(sensor_grid(loading.references, loading.diagnostics()), options, nullptr,
                [&](Builder& builder) {
                  SceneAssembly(builder, loading.references, loading.diagnostics()).run(parsed.root, false);
                  collect_objects(parsed.root, loading.references, builder.built(), found);
                });
  LoadedObjects loaded;
  loaded.context = loading.context();
  loaded.notes = is_wanted ? loading.take_notes_about(found, is_wanted) : loading.take_notes();
  for (FoundObject& f : found) loaded.objects.emplace_back(std::move(f.id), std::move(f.object));
  return loaded;
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
      if (object_family(*target).empty()) {
        loading.diagnostics().error(unknown_element(*target));
        continue;
      }
      ObjectPtr object = builder.object(child);
      if (&child == &*last) loaded.object = object, loaded.family = object_family(*target);
    }
  });
  loaded.context = loading.context();
  loaded.notes = loading.take_notes();
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

OpenedParts build_opened(ParsedScene& parsed, const LoadOptions& options, ObjectPool& pool) {
  OpenedParts opened;
  static_cast<LoadedParts&>(opened) =
      build_parts(parsed, std::make_shared<OwnedContext>(), options, &pool, &opened);
  return opened;
}

void complete(ParsedScene& parsed) {
  Diagnostics diagnostics;
  apply_overrides(parsed.root, {}, diagnostics);
  if (diagnostics.has_errors()) throw ErrorList(in_file_order(diagnostics.errors(), parsed.files));
}

}  // namespace aureole
