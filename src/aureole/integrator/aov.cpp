// SPDX-License-Identifier: Apache-2.0
// Arbitrary output variables (AOVs): properties of the first surface that a sensor's ray hits.
#include <algorithm>
#include <array>
#include <span>

#include "aureole/integrator/aov_channels.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/batch.h"
#include "aureole/transport/dimensions.h"

namespace aureole {
namespace {

enum class Kind { albedo, depth, position, uv, geo_normal, sh_normal, dp_du, dp_dv, prim_index, shape_index };

struct KindName {
  const char* name;
  Kind kind;
  std::string_view channels;  ///< names of the channels, one letter each
  const char* meaning;        ///< description of the AOV with its unit
};
constexpr KindName kKinds[] = {
    {"albedo", Kind::albedo, "RGB", "diffuse reflectance under D65, linear sRGB"},
    {"depth", Kind::depth, "T", "distance along the ray from the near clip plane, scene units"},
    {"position", Kind::position, "XYZ", "position in the world, scene units"},
    {"uv", Kind::uv, "UV", "texture coordinate"},
    {"geo_normal", Kind::geo_normal, "XYZ", "normal of the geometry in the world, unit vector"},
    {"sh_normal", Kind::sh_normal, "XYZ", "shading normal in the world, unit vector"},
    {"dp_du", Kind::dp_du, "XYZ", "derivative of the position by u, scene units"},
    {"dp_dv", Kind::dp_dv, "XYZ", "derivative of the position by v, scene units"},
    {"prim_index", Kind::prim_index, "I", "number of the primitive in its shape, from 0"},
    {"shape_index", Kind::shape_index, "I", "number of the shape in the scene, from 1; 0: none"}};

class AovIntegrator final : public NestingIntegrator {
public:
  explicit AovIntegrator(const Properties& p) : NestingIntegrator(p) {
    own_colors_ = p.get_bool("colors", true) ? nested_.size() : 0;
    append_channels(nested_, own_colors_, names_, meanings_);
    specular_depth_ = int(p.get_int("specular_depth", 0, {0, 64}));
    const std::string text = p.get_string("aovs");
    constexpr const char* kSeparators = ", \t\r\n";
    for (size_t at = text.find_first_not_of(kSeparators); at != std::string::npos;) {
      const size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
      add(p, text.substr(at, end - at));
      at = text.find_first_not_of(kSeparators, end);
    }
    if (names_.empty()) throw p.error("aovs", "names no channel, and no integrator is nested");
    require_distinct(p, "aovs", names_);
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    const Arena::Frame frame;
    Arena& arena = frame.arena();
    const std::span<RadianceEstimate> results = arena.make<RadianceEstimate>(paths.size());
    const std::span<float*> aovs = arena.make<float*>(paths.size());
    for (size_t i = 0; i < paths.size(); ++i) aovs[i] = paths[i].aovs, paths[i].aovs += 4 * own_colors_;
    for (size_t k = 0; k < nested_.size(); ++k) {
      nested_[k].integrator->estimate(scene, paths, splats, log);
      for (size_t i = 0; i < paths.size(); ++i) {
        if (k == 0) results[i] = paths[i].result;
        if (k < own_colors_) write_colour(paths[i].result, paths[i].wavelengths, aovs[i] + 4 * k);
        paths[i].aovs += nested_[k].channels.size();
      }
    }
    BatchRays rays(arena, paths.size());
    const std::span<Followed> followed = arena.make<Followed>(paths.size());
    for (size_t i = 0; i < paths.size(); ++i) {
      followed[i].ray = paths[i].ray;
      rays.add(int(i), paths[i].ray);
    }
    for (int round = 0; !rays.empty(); ++round)
      rays.intersect(scene.tracer(), round == 0 ? RayTracer::Rays::coherent : RayTracer::Rays::incoherent,
                     [&](int i, const RayTracer::Hit& hit) {
                       Path& p = paths[size_t(i)];
                       Followed& f = followed[size_t(i)];
                       if (round < specular_depth_ && hit && go_on(scene, hit, p, round, f))
                         rays.add(i, f.ray);
                       else
                         write_surface(scene, hit, f, p.wavelengths, p.aovs, aovs[size_t(i)] + names_.size());
                     });
    for (size_t i = 0; i < paths.size(); ++i) paths[i].result = results[i], paths[i].aovs = aovs[i];
  }

private:
  /// A ray of the sensor, or one that mirrors and glass have made of it.
  struct Followed {
    Ray ray;
    float distance = 0;  ///< before the ray begins
  };

