// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/classified_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/medium/content/extinction_limit.h"
#include "aureole/medium/content/volume_majorants.h"
#include "aureole/plugin/number_list.h"
#include "aureole/spectrum/observer.h"

namespace aureole {

namespace {

/// Reads the volume of numbers. Throws a located Error where it has no box, colours, or numbers that are not finite.
ScalarField read_field(const Properties& p) {
  const auto volume = p.get_object<Volume>("value");
  if (!volume) throw p.error("value", "is missing: the volume of numbers, such as a \"gridvolume\"");
  if (!volume->to_box())
    throw p.error("value", "is constant in space; a volume on a grid is needed, such as a \"gridvolume\"");
  if (volume->channels() > 1)
    throw p.error("value", fmt::format("has {} numbers at each point; one is needed", volume->channels()));
  if (volume->has_colors())
    throw p.error("value",
                  "holds colours; one number at each point is needed, such as one channel of the picture");
  ScalarField field(*volume);
  if (field.broken() > 0)
    throw p.error("value", fmt::format("has {} voxels that are not finite numbers", field.broken()));
  for (const char* name : {"filter_type", "wrap_mode"})
    if (volume->properties().has(name) &&
        volume->properties().get_string(name) != (name[0] == 'f' ? "trilinear" : "clamp"))
      throw volume->properties().error(
          name,
          "has no effect here: \"classified\" interpolates its numbers linearly, and the grid is not "
          "continued beyond its box");
  return field;
}

/// Reads lists of `count` numbers; `example` is shown in the error.
std::vector<std::vector<double>> read_tuples(const Properties& p, const char* name, std::size_t count,
                                             const char* example) {
  std::vector<std::vector<double>> tuples;
  if (!p.has(name)) return tuples;
  const std::vector<double> list = get_number_list(p, name);
  if (list.empty() || list.size() % count != 0)
    throw p.error(name, fmt::format("expected {} numbers each, such as \"{}\", but found {}", count, example,
                                    list.size()));
  for (std::size_t i = 0; i < list.size(); i += count)
    tuples.emplace_back(list.begin() + std::ptrdiff_t(i), list.begin() + std::ptrdiff_t(i + count));
  return tuples;
}

}  // namespace

ClassifiedMedium::ClassifiedMedium(const Properties& p)
    : Medium(p),
      field_(read_field(p)),
      classification_(p, field_),
      unit_(float(opacity_unit_length(p))),
      color_emits_(p.get_choice("color_is", "emission", {"emission", "albedo"}) == "emission"),
      emission_scale_(float(p.get_float("emission_scale", 1, Range::non_negative()))),
      sampling_weight_(float(p.get_float("sampling_weight", 1, Range::non_negative()))),
      d65_(d65_spectrum(p.context().grid, 1)),
      shading_{float(p.get_float("ambient", 0.1, Range::unit())),
               float(p.get_float("diffuse", 0.7, Range::unit())),
               float(p.get_float("specular", 0.2, Range::unit())),
               float(p.get_float("shininess", 10, {0, 1e6}))} {
  for (const auto& box : read_tuples(p, "clip_box", 6, "-1 -1 -1 1 1 0")) {
    for (int k = 0; k < 3; ++k) {
      if (!(box[std::size_t(k)] < box[std::size_t(k) + 3]))
        throw p.error("clip_box",
                      "expected the lower corner and then the upper one, such as \"-1 -1 -1 1 1 0\"");
      Vec3 n;
      n[k] = 1;
      planes_.push_back({n, float(box[std::size_t(k)])});
      planes_.push_back({-n, -float(box[std::size_t(k) + 3])});
    }
  }
  for (const auto& plane : read_tuples(p, "clip_planes", 4, "0 0 1 0.5")) {
    const Vec3 n{float(plane[0]), float(plane[1]), float(plane[2])};
    if (!(length(n) > 0)) throw p.error("clip_planes", "the normal of a plane must not be zero");
    planes_.push_back({n * (1 / length(n)), float(plane[3]) / length(n)});
  }
  const bool has_phase = std::any_of(p.entries().begin(), p.entries().end(), [](const Properties::Entry& e) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    return object && dynamic_cast<const PhaseFunction*>(object->get());
  });
  phase_ = only_phase(p);
  if (color_emits_ && has_phase)
    p.note(
        "phase",
        "the phase function has no effect: the medium emits its colour and scatters no light (\"color_is\")");
  if (!color_emits_ && p.has("emission_scale"))
    p.note("emission_scale",
           "\"emission_scale\" has no effect: the colour is an albedo, and the medium emits no light");
  if (p.has("opacity_unit_length") && p.has("extinction") && !p.has("opacity") && !p.has("preset") &&
      !p.has("boxes") && !p.has("triangles") && !p.has("table"))
    p.note(
        "opacity_unit_length",
        "\"opacity_unit_length\" does not change \"extinction\", which is per unit of length of the scene; it is the layer whose opacity "
        "the methods isosurface, mip and average of \"dvr\" show");
  if (!color_emits_ && p.has("sampling_weight"))
    p.note("sampling_weight", "has no effect: the colour is an albedo, and the medium emits no light");
  if (phase_->largest_projected_area() != 1)
    throw p.error("phase",
                  "oriented particles are not supported: the transfer function gives the extinction");

