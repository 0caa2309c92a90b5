// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per call of the parts that a path is made of: BSDFs, samplers, spectra, single rays.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/random.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/sampler/sampler.h"
#include "aureole/scene/ray_tracer.h"
#include "tests/harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;
using testing::make_context;

constexpr int kInputs = 1024;  // drawn in advance and reused, so that they stay in the L1 and L2 caches

/// Reproducible numbers in [0, 1).
class Random {
public:
  float next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return float(state_ >> 40) * 0x1p-24f;
  }
  Vec2 next2() {
    const float x = next();
    return {x, next()};
  }

private:
  std::uint64_t state_ = 12345;
};

Wavelengths draw_wavelengths(const SpectralGrid& grid, float u) {
  return Wavelengths::at(grid, make_spectrum([&](int i) {
                           const float f = u + float(i) / kWavelengths;
                           return float(grid.min_nm) + (f - std::floor(f)) * float(grid.max_nm - grid.min_nm);
                         }));
}

/// Arguments of BSDF calls, for both sides of the surface.
struct BsdfInputs {
  explicit BsdfInputs(const SpectralGrid& grid) {
    Random random;
    for (int i = 0; i < kInputs; ++i) {
      wi.push_back(square_to_cosine_hemisphere(random.next2()));
      wo.push_back(square_to_cosine_hemisphere(random.next2()));
      if (i % 2) wo.back().z = -wo.back().z;
      u1.push_back(random.next());
      u2.push_back(random.next2());
      wavelengths.push_back(draw_wavelengths(grid, random.next()));
    }
  }
  std::vector<Vec3> wi, wo;
  std::vector<float> u1;
  std::vector<Vec2> u2;
  std::vector<Wavelengths> wavelengths;
};