  /// Follows light through a surface whose lobes are all delta. Returns false at any other surface, and where the BSDF gives no
  /// direction: the surface itself is described then.
  static bool go_on(const Scene& scene, const RayTracer::Hit& hit, Path& path, int round, Followed& f) {
    const SurfacePoint point = scene.surface_point(hit, f.ray);
    const Bsdf& bsdf = *point.surface->bsdf;
    if (bsdf.is_smooth()) return false;
    const BsdfContext context{path.wavelengths, point, TransportMode::radiance,
                              key(path.samples, round, Stream::bsdf)};
    const auto sample = bsdf.sample(point.shading.to_local(-f.ray.d), get(path.samples, round, Choice::lobe),
                                    get(path.samples, round, Pair::scatter), context);
    if (!sample) return false;
    f.distance += dot(point.p - f.ray.o, f.ray.d);
    const Vec3 d = point.shading.to_world(sample->wo);
    f.ray = {offset_origin(point, d), d, kInfinity};
    return true;
  }

  void add(const Properties& p, const std::string& item) {
    const size_t colon = item.find(':');
    if (colon == 0 || colon == std::string::npos || colon + 1 == item.size() ||
        item.find(':', colon + 1) != std::string::npos)
      throw p.error("aovs", "\"" + item + "\": expected NAME:TYPE, such as \"depth:depth\"");
    const std::string name = item.substr(0, colon), type = item.substr(colon + 1);
    if (type == "duv_dx" || type == "duv_dy")
      throw p.error("aovs", "\"" + type +
                                "\" is not available: rays have no differentials here; \"uv\" of two pixels "
                                "differs by it");
    const auto found =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](const KindName& k) { return type == k.name; });
    if (found == std::end(kKinds)) {
      std::vector<std::string> types;
      std::string list;
      for (const KindName& k : kKinds) {
        types.push_back(k.name);
        list += (list.empty() ? "" : ", ") + types.back();
      }
      throw p.error("aovs", "\"" + type + "\" is not one of " + list + did_you_mean(type, types));
    }
    kinds_.push_back(found->kind);
    needs_derivatives_ |= found->kind == Kind::dp_du || found->kind == Kind::dp_dv;
    for (const char c : found->channels) {
      names_.push_back(name + "." + c);
      meanings_.emplace_back(found->meaning);
    }
  }

  // Order of the channels, as in Mitsuba: the colours of all nested integrators, their own AOVs, the surface.
  void write_colour(const RadianceEstimate& r, const Wavelengths& w, float out[4]) const {
    meter_.rgb(r.estimate, w, out);
    out[3] = r.alpha;
  }

  void write_surface(const Scene& scene, const RayTracer::Hit& hit, const Followed& followed,
                     const Wavelengths& w, float* out, float* end) const {
    if (!hit) {
      std::fill(out, end, 0.f);
      return;
    }
    const SurfacePoint point = scene.surface_point(hit, followed.ray);
    SurfaceDerivatives derivatives;
    if (needs_derivatives_) derivatives = point.shape->derivatives(point);
    for (const Kind kind : kinds_) out = write(kind, hit.shape, followed, point, derivatives, w, out);
  }

