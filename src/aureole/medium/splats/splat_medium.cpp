// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/splats/splat_medium.h"

#include <fmt/format.h>

#include "aureole/medium/content/extinction_limit.h"
#include "aureole/plugin/late_notes.h"
#include "aureole/spectrum/observer.h"

namespace aureole {

namespace {

std::shared_ptr<const SplatCloud> read_cloud(const Properties& p) {
  SplatFileOptions options;
  std::vector<std::string> axes = {"file"};
  axes.insert(axes.end(), splat_axes().begin(), splat_axes().end());
  if (const std::string name = p.get_choice("file_axes", "file", axes); name != "file") options.axes = name;
  options.radius = float(p.get_float("radius", 0, Range::non_negative()));
  options.radius_scale = float(p.get_float("radius_scale", 1, Range::positive()));
  const std::filesystem::path file = p.get_file("filename");
  try {
    auto cloud = std::make_shared<const SplatCloud>(read_splat_file(file, options));
    for (const auto& further : cloud->further_files)
      if (p.context().scene) p.context().scene->add_file(further);
    for (const std::string& note : cloud->notes) p.note("filename", "\"" + file.string() + "\" " + note);
    return cloud;
  } catch (const Error& problem) {
    throw p.error("filename", problem.what());
  }
}

}  // namespace

SplatMedium::SplatMedium(const Properties& p)
    : Medium(p),
      cloud_(read_cloud(p)),
      to_world_(p.get_transform("to_world")),
      color_emits_(p.get_choice("color_is", "albedo", {"emission", "albedo"}) == "emission"),
      emission_scale_(float(p.get_float("emission_scale", 1, Range::non_negative()))),
      sampling_weight_(float(p.get_float("sampling_weight", 0, Range::non_negative()))),
      d65_(d65_spectrum(p.context().grid, 1)) {
  field_options_.along = p.get_choice("opacity_along", "shortest", {"shortest", "mean"}) == "mean"
                             ? SplatField::OpacityAlong::mean
                             : SplatField::OpacityAlong::shortest;
  field_options_.cutoff = float(p.get_float("cutoff", 3, {0.1, 10}));
  field_options_.extinction_scale = float(p.get_float("extinction_scale", 1, Range::positive()));
  if (cloud_->kind == SplatCloud::Kind::gaussians && p.has("radius_scale"))
    p.note("radius_scale", "has no effect on Gaussian splats, which have scales");
  phase_ = only_phase(p);
  if (phase_->largest_projected_area() != 1)
    throw p.error("phase", "oriented particles are not supported: the splats give the extinction");
}

const SplatField& SplatMedium::field() const {
  std::call_once(field_made_, [&] {
    const Properties& p = properties();
    try {
      auto field = std::make_unique<const SplatField>(*cloud_, to_world_, field_options_);
      require_computable_extinction(p, "filename", double(field->grid().maximum()));
      field_ = std::move(field);
    } catch (const Error& problem) {
      if (!problem.where().file.empty()) throw;
      throw p.error("filename", problem.message());
    }
  });
  return *field_;
}

std::vector<std::string> SplatMedium::transport_notes() const {
  std::vector<std::string> notes;
  if (field().thickened() > 0)
    notes.push_back(note_text(
        properties(), "filename",
        fmt::format(
            "{} of {} splats are thinner than 1/100 of their longest scale: as a medium they are that thick",
            field().thickened(), cloud_->size())));
  if (field().without_extent() > 0)
    notes.push_back(note_text(properties(), "filename",
                              fmt::format("{} of {} splats have no extent: as a medium they are left out",
                                          field().without_extent(), cloud_->size())));
  return notes;
}

void SplatMedium::eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const {
  out = {};
  const SplatField::Sample s = emits_by_direction() ? field().seen_along(p, d) : field().at(p);
  if (!(s.extinction > 0)) return;
  out.sigma_t = s.extinction;
  const Spectrum color = ColorBasis(w.nm).eval(s.color);
  if (color_emits_)
    out.emission = color * d65_.eval(w) * emission_scale_;
  else
    out.sigma_s = min(color, s.extinction);
}

std::vector<ParameterDoc> SplatMedium::rows() {
  return {
      {"filename", "file", "", "required",
       "the splats: PLY of 3D Gaussian splatting or of points, .splat, .spz, glTF with KHR_gaussian_splatting, OpenUSD (.usda)"},
      {"to_world", "transform", "", "identity",
       "from the axes of the cloud (x right, y up, z back) to the world"},
      {"file_axes", "string", "", "file",
       "axes of the file instead of those of its format (PLY and .splat RDF, .spz RUB, points and glTF as RUB): three letters, "
       "the directions in which x, y and z increase; \"RUB\" takes the numbers as they are"},
      {"radius", "float", "file units", "0", "radius of points whose file states none"},
      {"radius_scale", "float", "", "1", "factor of the radii of points"},
      {"color_is", "string", "", "albedo",
       "for integrators that follow light: \"emission\", the colour (times D65, as an <rgb> emitter) is emitted wherever light is "
       "absorbed, by direction; \"albedo\", it is the single-scattering albedo, the same in all directions (harmonics of degree 0)"},
      {"emission_scale", "float", "", "1", "factor of the emitted light, also in `splat`"},
      {"opacity_along", "string", "", "shortest",
       "a splat has its opacity along a ray through its centre: \"shortest\", along its shortest scale; \"mean\", along one of the "
       "geometric mean of its scales"},
      {"cutoff", "float", "standard deviations", "3", "where a splat ends as a medium"},
      {"extinction_scale", "float", "", "1", "factor of the extinction"},
      {"sampling_weight", "float", "", "0",
       "factor of the probability that light sampling chooses this medium's emission; 0: never"},
      {"phase", "phase", "", "isotropic", "phase function of the scattered light"}};
}

namespace {

AUREOLE_PLUGIN(
    SplatMedium, "medium", "splats",
    PluginDoc{
        "Gaussian splats or points of a file. The integrator \"splat\" projects and blends them, as viewers do; every other "
        "integrator follows light through their sum as a medium, so that they are lit, scatter and cast shadows beside "
        "surfaces (docs/splats.md). The shape that holds the medium bounds it for those integrators.",
        "Kerbl, Kopanas, Leimkuehler & Drettakis 2023, \"3D Gaussian splatting for real-time radiance field rendering\"; "
        "Condor and others 2025, \"Don't splat your Gaussians\"",
        SplatMedium::rows(),
        {R"(<medium type="splats">
    <string name="filename" value="cloud.ply"/>
    <transform name="to_world"><scale value="2"/></transform>
    <string name="file_axes" value="RUB"/>
    <float name="radius" value="0.01"/> <float name="radius_scale" value="1"/>
    <string name="color_is" value="emission"/>
    <float name="emission_scale" value="1"/>
    <string name="opacity_along" value="mean"/>
    <float name="cutoff" value="3"/> <float name="extinction_scale" value="1"/>
    <float name="sampling_weight" value="0"/>
    <phase type="hg"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