/// The time per wavelength of a path.
void count_per_wavelength(benchmark::State& state) {
  state.counters["per_wavelength"] = benchmark::Counter(
      double(state.iterations()) * kWavelengths, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Typical arguments for a layer: half of the directions cosine-distributed, as towards lights, half sampled
/// from the BSDF. All pairs cross the surface, so that no early test of sides applies.
BsdfInputs crossing_inputs(const Bsdf& bsdf, const SpectralGrid& grid) {
  BsdfInputs in(grid);
  const SurfacePoint point;
  for (int i = 0; i < kInputs; ++i) {
    in.wo[i].z = -std::abs(in.wo[i].z);
    if (i % 2 == 0) continue;
    const BsdfContext ctx{in.wavelengths[i], point, TransportMode::radiance, std::uint32_t(i)};
    const auto s = bsdf.sample(in.wi[i], 0.999f, in.u2[i], ctx);
    if (s && !s->is_delta()) in.wo[i] = s->wo;
  }
  return in;
}

/// Both directions above the surface, for those that are compared with one another: `coat of ...`.
BsdfInputs upper_inputs(const SpectralGrid& grid) {
  BsdfInputs in(grid);
  for (Vec3& wo : in.wo) wo.z = std::abs(wo.z);
  return in;
}

/// Each is made once: tables take seconds, and benchmarks are started several times.
std::shared_ptr<Bsdf> bsdf_of(const std::string& xml, const std::shared_ptr<const BuildContext>& context) {
  static std::map<std::string, std::shared_ptr<Bsdf>> made;
  std::shared_ptr<Bsdf>& bsdf = made[xml];
  if (!bsdf) bsdf = build<Bsdf>(xml, context);
  return bsdf;
}

enum class Directions { any, crossing, above };

void bench_eval_pdf(benchmark::State& state, const std::string& xml, Directions directions) {
  const auto context = make_context();
  const auto bsdf = bsdf_of(xml, context);
  const BsdfInputs in = directions == Directions::crossing ? crossing_inputs(*bsdf, context->grid)
                        : directions == Directions::above  ? upper_inputs(context->grid)
                                                           : BsdfInputs(context->grid);
  SurfacePoint point;
  unsigned i = 0;
  for (auto _ : state) {
    point.uv = in.u2[i];
    const BsdfContext ctx{in.wavelengths[i], point, TransportMode::radiance, i};
    benchmark::DoNotOptimize(bsdf->eval_pdf(in.wi[i], in.wo[i], ctx));
    i = (i + 1) % kInputs;
  }
  count_per_wavelength(state);
}

void bench_eval(benchmark::State& state, const std::string& xml) {
  const auto context = make_context();
  const auto bsdf = bsdf_of(xml, context);
  const BsdfInputs in = crossing_inputs(*bsdf, context->grid);
  const SurfacePoint point;
  unsigned i = 0;
  for (auto _ : state) {
    const BsdfContext ctx{in.wavelengths[i], point, TransportMode::radiance, i};
    benchmark::DoNotOptimize(bsdf->eval(in.wi[i], in.wo[i], ctx));
    i = (i + 1) % kInputs;
  }
  count_per_wavelength(state);
}

void bench_sample(benchmark::State& state, const std::string& xml) {
  const auto context = make_context();
  const auto bsdf = bsdf_of(xml, context);
  const BsdfInputs in(context->grid);
  const SurfacePoint point;
  unsigned i = 0;
  for (auto _ : state) {
    const BsdfContext ctx{in.wavelengths[i], point, TransportMode::radiance, i};
    benchmark::DoNotOptimize(bsdf->sample(in.wi[i], in.u1[i], in.u2[i], ctx));
    i = (i + 1) % kInputs;
  }
  count_per_wavelength(state);
}

// Coats that are compared with one another. The pictures are those of docs/images: run from the repository's root.
std::string squares(const std::string& name, const std::string& a, const std::string& b) {
  return R"(<texture type="checkerboard" name=")" + name + R"("><float name="color0" value=")" + a +
         R"("/><float name="color1" value=")" + b + R"("/></texture>)";
}
std::string coloured_squares(const std::string& name) {
  return R"(<texture type="checkerboard" name=")" + name +
         R"("><rgb name="color0" value="0.2, 0.25, 0.7"/><rgb name="color1" value="0.7, 0.25, 0.2"/></texture>)";
}
std::string picture(const std::string& name, const std::string& file, const std::string& more) {
  return R"(<texture type="bitmap" name=")" + name + R"("><string name="filename" value="docs/images/)" +
         file + R"(.png"/>)" + more + "</texture>";
}
std::string roughplastic(const std::string& reflectance) {
  return R"(<bsdf type="roughplastic"><float name="alpha" value="0.2"/>)" + reflectance + "</bsdf>";
}
std::string film(const std::string& more) {
  return R"(<bsdf type="paint"><float name="alpha" value="0.2"/><float name="thickness" value="0.5"/>
      <string name="recipe" value="blue green shade: 1 + white: 10"/><float name="substrate" value="0.5"/>)" +
         more + "</bsdf>";
}
// Files of the tests: run from the repository's root.
std::string of_file(const std::string& type, const std::string& file) {
  return "<bsdf type=\"" + type + "\"><string name=\"filename\" value=\"tests/bsdf/data/measured/" + file +
         "\"/></bsdf>";
}
const char* const kRough = R"(<string name="alpha" value="0.3"/>)";
std::string coat(const std::string& interface, const std::string& reflectance) {
  return R"(<bsdf type="layered"><string name="thickness" value="20um"/>
      <medium type="homogeneous"><float name="sigma_t" value="2e5"/><rgb name="albedo" value="0.6, 0.7, 0.95"/></medium>)" +
         interface + R"(<bsdf type="diffuse">)" + reflectance + "</bsdf></bsdf>";
}

