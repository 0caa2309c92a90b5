// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/splat_settings.h"

#include <bit>

#include "aureole/core/random.h"
#include "aureole/integrator/splat/blended_light.h"

namespace aureole {

SplatSettings SplatSettings::read(const Properties& p) {
  SplatSettings s;
  const std::vector<std::string> footprints = {"3dgs", "point", "disc", "gaussian", "ewa"};
  const std::string footprint = p.get_choice("footprint", "3dgs", footprints);
  s.footprint = Footprint(std::find(footprints.begin(), footprints.end(), footprint) - footprints.begin());
  s.normalization = p.get_choice("normalization", "weights", {"weights", "none"}) == "none"
                        ? Normalization::none
                        : Normalization::weights;
  const std::string method = p.get_choice("method", "auto", {"auto", "projection", "rays"});
  s.method = method == "auto" ? Method::automatic : method == "rays" ? Method::rays : Method::projection;
  const std::string sorting = p.get_choice("sorting", "file", {"file", "z_depth", "camera_distance"});
  if (sorting != "file")
    s.sorting = sorting == "z_depth" ? SplatHints::Sorting::z_depth : SplatHints::Sorting::camera_distance;
  const std::string projection = p.get_choice("projection", "file", {"file", "perspective", "tangential"});
  if (projection != "file")
    s.projection =
        projection == "tangential" ? SplatHints::Projection::tangential : SplatHints::Projection::perspective;
  const std::string colors = p.get_choice("color_space", "file", {"file", "srgb", "linear"});
  if (colors != "file") s.colors = colors == "srgb" ? SplatHints::Colors::srgb : SplatHints::Colors::linear;
  const std::string compensation = p.get_choice("compensation", "file", {"file", "on", "off"});
  s.compensation = compensation == "file" ? Compensation::file
                   : compensation == "on" ? Compensation::on
                                          : Compensation::off;
  const bool is_ewa = s.footprint == Footprint::ewa;
  s.dilation = float(p.get_float("dilation", s.blends() ? 0.3 : is_ewa ? 1 : 0, {0, 1e4}));
  s.cutoff = float(p.get_float("cutoff", 0, {0, 20}));
  s.opacity_cap = float(p.get_float("opacity_cap", 0.99, {0, 1}));
  s.opacity_limit = float(p.get_float("opacity_limit", 1. / 255, {0, 1}));
  s.termination = float(p.get_float("termination", 1e-4, {0, 0.5}));
  s.near = float(p.get_float("near", s.blends() ? 0.2 : 0, Range::non_negative()));
  s.jacobian_limit = float(p.get_float("jacobian_limit", 1.3, {1, 1e6}));
  s.depth_range = float(p.get_float("depth_range", 2, Range::non_negative()));
  s.at_pixel_center =
      p.get_choice("evaluated_at", "pixel_center", {"pixel_center", "sample"}) == "pixel_center";
  s.background = read_background(p);
  const auto only_for = [&](bool applies, std::initializer_list<const char*> names, const char* shown) {
    for (const char* name : names)
      if (!applies && p.has(name))
        throw p.error(name, std::string("has no effect on this footprint; it is for ") + shown);
  };
  only_for(s.blends(), {"opacity_cap", "opacity_limit", "termination", "compensation", "background"},
           "\"3dgs\"");
  only_for(!s.blends(), {"normalization", "depth_range"}, "\"point\", \"disc\", \"gaussian\" and \"ewa\"");
  only_for(s.blends() || s.footprint == Footprint::gaussian || is_ewa, {"cutoff"},
           "\"3dgs\", \"gaussian\" and \"ewa\"");
  only_for(s.blends() || is_ewa, {"dilation"}, "\"3dgs\" and \"ewa\"");
  if (!s.blends() && s.method == Method::rays)
    throw p.error("method", "\"rays\" is for the footprint \"3dgs\"");
  if (s.method == Method::rays)
    for (const char* name :
         {"sorting", "projection", "compensation", "dilation", "jacobian_limit", "evaluated_at"})
      if (p.has(name))
        throw p.error(
            name, "has no effect on rays, which see splats as they are; it is for the method \"projection\"");
  if (!s.blends() && s.projection == SplatHints::Projection::tangential)
    throw p.error("projection", "\"tangential\" is for the footprint \"3dgs\"");
  return s;
}

std::uint64_t SplatSettings::key() const {
  std::uint64_t k = 0;
  const auto add = [&](std::uint64_t bits) { k = combine_bits(k, bits); };
  const auto number = [&](float f) { add(std::bit_cast<std::uint32_t>(f)); };
  const auto choice = [&](const auto& o) { add(o ? 1 + std::uint64_t(*o) : 0); };
  add(std::uint64_t(method)), add(std::uint64_t(footprint)), add(std::uint64_t(normalization)),
      add(std::uint64_t(compensation));
  choice(sorting), choice(projection), choice(colors);
  for (const float f :
       {dilation, cutoff, opacity_cap, opacity_limit, termination, near, jacobian_limit, depth_range})
    number(f);
  add(at_pixel_center);
  if (background) number(background->x), number(background->y), number(background->z);
  return k;
}

std::vector<ParameterDoc> SplatSettings::rows() {
  return {
      {"footprint", "string", "", "3dgs",
       "3dgs: splats are blended by their opacities in the order of depth. The others interpolate the points of the first "
       "surface: point, one pixel each; disc, an ellipse of the point's radius; gaussian, round in the picture, with the "
       "radius as standard deviation; ewa, the Gaussian of the tangential disc after projection and a low-pass filter"},
      {"normalization", "string", "", "weights",
       "of the interpolating footprints: weights, the sum of colours is divided by that of the weights, so that a constant stays "
       "constant; none, the sum itself"},
      {"method", "string", "", "auto",
       "projection: splats are projected and sorted once for the picture, which needs a sensor \"perspective\"; rays: each ray sees a "
       "splat by the largest value of its Gaussian along it, in the order of these places, for every sensor and without dilation; "
       "auto: projection where the sensor allows it"},
      {"sorting", "string", "", "file",
       "z_depth, by depth along the optical axis (3D Gaussian splatting, OpenUSD), or camera_distance (KHR_gaussian_splatting); "
       "file: as the file or its format says, z_depth for all but glTF"},
      {"projection", "string", "", "file",
       "perspective: linearised about the centre of the splat in the picture plane; tangential: on the plane that is tangential "
       "to the sphere about the camera; file: as the file says, perspective for most"},
      {"color_space", "string", "", "file",
       "of the colours that are blended: srgb, encoded as sRGB, decoded after blending (point footprints: before); linear; file: "
       "as the file says, srgb for all formats of splats that say nothing"},
      {"compensation", "string", "", "file",
       "opacities times the ratio of areas before and after dilation (Mip-Splatting): on, off; file: where the file says that it "
       "was trained so"},
      {"dilation", "float", "pixels^2", "0.3 (3dgs), 1 (ewa)",
       "variance that is added to the projection of a splat"},
      {"cutoff", "float", "standard deviations", "0",
       "where footprints end; 0: of 3dgs as the format says (3 for glTF), else 10/3, where an opaque splat has the opacity 1/255; of "
       "gaussian and ewa 1, the radius of the point"},
      {"opacity_cap", "float", "", "0.99", "largest opacity of a splat at a pixel; gsplat has 0.999"},
      {"opacity_limit", "float", "", "0.00392157 (1/255)",
       "a splat is left out at pixels where its opacity is smaller"},
      {"termination", "float", "", "0.0001",
       "blending ends before the splat that would leave less of the light behind"},
      {"near", "float", "length", "0.2 (3dgs), 0",
       "splats whose depth is not larger are left out; gsplat has 0.01"},
      {"jacobian_limit", "float", "", "1.3",
       "the perspective of splats beyond the border of the picture is that of the border, times this factor in tangents"},
      {"depth_range", "float", "radii", "2",
       "points that lie behind the first one by at most this many of its radii belong to the same surface"},
      {"evaluated_at", "string", "", "pixel_center",
       "pixel_center: all samples of a pixel show its centre, as published; sample: each shows its own place on the film, which "
       "averages over the pixel"},
      {"background", "string", "", "none",
       "red, green and blue, blended behind the splats in their colour space, as published; nothing else is seen then. Without "
       "it, colours are decoded by themselves and what is behind shows through by the transmittance"},
      {"integrator", "integrator", "", "path", "what is seen behind the splats and through them"}};
}

}  // namespace aureole