  const std::array<int, 3> cells = majorant_cells(field_.size());
  grid_.emplace(field_.to_box(), cells, classification_.bounds(cells));
  const char* stated = classification_.parameter();
  require_computable_extinction(p, stated, double(classification_.max_extinction(-kInfinity, kInfinity)));
  require_computable_extinction(p, stated, *grid_, 0, 1);
  const Transform from_box = field_.to_box().inverse();
  for (const Plane& plane : planes_) {
    bool cuts_all = true;
    for (int corner = 0; corner < 8; ++corner)
      cuts_all &=
          dot(plane.n, from_box.point({float(corner & 1), float(corner >> 1 & 1), float(corner >> 2 & 1)})) <
          plane.d;
    if (!cuts_all) continue;
    p.note(p.has("clip_planes") ? "clip_planes" : "clip_box",
           fmt::format("nothing of the volume is left where ({:g}, {:g}, {:g}) . p >= {:g}", plane.n.x,
                       plane.n.y, plane.n.z, plane.d));
    break;
  }
  if (!(grid_->maximum() > 0))
    p.note(stated,
           fmt::format("the extinction is 0 for all numbers of the volume, which lie between {:g} and {:g}",
                       field_.minimum(), field_.maximum()));
}

bool ClassifiedMedium::contains(const Vec3& p) const {
  for (const Plane& plane : planes_)
    if (dot(plane.n, p) < plane.d) return false;
  const Vec3 i = field_.index_of(p);
  for (int k = 0; k < 3; ++k)
    if (!(i[k] >= -0.5f && i[k] <= float(field_.size()[std::size_t(k)]) - 0.5f)) return false;
  return true;
}

void ClassifiedMedium::clip(const Ray& ray, float& begin, float& end) const {
  const auto keep = [&](float at_origin,
                        float slope) {  // Keeps the distances t with at_origin + t slope >= 0.
    const float t = -at_origin / slope;
    if (slope > 0)
      begin = std::max(begin, t);
    else if (slope < 0)
      end = std::min(end, t);
    else if (at_origin < 0)
      end = begin;
  };
  const Vec3 o = field_.index_of(ray.o), d = field_.index_vector(ray.d);
  for (int k = 0; k < 3; ++k) {
    keep(o[k] + 0.5f, d[k]);
    keep(float(field_.size()[std::size_t(k)]) - 0.5f - o[k], -d[k]);
  }
  if (!(end > begin)) return;
  for (const Plane& plane : planes_) keep(dot(plane.n, ray.o) - plane.d, dot(plane.n, ray.d));
}

void ClassifiedMedium::eval(const Vec3& p, const Vec3&, const Wavelengths& w, MediumCoefficients& out) const {
  out = {};
  if (grid_->at(p) == 0 || !contains(p)) return;
  const TransferFunction::Sample s = classify(p, field_.value(p));
  out.sigma_t = s.extinction;
  const Spectrum color = ColorBasis(w.nm).eval(s.color);
  if (color_emits_)
    out.emission = color * d65_.eval(w) * (emission_scale_ * s.extinction);
  else
    out.sigma_s = min(color, 1.f) * s.extinction;
}