// The instances; BSDFs without one here are measured by the examples of their documentation.
const std::vector<std::pair<std::string, std::string>> kBsdfs = {
    {"diffuse", R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.25, 0.7"/></bsdf>)"},
    {"dielectric, 1.5", R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf>)"},
    {"dielectric, bk7", R"(<bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>)"},
    {"thindielectric, bk7", R"(<bsdf type="thindielectric"><string name="int_ior" value="bk7"/></bsdf>)"},
    {"conductor, Au", R"(<bsdf type="conductor"><string name="material" value="Au"/></bsdf>)"},
    {"plastic", R"(<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.2, 0.25, 0.7"/></bsdf>)"},
    {"twosided, diffuse", R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)"},
    {"correlated_scatterers, sheet", R"(<bsdf type="correlated_scatterers"><string name="radius" value="5um"/>
      <float name="area_fraction" value="0.5"/></bsdf>)"},
    {"correlated_scatterers, pane", R"(<bsdf type="correlated_scatterers"><string name="radius" value="5um"/>
      <float name="area_fraction" value="0.5"/><string name="substrate" value="thindielectric"/>
      <string name="int_ior" value="bk7"/></bsdf>)"},
    {"correlated_scatterers, glass", R"(<bsdf type="correlated_scatterers"><string name="radius" value="5um"/>
      <float name="area_fraction" value="0.5"/><string name="substrate" value="dielectric"/>
      <string name="int_ior" value="bk7"/></bsdf>)"},
    {"correlated_scatterers, squares", R"(<bsdf type="correlated_scatterers"><aperture type="rectangle">
      <string name="width" value="7um"/><string name="height" value="7um"/></aperture>
      <float name="area_fraction" value="0.5"/></bsdf>)"},
    {"correlated_scatterers, mixture", R"(<bsdf type="correlated_scatterers"><aperture type="rectangle">
      <string name="width" value="7um"/><string name="height" value="7um"/><float name="fraction" value="0.5"/></aperture>
      <aperture type="circle"><string name="radius" value="5um"/><float name="fraction" value="0.5"/></aperture>
      <float name="area_fraction" value="0.5"/></bsdf>)"},
    {"correlated_scatterers, textured mixture",
     R"(<bsdf type="correlated_scatterers"><aperture type="rectangle">
      <string name="width" value="7um"/><string name="height" value="7um"/><float name="fraction" value="0.5"/></aperture>
      <aperture type="circle"><string name="radius" value="5um"/><float name="fraction" value="0.5"/></aperture>
      <texture type="checkerboard" name="area_fraction"><float name="color0" value="0.3"/><float name="color1" value="0.5"/></texture></bsdf>)"},
    {"roughconductor, Al", R"(<bsdf type="roughconductor"><string name="material" value="Al"/>
      <string name="distribution" value="ggx"/><float name="alpha" value="0.2"/></bsdf>)"},
    {"measured, isotropic", of_file("measured", "golden_paint.bsdf")},
    {"measured, anisotropic", of_file("measured", "anisotropic_spectral.bsdf")},
    {"merl", of_file("merl", "small_merl.binary")},
    {"klems", of_file("klems", "shade_klems.xml")},
    {"tensor_tree", of_file("tensor_tree", "shade_tree4.xml")},
    {"tabulated", of_file("tabulated", "glossy_table.csv")},
    {"coat of roughplastic", roughplastic(R"(<rgb name="diffuse_reflectance" value="0.2, 0.25, 0.7"/>)")},
    {"coat of paint, opaque", R"(<bsdf type="paint"><float name="alpha" value="0.2"/>
      <string name="recipe" value="blue green shade: 1 + white: 10"/></bsdf>)"},
    {"coat of paint, film", film("")},
    {"coat of roughplastic, textured", roughplastic(coloured_squares("diffuse_reflectance"))},
    {"coat of paint, textured film", film(squares("thickness_factor", "0.5", "1"))},
    {"coat of roughplastic, picture", roughplastic(picture("diffuse_reflectance", "paint", ""))},
    {"coat of paint, film by a picture",
     film(picture("thickness_factor", "fogbow", R"(<boolean name="raw" value="true"/>)"))},
    {"coat of paint, textured film and mixture",
     film(R"(<string name="second_recipe" value="red: 1 + white: 10"/>)" +
          squares("thickness_factor", "0.5", "1") + squares("blend", "0", "1"))},
    {"coat of layered, textured substrate", coat(kRough, coloured_squares("reflectance"))},
    {"coat of layered, substrate by a picture", coat(kRough, picture("reflectance", "paint", ""))},
    {"coat of layered", coat(kRough, "")},
    {"coat of layered, smooth", coat("", "")},
};

void bench_sampler(benchmark::State& state, const std::string& type) {
  const auto sampler = build<Sampler>("<sampler type=\"" + type +
                                      "\"><integer name=\"sample_count\" value=\"1024\"/></sampler>");
  std::uint32_t i = 0;
  alignas(32) float out[Sampler::kBlock];
  for (auto _ : state) {
    sampler->block(0x9e3779b97f4a7c15u, i & 1023, int(i & 7), out);
    benchmark::DoNotOptimize(out);
    ++i;
  }
}

void bench_spectrum_eval(benchmark::State& state) {
  const auto context = make_context();
  const auto spectrum = SampledSpectrum::from_function(
      context->grid, [](double nm) { return 0.5 + 0.4 * std::sin(nm * 0.02); });
  const BsdfInputs in(context->grid);
  unsigned i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(spectrum.eval(in.wavelengths[i]));
    i = (i + 1) % kInputs;
  }
}

