// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/specimen.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "aureole/asset/asset.h"
#include "aureole/core/error.h"
#include "aureole/instrument/find_object.h"
#include "aureole/shape/mesh/mesh.h"

namespace aureole {
namespace {

template <class T>
ObjectPtr as_given(const std::shared_ptr<const T>& object) {
  return std::const_pointer_cast<T>(object);
}

/// The smallest extent of a box [scene units].
double smallest_extent(const Bounds3& box) {
  const Vec3 size = box.diagonal();
  return double(std::min({size.x, size.y, size.z}));
}

/// Whether a shape lies in one plane, however that plane is turned, to 1e-4 of its size.
bool is_flat(const Shape& shape) {
  const auto* mesh = dynamic_cast<const Mesh*>(&shape);
  if (!mesh) return shape.properties().type() == "disk";
  const auto& p = mesh->data().positions;
  Vec3 normal;
  float largest = 0;
  for (const TriangleIndices& t : mesh->data().triangles) {
    const Vec3 n = cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
    if (length(n) > largest) normal = n, largest = length(n);
  }
  if (!(largest > 0)) return true;
  normal = normal / largest;
  float depth = 0, size = 0;
  for (const Vec3& v : p)
    depth = std::max(depth, std::abs(dot(v - p[0], normal))), size = std::max(size, length(v - p[0]));
  return depth < 1e-4f * size;
}

}  // namespace

bool Specimen::is_refracting() const {
  return is_slab() && bsdf && !bsdf->is_smooth() && !has(bsdf->lobes(), Lobe::null);
}

bool Specimen::is_translucent() const {
  if (is_slab()) return true;
  if (!bsdf) return element.find("\"null\"") != element.npos;
  return has(bsdf->lobes(), Lobe::transmit) || has(bsdf->lobes(), Lobe::null);
}

double Specimen::index_behind(const SpectralGrid& grid) const {
  Spectrum n(1.f), outside(1.f);
  const Wavelengths w = Wavelengths::at(grid, float(0.5 * (grid.min_nm + grid.max_nm)));
  if (is_slab() || !bsdf || !is_translucent() || !bsdf->interior_index(w, n)) return 1;
  return double(bsdf->exterior_index(w, outside) ? n[0] / outside[0] : n[0]);
}

LoadedSpecimen load_specimen(const std::filesystem::path& file, const std::string& id,
                             const LoadOptions& options, double thickness_m) {
  const LoadedObjects loaded = load_wanted_objects(file, options, has_id(id));
  LoadedSpecimen result{{}, loaded.context->grid, loaded.context->length_unit_m, loaded.notes};
  Specimen& s = result.specimen;
  s.name = id;
  std::vector<std::string> known;
  bool is_found = false;
  for (const auto& [its_id, object] : loaded.objects) {
    const auto asset = std::dynamic_pointer_cast<const Asset>(object);
    const Primitive* primitive = asset && !asset->primitives().empty() ? &asset->primitives()[0] : nullptr;
    const auto bsdf = primitive ? primitive->bsdf : std::dynamic_pointer_cast<const Bsdf>(object);
    if (!bsdf || its_id.empty()) continue;
    known.push_back(its_id);
    if (its_id != id || is_found) continue;
    is_found = true;
    s.bsdf = bsdf;
    if (!primitive) continue;
    s.medium = primitive->media.inside, s.bssrdf = primitive->media.bssrdf;
    const double extent = smallest_extent(primitive->bounds()) * result.length_unit_m;
    // Clear glass is a slab as well, unless the shape is flat, along the axes or tilted: then it is the surface of a body.
    const bool is_glass =
        s.index_behind(result.grid) != 1 && (thickness_m > 0 || !is_flat(*primitive->shape));
    if (s.medium || s.bssrdf || is_glass) s.thickness_m = thickness_m > 0 ? thickness_m : extent;
    if (is_glass && !s.medium && !s.bssrdf)
      result.notes.push_back(fmt::format("{}: \"{}\" is measured as a clear slab of {:g} mm", file.string(),
                                         id, 1e3 * s.thickness_m));
    if ((s.medium || s.bssrdf) && !(s.thickness_m > 0))
      throw Error(
          {file.string(), 0, 0},
          fmt::format("the shape \"{}\" is flat: --thickness says how thick the slab of its medium is", id));
    if (primitive->media.outside)
      result.notes.push_back(fmt::format(
          "{}: the medium outside of \"{}\" is left out: instruments measure in air", file.string(), id));
  }
  if (!is_found)
    throw Error({file.string(), 0, 0},
                (id.empty() ? "name a BSDF or a shape after \"#\""
                            : "no BSDF or shape has the id \"" + id + "\"" + did_you_mean(id, known)) +
                    (known.empty() ? "; none of this scene has an id"
                                   : fmt::format("; there are {}", fmt::join(known, ", "))));
  if (thickness_m > 0 && !s.is_slab())
    throw Error(
        {file.string(), 0, 0},
        fmt::format(
            "--thickness: \"{}\" has no medium inside; name a shape with an interior medium or a BSSRDF, or of glass",
            id));
  return result;
}

LoadedSpecimen load_specimen_called(const std::string& target, const LoadOptions& options,
                                    double thickness_m) {
  const std::size_t mark = target.rfind('#');
  if (mark == target.npos)
    throw Error({target, 0, 0}, "name a material of the scene as scene.xml#id, the id of a BSDF or a shape");
  return load_specimen(target.substr(0, mark), target.substr(mark + 1), options, thickness_m);
}

Specimen lambertian_standard(double reflectance) {
  return {.name = fmt::format("Lambertian standard of {:g}", reflectance),
          .element = fmt::format(
              "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"{:.9g}\"/></bsdf>", reflectance)};
}

Specimen black_glass(double ior) {
  return {.name = fmt::format("black glass of index {:g}", ior),
          .element =
              fmt::format("<bsdf type=\"plastic\"><float name=\"diffuse_reflectance\" value=\"0\"/><float "
                          "name=\"int_ior\" value=\"{:.9g}\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>",
                          ior)};
}

Specimen open_port() { return {.name = "open port", .element = "<bsdf type=\"null\"/>"}; }

std::string specimen_shape(const Specimen& s, const SpecimenPlace& place,
                           std::map<std::string, ObjectPtr>& given) {
  std::string content = s.element;
  const auto add = [&](const char* name, const ObjectPtr& object) {
    const std::string key = place.key + "-" + name;
    given[key] = object;
    content += std::string(name) == "bsdf" ? fmt::format("<given key=\"{}\"/>", key)
                                           : fmt::format("<given name=\"{}\" key=\"{}\"/>", name, key);
  };
  if (s.bsdf) add("bsdf", as_given(s.bsdf));
  // A square, whose tangent is the world's x everywhere; that of a disc would turn with the azimuth.
  if (!s.is_slab())
    return fmt::format(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"{:.9g}\"/><matrix value=\"{}\"/></transform>{}</shape>",
        place.radius, place.matrix, content);
  if (s.medium) add("interior", as_given(s.medium));
  if (s.bssrdf) add("bssrdf", as_given(s.bssrdf));
  const double half = 0.5 * s.thickness_m / place.length_unit_m;
  return fmt::format(
      "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"{0:.9g}\" y=\"{0:.9g}\" z=\"{1:.9g}\"/>"
      "<translate z=\"{2:.9g}\"/><matrix value=\"{3}\"/></transform>{4}</shape>",
      place.radius, half, -half, place.matrix, content);
}

}  // namespace aureole