std::vector<ParameterDoc> ClassifiedMedium::rows() {
  std::vector<ParameterDoc> all = {{"value", "volume", "", "required",
                                    "the numbers, on a grid; values outside of their box do not count"}};
  const std::vector<ParameterDoc> functions = Classification::rows();
  all.insert(all.end(), functions.begin(), functions.end());
  const std::vector<ParameterDoc> rest = {
      {"color_is", "string", "", "emission",
       "\"emission\": the medium emits its colour (times D65, as an <rgb> emitter) wherever it absorbs, so that a thick layer has "
       "that colour; \"albedo\": the colour is the single-scattering albedo"},
      {"emission_scale", "float", "", "1", "factor of the emitted light"},
      {"ambient", "float", "", "0.1", "part of the emitted colour that gradient shading keeps (dvr)"},
      {"diffuse", "float", "", "0.7", "diffuse coefficient of gradient shading (dvr)"},
      {"specular", "float", "", "0.2", "specular coefficient of gradient shading (dvr)"},
      {"shininess", "float", "", "10", "exponent of the specular lobe (dvr)"},
      {"clip_box", "string", "length", "none",
       "lower and upper corner, in the world: outside of it the medium is empty"},
      {"clip_planes", "string", "", "none",
       "planes as x, y, z of the normal and its product d with a point of the plane: the medium is empty where n . p < d"},
      {"sampling_weight", "float", "", "1",
       "factor of the probability that light sampling chooses this medium's emission; 0: never"},
      {"phase", "phase", "", "isotropic", "phase function of the scattered light"}};
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

namespace {

AUREOLE_PLUGIN(
    ClassifiedMedium, "medium", "classified",
    PluginDoc{
        "A volume of numbers as a medium: a transfer function gives its extinction and colour by value. The "
        "integrator \"dvr\" composites it step by step, as volume renderers do; every other integrator follows "
        "light through it, so that one file gives both pictures (docs/volumes.md).",
        "Levoy 1988, \"Display of surfaces from volume data\"; Max 1995, \"Optical models for direct volume "
        "rendering\"",
        ClassifiedMedium::rows(),
        {R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <string name="opacity" value="0 0, 0.5 0.1, 1 0.9"/>
    <float name="opacity_unit_length" value="0.2"/>
    <string name="color_map" value="viridis"/>
    <string name="range" value="0, 1"/>
    <string name="gradient_opacity" value="0 0.2, 5 1"/>
    <string name="color_is" value="albedo"/>
    <float name="emission_scale" value="1"/>
    <float name="ambient" value="0.1"/><float name="diffuse" value="0.7"/>
    <float name="specular" value="0.2"/><float name="shininess" value="10"/>
    <string name="clip_box" value="0 0 0 1 1 0.5"/>
    <string name="clip_planes" value="0 0 1 0.1"/>
    <float name="sampling_weight" value="1"/>
    <phase type="hg"/>
</medium>)",
         R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <string name="extinction" value="0 0, 1 10"/>
    <string name="colors" value="0 0 0 0, 1 1 0.8 0.6"/>
    <string name="color_encoding" value="srgb"/>
</medium>)",
         R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <string name="preset" value="generic"/>
</medium>)",
         R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <string name="boxes" value="0.2 0.4 0 2 0.9 0.7 0.5 0.3"/>
    <string name="triangles" value="0.5 0 4 0.2 0 1 1 0.9 0.6"/>
</medium>)",
         R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <string name="table" value="transfer.png"/>
    <string name="table_values" value="0, 1"/>
    <string name="table_gradients" value="0, 5"/>
</medium>)",
         R"(<medium type="classified">
    <volume type="gridvolume" name="value"><string name="filename" value="smoke.vol"/></volume>
    <volume type="gridvolume" name="mask"><string name="filename" value="labels.vol"/></volume>
    <string name="opacity" value="0: 0 0; 1: 0 0, 1 0.5; 2-4: 0 0.1"/>
    <string name="colors" value="1: 0 1 0.8 0.6; 0 1 1 1"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