void bench_wavelengths(benchmark::State& state) {
  const auto context = make_context();
  const SampledSpectrum flat = SampledSpectrum::constant(context->grid, 1);
  const float weight = 1;
  const WavelengthDistribution distribution(context->grid, {&flat, 1}, {&weight, 1});
  Random random;
  for (auto _ : state) benchmark::DoNotOptimize(distribution.sample(random.next()));
}

Primitive build_part(const std::string& xml) { return build<Asset>(xml)->primitives().at(0); }

/// A room with 27 spheres or cubes: rays start inside it and hit a surface.
std::vector<Primitive> room_of(const std::string& type) {
  std::vector<Primitive> shapes;
  shapes.push_back(build_part(
      R"(<shape type="cube"><boolean name="flip_normals" value="true"/><transform name="to_world"><scale value="4"/></transform></shape>)"));
  for (int i = 0; i < 27; ++i)
    shapes.push_back(build_part(
        "<shape type=\"" + type + "\"><transform name=\"to_world\"><scale value=\"0.5\"/><translate x=\"" +
        std::to_string(2 * (i % 3) - 2) + "\" y=\"" + std::to_string(2 * (i / 3 % 3) - 2) + "\" z=\"" +
        std::to_string(2 * (i / 9) - 2) + "\"/></transform></shape>"));
  return shapes;
}

void bench_rays(benchmark::State& state, const std::string& type, bool occlusion) {
  const std::vector<Primitive> shapes = room_of(type);
  const RayTracer tracer(shapes);
  Random random;
  std::vector<Ray> rays;
  for (int i = 0; i < kInputs; ++i) {
    const Vec3 d = square_to_uniform_sphere(random.next2());
    rays.push_back(
        {{7.8f * random.next() - 3.9f, 7.8f * random.next() - 3.9f, 3.95f}, d, occlusion ? 2.f : kInfinity});
  }
  unsigned i = 0;
  for (auto _ : state) {
    if (occlusion)
      benchmark::DoNotOptimize(tracer.occluded(rays[i]));
    else
      benchmark::DoNotOptimize(tracer.intersect(rays[i]));
    i = (i + 1) % kInputs;
  }
}

void register_all() {
  const auto add = [](const std::string& name, auto&& function) {
    benchmark::RegisterBenchmark(name.c_str(), function);
  };
  std::vector<std::pair<std::string, std::string>> bsdfs = kBsdfs;
  for (const std::string& name : Registry::instance().names("bsdf")) {
    bool listed = false;
    for (const auto& b : kBsdfs) listed |= b.first.substr(0, b.first.find(',')) == name;
    const auto& examples = Registry::instance().find("bsdf", name)->doc.examples;
    if (!listed)
      for (std::size_t i = 0; i < examples.size(); ++i)
        bsdfs.emplace_back(name + ", example " + std::to_string(i + 1), examples[i]);
  }
  // Examples whose files are not at hand are skipped, and say so.
  const auto add_bsdf = [&](const std::string& name, auto&& function) {
    add(name, [function](benchmark::State& s) {
      try {
        function(s);
      } catch (const Error& e) {
        s.SkipWithError(e.what());
      }
    });
  };
  for (const auto& [name, xml] : bsdfs) {
    const Directions directions = name.starts_with("correlated") ? Directions::crossing
                                  : name.starts_with("coat")     ? Directions::above
                                                                 : Directions::any;
    add_bsdf(name + "/eval_pdf",
             [xml = xml, directions](benchmark::State& s) { bench_eval_pdf(s, xml, directions); });
    if (directions == Directions::crossing)
      add_bsdf(name + "/eval", [xml = xml](benchmark::State& s) { bench_eval(s, xml); });
    add_bsdf(name + "/sample", [xml = xml](benchmark::State& s) { bench_sample(s, xml); });
  }
  for (const std::string type : {"sobol", "independent"})
    add("sampler " + type + "/8 dimensions", [type](benchmark::State& s) { bench_sampler(s, type); });
  add("SampledSpectrum/eval", bench_spectrum_eval);
  add("WavelengthDistribution/sample", bench_wavelengths);
  for (const std::string type : {"cube", "sphere"}) {
    add("rays, room of " + type + "s/nearest", [type](benchmark::State& s) { bench_rays(s, type, false); });
    add("rays, room of " + type + "s/occluded", [type](benchmark::State& s) { bench_rays(s, type, true); });
  }
}

}  // namespace
}  // namespace aureole

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  aureole::register_all();
  benchmark::RunSpecifiedBenchmarks();
}
