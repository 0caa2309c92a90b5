// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/asset.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <unordered_set>

#include "aureole/emitter/light.h"
#include "aureole/shape/mesh/file_materials.h"
#include "aureole/shape/mesh/open_edges.h"
#include "aureole/texture/texture.h"

namespace aureole {

namespace {

/// Returns the default BSDF, as in Mitsuba: diffuse of reflectance 0.5, or black on an emitter.
BsdfPtr default_bsdf(const Properties& properties, bool emits) {
  return make_default<Bsdf>(properties, "bsdf", {{"reflectance", emits ? 0.0 : 0.5}});
}

template <class T>
std::shared_ptr<T> only_child(const Properties& properties, const char* name) {
  const auto children = properties.get_children<T>(name);
  if (children.size() > 1)
    throw Error(properties.where(), "\"" + properties.type() + "\" has " + std::to_string(children.size()) +
                                        " " + name + " children; a shape has at most one");
  return children.empty() ? nullptr : children.front();
}

/// A texture that reads a mesh attribute, and the largest value allowed for its parameter.
struct ShownAttribute {
  const AttributeTexture* texture;
  double most;
};

/// Adds the textures below an object that read attributes.
void collect(const Object& object, std::unordered_set<const Object*>& seen,
             std::vector<ShownAttribute>& found) {
  for (const Properties::Entry& e : object.properties().entries()) {
    const auto* child = std::get_if<ObjectPtr>(&e.value);
    if (!child || !*child) continue;
    // The texture may have been found before, under a parameter that allows larger values.
    if (const auto* texture = dynamic_cast<const AttributeTexture*>(child->get()))
      found.push_back({texture, object.properties().most_expected(e.name)});
    if (seen.insert(child->get()).second) collect(**child, seen, found);
  }
}
std::vector<ShownAttribute> shown_attributes(const std::vector<const Object*>& objects) {
  std::unordered_set<const Object*> seen;
  std::vector<ShownAttribute> found;
  const auto has_children = [](const Object& object) {
    const auto& entries = object.properties().entries();
    return std::any_of(entries.begin(), entries.end(),
                       [](const auto& e) { return std::holds_alternative<ObjectPtr>(e.value); });
  };
  for (const Object* object : objects)
    if (object && has_children(*object) && seen.insert(object).second) collect(*object, seen, found);
  return found;
}

void check_attributes(const Shape& shape, const std::vector<ShownAttribute>& shown) {
  for (const auto& [texture, most] : shown) {
    const std::string& name = texture->attribute_name().text();
    const MeshAttribute* attribute = shape.attribute(texture->attribute_name());
    if (!attribute) throw shape.no_attribute(texture->properties().where(), name);
    texture->check(*attribute, most);
  }
}

/// Returns the area sampler of a shape. Errors of a shape that cannot be sampled at all are located at its
/// emitter or sensor, `sitting`.
std::shared_ptr<const AreaSampler> area_for(const Object& sitting, const ShapePtr& shape, AreaUse use,
                                            GeometrySource& source) {
  try {
    return source.area_sampler(shape, use);
  } catch (const Error& problem) {
    if (!problem.where().file.empty() || problem.where().line > 0) throw;
    throw Error(sitting.properties().where(), problem.message());
  }
}

/// Returns the materials of all readable libraries.
MtlLibrary read_libraries(const Properties& geometry, const FileMaterials& materials) {
  MtlLibrary all;
  for (const std::filesystem::path& path : materials.libraries) {
    try {
      all.merge(read_mtl(MeshFile(geometry, path)));
      if (geometry.context().scene) geometry.context().scene->add_file(path);
    } catch (const Error& problem) {
      geometry.note("filename", problem.message());
    }
  }
  return all;
}

/// Returns why the primitives of an asset together enclose no volume; empty if they do.
std::string opening_of(const std::vector<Primitive>& primitives) {
  if (primitives.size() == 1) return primitives[0].shape->opening();
  std::vector<const Mesh*> meshes;
  for (const Primitive& primitive : primitives)
    if (const auto* mesh = dynamic_cast<const Mesh*>(primitive.shape.get())) meshes.push_back(mesh);
  return open_edges_text(count_open_edges(meshes));
}

/// A shape with its BSDF, emitter and sensor.
class ShapeAsset final : public Asset {
public:
  ShapeAsset(const PluginInfo& plugin, const Properties& element, GeometrySource& source) : Asset(element) {
    build(plugin, element, source);
    check_media(element);
  }

private:
  void build(const PluginInfo& plugin, const Properties& element, GeometrySource& source);
  /// Notes a medium on one side of a surface with a gap. The scene warns if no other shape closes the gap
  /// (scene/scene_media.cpp).
  void check_media(const Properties& element);
  void note_losses(const Properties& element) const;
  void take_bssrdf(const Properties& element);
  /// Returns the element's parameters without BSDF, emitter, sensor and media.
  static std::shared_ptr<Properties> geometry_of(const Properties& element);
  /// Gives the shape its emitter and its sensor.
  void attach(GeometrySource& source);
  /// Divides a mesh into primitives by the BSDFs of the file's materials.
  void divide(const Properties& geometry, const FileMaterials& materials, const MtlLibrary& library,
              const MeshParts* kept, GeometrySource& source);
  BsdfPtr find_bsdf(const Properties& geometry, const MtlLibrary& library, const std::string& name,
                    GeometrySource& source) const;
  void add_primitive(const ShapePtr& shape, const BsdfPtr& bsdf) {
    Primitive primitive;
    primitive.shape = shape, primitive.bsdf = bsdf, primitive.element = shared_properties();
    primitive.media = media_;
    primitives_.push_back(std::move(primitive));
  }