  float* write(Kind kind, std::uint32_t shape_index, const Followed& followed, const SurfacePoint& hit,
               const SurfaceDerivatives& derivatives, const Wavelengths& w, float* out) const {
    const auto vector = [&](const Vec3& v) {
      for (int i = 0; i < 3; ++i) *out++ = v[i];
      return out;
    };
    switch (kind) {
      case Kind::albedo: {
        const Vec3 wi = hit.shading.to_local(-followed.ray.d);
        const Bsdf& bsdf = *hit.surface->bsdf;
        meter_.reflectance_rgb(bsdf.diffuse_reflectance(wi, BsdfContext{w, hit}), w,
                               bsdf.diffuse_reflectance(wi, BsdfContext{meter_.fixed_wavelengths(), hit}),
                               out);
        return out + 3;
      }
      case Kind::depth:
        *out++ = followed.distance + dot(hit.p - followed.ray.o, followed.ray.d);
        return out;
      case Kind::position:
        return vector(hit.p);
      case Kind::uv:
        *out++ = hit.uv.x, *out++ = hit.uv.y;
        return out;
      case Kind::geo_normal:
        return vector(hit.ng);
      case Kind::sh_normal:
        return vector(hit.shading.to_world(hit.surface->bsdf->shading_normal(hit)));
      case Kind::dp_du:
        return vector(derivatives.dp_du);
      case Kind::dp_dv:
        return vector(derivatives.dp_dv);
      case Kind::prim_index:
        *out++ = float(hit.primitive);
        return out;
      case Kind::shape_index:
        *out++ = float(shape_index + 1);
        return out;
    }
    return out;
  }

  std::size_t own_colors_ = 0;  ///< how many nested integrators have channels for their colours
  std::vector<Kind> kinds_;
  bool needs_derivatives_ = false;
  int specular_depth_ = 0;
};

AUREOLE_PLUGIN(
    AovIntegrator, "integrator", "aov",
    PluginDoc{
        "Further channels of the picture (arbitrary output variables) that tell of the first surface a ray "
        "of the sensor meets, as a denoiser wants them. Types and channels: albedo (.R .G .B), depth (.T), "
        "position, geo_normal, sh_normal, dp_du, dp_dv (.X .Y .Z), uv (.U .V), prim_index, shape_index (.I); "
        "all are 0 where there is no surface, and all are filtered like the picture, so that an index or a "
        "depth at an edge is a mean. The picture is that of the first nested integrator, black without one; "
        "every nested integrator of name N adds N.R, N.G, N.B, N.A (N is _arg_0, _arg_1, ... without a name) "
        "and its own further channels. Albedo is the diffuse reflectance as linear sRGB under D65: an <rgb> "
        "reflectance as the scene has it, black for mirrors and glass. Depth is the distance along the ray "
        "from the near clip plane, in scene units; positions and their derivatives are in scene units, too. Indices count primitives of a shape from 0 and shapes of the scene "
        "from 1. With a `specular_depth` the surface described is the first one that is not specular: up to that many mirrors, panes and glass surfaces, whose lobes are all delta, are followed as a path follows them, reflected and refracted at random; distances are summed. `component_format` float32 keeps positions and indices from being rounded to half floats.",
        "",
        {{"aovs", "string", "", "required", "list of NAME:TYPE, separated by commas"},
         {"specular_depth", "integer", "", "0", "specular surfaces that are followed, at most 64"},
         {"colors", "boolean", "", "true",
          "whether the colours of nested integrators are channels of their own, besides the picture"},
         {"integrator", "integrator", "", "none", "any number of nested integrators"}},
        {R"(<integrator type="aov"><string name="aovs" value="albedo:albedo, nn:sh_normal, dd.y:depth"/>
    <integer name="specular_depth" value="4"/>
    <integrator type="path" name="img"/></integrator>)",
         R"(<integrator type="aov"><string name="aovs" value="albedo:albedo, normal:sh_normal"/>
    <boolean name="colors" value="false"/> <integrator type="path"/></integrator>)"}});

}  // namespace
}  // namespace aureole
