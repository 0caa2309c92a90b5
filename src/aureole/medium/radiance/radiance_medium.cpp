// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/radiance/radiance_medium.h"

#include <algorithm>

#include "aureole/core/image.h"
#include "aureole/medium/classified/transfer_function.h"
#include "aureole/medium/content/extinction_limit.h"
#include "aureole/spectrum/observer.h"

namespace aureole {

RadianceMedium::RadianceMedium(const Properties& p)
    : Medium(p),
      emission_scale_(float(p.get_float("emission_scale", 1, Range::non_negative()))),
      sampling_weight_(float(p.get_float("sampling_weight", 0, Range::non_negative()))),
      d65_(d65_spectrum(p.context().grid, 1)),
      phase_(make_default<PhaseFunction>(p, "phase")) {
  const std::filesystem::path file = p.get_file("filename");
  const Transform to_world = p.get_transform("to_world");
  const float scale = float(p.get_float("extinction_scale", 1, Range::positive()));
  const std::string colors = p.get_choice("color_space", "file", {"file", "srgb", "linear"});
  try {
    auto voxels = std::make_shared<const RadianceVoxels>(read_radiance_voxels(file));
    for (const std::string& note : voxels->notes) p.note("filename", "\"" + file.string() + "\" " + note);
    is_encoded_ = colors == "file" ? !voxels->is_linear : colors == "srgb";
    auto field = std::make_unique<const RadianceField>(std::move(voxels), to_world, scale);
    float along = 0;
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      along = std::max(along, field->extinction_along(axis));
    require_computable_extinction(p, "filename", field->grid(), 0, double(along));
    if (!(field->grid().maximum() > 0))
      throw p.error("filename", "\"" + file.string() + "\" has no density above 0: nothing would be seen");
    field_ = std::move(field);
  } catch (const Error& problem) {
    if (problem.where().file != file.string()) throw;
    throw p.error("filename", problem.what());
  }
}

void RadianceMedium::eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const {
  out = {};
  RadianceField::Cell cell;
  if (!field_->find_cell(field_->index_of(p), cell)) return;
  const float density = field_->raw_density(cell);
  if (!(density > 0)) return;
  const float extinction = density * field_->extinction_along(d);
  out.sigma_t = extinction;
  const Vec3 color = field_->raw_color(cell, field_->view_along(d));
  float rgb[3];
  for (int k = 0; k < 3; ++k) {
    rgb[k] = std::max(0.f, color[k]);
    if (is_encoded_) rgb[k] = srgb_decode(rgb[k]);
  }
  out.emission = ColorBasis(w.nm).eval(ColorWeights::of_linear_rgb(rgb[0], rgb[1], rgb[2])) * d65_.eval(w) *
                 (extinction * emission_scale_);
}

namespace {

AUREOLE_PLUGIN(
    RadianceMedium, "medium", "radiance_grid",
    PluginDoc{
        "A radiance grid: density and colour by direction (spherical harmonics of degree 0 to 3) at the voxels of a sparse grid, "
        "interpolated trilinearly. The integrator \"radiance_field\" composites it by the discrete sum of NeRF or exactly; every "
        "other integrator follows light through it as through a medium that absorbs and emits, beside surfaces "
        "(docs/splats.md). The shape that holds the medium bounds it for those integrators.",
        "Fridovich-Keil, Yu and others 2022, \"Plenoxels: radiance fields without neural networks\"; Mildenhall and others 2020, "
        "\"NeRF: representing scenes as neural radiance fields for view synthesis\"",
        {{"filename", "file", "", "required",
          "archive of numpy (.npz) with the arrays of Plenoxels: links, density_data, sh_data, radius, center; or OpenVDB (.vdb) or "
          "NanoVDB (.nvdb) with the numbers \"density\" and the vectors \"sh_0\", \"sh_1\", ..., coefficients of harmonics, or \"color\" "
          "or \"Cd\", linear colours"},
         {"to_world", "transform", "", "identity",
          "from the coordinates of the grid to the world; densities are per length of the grid's coordinates"},
         {"color_space", "string", "", "file",
          "of the grid's colours: srgb, encoded as the photographs that it was fitted to; linear; file: linear for \"color\" and \"Cd\" "
          "of OpenVDB, else srgb"},
         {"emission_scale", "float", "", "1", "factor of the emitted light"},
         {"extinction_scale", "float", "", "1", "factor of the density"},
         {"sampling_weight", "float", "", "0",
          "factor of the probability that light sampling chooses this medium's emission; 0: never"}},
        {R"(<medium type="radiance_grid">
    <string name="filename" value="grid.npz"/>
    <transform name="to_world"><scale value="2"/></transform>
    <string name="color_space" value="linear"/>
    <float name="emission_scale" value="1"/> <float name="extinction_scale" value="1"/>
    <float name="sampling_weight" value="0"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