  BsdfPtr bsdf_;  ///< BSDF of the element, or null
  std::shared_ptr<const Emitter> emitter_;
  SurfaceMedia media_;
};

std::shared_ptr<Properties> ShapeAsset::geometry_of(const Properties& element) {
  auto geometry = std::make_shared<Properties>(element.type(), element.id(), element.where(),
                                               element.shared_context(), element.plugin());
  geometry->reserve(element.entries().size());
  for (const Properties::Entry& e : element.entries()) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    const Object* o = object ? object->get() : nullptr;
    if (!dynamic_cast<const Bsdf*>(o) && !dynamic_cast<const Emitter*>(o) &&
        !dynamic_cast<const Sensor*>(o) && !dynamic_cast<const Medium*>(o) && !dynamic_cast<const Bssrdf*>(o))
      geometry->add(e.name, e.value, e.where);
  }
  return geometry;
}

/// Notes how much light rough interfaces around a scattering medium lose. Light hits such an interface many
/// times, so that a small loss at each hit becomes large.
void ShapeAsset::note_losses(const Properties& element) const {
  Diagnostics* diagnostics = element.context().diagnostics;
  // In a scene with errors, objects may lack their tables.
  if (!diagnostics || diagnostics->has_errors()) return;
  constexpr double kNoted = 0.003;
  const auto scatters = [](const MediumPtr& medium) { return medium && medium->scatters(); };
  for (const Primitive& primitive : primitives_) {
    const Bsdf& bsdf = *primitive.bsdf;
    double loss = media_.bssrdf ? bsdf.single_scattering_loss(false) : 0;
    if (has(bsdf.lobes(), Lobe::transmit)) {
      if (scatters(media_.inside)) loss = std::max(loss, bsdf.single_scattering_loss(true));
      if (scatters(media_.outside)) loss = std::max(loss, bsdf.single_scattering_loss(false));
    }
    if (!(loss >= kNoted)) continue;
    const std::string how = media_.bssrdf
                                ? "of the diffuse light that enters the body"
                                : "of the diffuse light in the medium each time that it hits the surface";
    diagnostics->note(
        bsdf.properties().where(),
        fmt::format("\"{}\" bounds matter that scatters, but its microfacets scatter light once and lose up "
                    "to {:.1f} % {}. A \"roughdielectric\" loses none with <boolean "
                    "name=\"energy_preserving\" value=\"true\"/>, which may also stand in <scene> for all "
                    "rough BSDFs; \"false\" keeps the loss without this note",
                    bsdf.properties().type(), 100 * loss, how));
  }
}

void ShapeAsset::check_media(const Properties& element) {
  note_losses(element);
  const bool bounds_medium = media_.given() && media_.outside != media_.inside,
             has_parts = primitives_.size() > 1;
  if (!has_parts && !media_.bssrdf && !bounds_medium && media_.priority == 0) return;
  const std::string opening = opening_of(primitives_);
  if (has_parts && opening.empty())
    for (Primitive& primitive : primitives_) primitive.is_part_of_closed = true;
  if (media_.bssrdf && !opening.empty())
    element.note("bssrdf", "the surface of this body is open (" + opening +
                               "): it counts as one that goes on below without end");
  if (!bounds_medium && media_.priority == 0) return;
  if (!bounds_medium) {
    if (!opening.empty())
      element.note("priority",
                   "the shape is open (" + opening + "): it has no inside that could overlap others");
    return;
  }
  if (opening.empty()) {
    for (Primitive& primitive : primitives_) primitive.encloses_medium = true;
    return;
  }
  element.note(media_.inside ? "interior" : "exterior",
               "the surface that bounds this medium is open (" + opening +
                   "): light that passes through the gap stays in the medium that it came from, unless other "
                   "shapes close it");
}

void ShapeAsset::take_bssrdf(const Properties& element) {
  media_.bssrdf = only_child<const Bssrdf>(element, "bssrdf");
  if (!media_.bssrdf) return;
  if (bsdf_)
    throw Error(bsdf_->properties().where(),
                "the shape has a bssrdf, which has the BSDF of its boundary: nest this one in the bssrdf");
  if (media_.inside)
    throw element.error(
        "interior",
        "the shape has a bssrdf, which stands for what is inside: nest this medium in the bssrdf");
  if (media_.priority != 0)
    throw element.error("priority", "a shape with a bssrdf has no inside that could overlap others");
  bsdf_ = media_.bssrdf->boundary();
}

void ShapeAsset::build(const PluginInfo& plugin, const Properties& element, GeometrySource& source) {
  emitter_ = only_child<Emitter>(element, "emitter");
  sensor_ = only_child<Sensor>(element, "sensor");
  bsdf_ = only_child<Bsdf>(element, "bsdf");
  if (plugin.documents("interior"))  // curves enclose no volume
    media_ = {element.get_object<Medium>("exterior"), element.get_object<Medium>("interior"),
              int(element.get_int("priority", 0, {0, 127}))};
  if (plugin.documents("bssrdf")) take_bssrdf(element);
  if (emitter_ && !emitter_->sits_on_shape())
    throw Error(emitter_->properties().where(), "an emitter of type \"" + emitter_->properties().type() +
                                                    "\" cannot sit on a shape; use \"area\"");

  const std::vector<ShownAttribute> shown =
      shown_attributes({media_.bssrdf ? static_cast<const Object*>(media_.bssrdf.get()) : bsdf_.get(),
                        emitter_.get(), sensor_.get()});
  const std::shared_ptr<Properties> shared_geometry = geometry_of(element);
  Properties& geometry = *shared_geometry;
  std::set<std::string> names;
  for (const ShownAttribute& s : shown) names.insert(s.texture->attribute_name().text());
  geometry.set_shown_attributes({names.begin(), names.end()});

  // A BSDF in the scene applies to the whole file (as in Mitsuba), and so do an emitter and a sensor.
  const bool is_bare = !bsdf_ && !emitter_ && !sensor_;
  std::optional<MtlLibrary> library;
  if (is_bare)
    if (const auto kept = source.parts(geometry)) {
      geometry.mark_all_read();
      element.take_reads(geometry);
      library = read_libraries(geometry, *kept->materials);
      divide(geometry, *kept->materials, *library, kept.get(), source);
      if (!primitives_.empty()) return;
    }
  ObjectPtr made;
  try {
    made = source.geometry(plugin, geometry);
  } catch (const Error&) {
    element.take_reads(geometry);  // the parameters read here include further problems
    throw;
  }
  const auto shape = std::dynamic_pointer_cast<const Shape>(made);
  if (!shape) throw std::logic_error("the plug-in \"" + plugin.name + "\" is registered in a wrong family");
  element.take_reads(geometry);
  add_primitive(shape, bsdf_ ? bsdf_ : default_bsdf(element, emitter_ != nullptr));
  primitives_[0].remarks = shape->remarks();
  check_attributes(*shape, shown);
  attach(source);
  const auto materials = is_bare ? shape->materials() : nullptr;
  if (!materials) return;
  if (!library) library = read_libraries(geometry, *materials);
  divide(geometry, *materials, *library, nullptr, source);
}

void ShapeAsset::attach(GeometrySource& source) {
  const ShapePtr& shape = primitives_[0].shape;
  if (emitter_) {
    primitives_[0].emitter = emitter_;
    primitives_[0].area = area_for(*emitter_, shape, AreaUse::emitter, source);
    Light light;
    light.emitter = emitter_.get(), light.shape = shape.get();
    light.area = primitives_[0].area.get(), light.surface_area = light.area->area();
    if (auto fitted = emitter_->fitted_to(light)) primitives_[0].emitter = std::move(fitted);
  }
  if (sensor_) {
    const AreaUse use = emitter_ ? AreaUse::emitter : AreaUse::sensor;
    sensor_area_ = std::make_shared<const ShapeArea>(area_for(*sensor_, shape, use, source));
    sensor_->check_shape(*sensor_area_);
  }
}

BsdfPtr ShapeAsset::find_bsdf(const Properties& geometry, const MtlLibrary& library, const std::string& name,
                              GeometrySource& source) const {
  if (SceneLookup* scene = geometry.context().scene)
    if (const auto found = std::dynamic_pointer_cast<const Bsdf>(scene->find("bsdf", name))) {
      if (!shown_attributes({found.get()}).empty())
        throw geometry.error(
            "filename", "the BSDF \"" + name + "\" shows an attribute of the mesh; an OBJ file has none");
      return found;
    }
  const auto found = library.find(name);
  if (found == library.end()) return nullptr;
  return source.material(geometry, name, found->second);
}

void ShapeAsset::divide(const Properties& geometry, const FileMaterials& materials, const MtlLibrary& library,
                        const MeshParts* kept, GeometrySource& source) {
  const BsdfPtr fallback = default_bsdf(properties(), false);
  std::vector<BsdfPtr> kinds;
  auto made = std::make_shared<MeshParts>();
  std::vector<bool> has_triangles;
  std::string unknown;
  for (std::size_t i = 0; i < materials.names.size(); ++i) {
    BsdfPtr bsdf = fallback;
    if (materials.used[i] && i > 0) {
      if (BsdfPtr found = find_bsdf(geometry, library, materials.names[i], source))
        bsdf = std::move(found);
      else
        unknown += (unknown.empty() ? "\"" : ", \"") + materials.names[i] + "\"";
    }
    const auto known = std::find(kinds.begin(), kinds.end(), bsdf);
    made->part_of.push_back(std::size_t(known - kinds.begin()));
    if (known == kinds.end()) kinds.push_back(bsdf), has_triangles.push_back(false);
    if (materials.used[i]) has_triangles[made->part_of.back()] = true;
  }
  const bool is_one = std::count(has_triangles.begin(), has_triangles.end(), true) < 2;
  if (kept && (is_one || kept->part_of != made->part_of)) return;

  std::vector<std::string> remarks = kept ? kept->remarks : primitives_[0].remarks;
  if (!unknown.empty())
    remarks.push_back("no BSDF has the id of a material, nor does an .mtl file define it: " + unknown +
                      "; the default is used");
  if (is_one) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (has_triangles[k]) primitives_[0].bsdf = kinds[k];
    primitives_[0].remarks = std::move(remarks);
    return;
  }
  if (!kept) {
    const ShapePtr whole = primitives_[0].shape;
    primitives_.clear();
    made->materials = whole->materials();
    made->shapes = whole->split(made->part_of);
    made->remarks = whole->remarks();
    source.keep(geometry, made);
    kept = made.get();
  }
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kept->shapes[k]) add_primitive(kept->shapes[k], kinds[k]);
  primitives_[0].remarks = std::move(remarks);
}

}  // namespace

std::shared_ptr<Asset> make_asset(const PluginInfo& plugin, const Properties& element,
                                  GeometrySource& source) {
  // Shapes with their own geometry document a `bsdf`; groups and instances do not.
  const auto asset = std::dynamic_pointer_cast<Asset>(
      plugin.documents("bsdf") ? element.make([&](const Properties& p) -> ObjectPtr {
        return std::make_shared<ShapeAsset>(plugin, p, source);
      })
                               : plugin.create(element));
  if (!asset) throw std::logic_error("the plug-in \"" + plugin.name + "\" is registered in a wrong family");
  return asset;
}

ObjectPtr make_element(const PluginInfo& plugin, const Properties& element) {
  if (plugin.family != "shape") return plugin.create(element);
  GeometrySource source;
  return make_asset(plugin, element, source);
}

}  // namespace aureole
