// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "aureole/plugin/number_list.h"

namespace aureole {

namespace {

const std::vector<std::string> kMethods = {
    "composite", "emission_absorption", "single_scattering", "isosurface", "mip", "average", "xray",
    "splatting"};

}  // namespace

DvrSettings DvrSettings::read(const Properties& p) {
  DvrSettings s;
  const std::string method = p.get_choice("method", "composite", kMethods);
  s.method = Method(std::find(kMethods.begin(), kMethods.end(), method) - kMethods.begin());
  s.form = p.get_choice("form", "opacity_weighted", {"premultiplied", "opacity_weighted"}) == "premultiplied"
               ? Form::premultiplied
               : Form::opacity_weighted;
  s.alpha = p.get_choice("alpha", "exponential", {"exponential", "taylor"}) == "taylor" ? Alpha::taylor
                                                                                        : Alpha::exponential;
  s.order = p.get_choice("order", "front_to_back", {"front_to_back", "back_to_front"}) == "back_to_front"
                ? Order::back_to_front
                : Order::front_to_back;
  s.preintegrated = p.get_choice("classification", "post", {"post", "preintegrated"}) == "preintegrated";
  const std::string steps = p.get_choice("steps", "fixed", {"fixed", "adaptive", "by_opacity"});
  s.steps = steps == "fixed" ? Steps::fixed : steps == "adaptive" ? Steps::adaptive : Steps::by_opacity;
  s.step_opacity = float(p.get_float("step_opacity", 0.02, {1e-5, 1}));
  s.sheets = p.get_choice("sheets", "axis", {"axis", "image"}) == "image" ? Sheets::image : Sheets::axis;
  s.kernel_width = float(p.get_float("kernel_width", 0.6, {0.3, 3}));
  s.jitter = p.get_bool("jitter", false);
  s.interleaves = p.get_choice("jitter_pattern", "random", {"random", "interleaved"}) == "interleaved";
  s.skip_empty = p.get_bool("skip_empty", true);
  s.step = float(p.get_float("step", 0, Range::non_negative()));
  s.termination = float(p.get_float("termination", 1e-3, {0, 0.5}));
  s.tolerance = float(p.get_float("tolerance", 1e-3, {1e-6, 0.5}));
  s.gradient_lighting = p.get_choice("lighting", "none", {"none", "gradient"}) == "gradient";
  s.halfway = p.get_choice("highlight", "halfway", {"halfway", "reflection"}) == "halfway";
  s.shadows = p.get_bool("shadows", false);
  s.occlusion_samples = int(p.get_int("ambient_occlusion", 0, {0, 1024}));
  s.occlusion_radius = float(p.get_float("occlusion_radius", 0, Range::non_negative()));
  if (s.occlusion_samples > 0 && !(s.occlusion_radius > 0))
    throw p.error("occlusion_radius",
                  "is missing: the length of the rays of ambient occlusion, in units of the scene");
  if (p.has("isovalues"))
    for (const double value : get_number_list(p, "isovalues")) s.isovalues.push_back(float(value));
  std::sort(s.isovalues.begin(), s.isovalues.end());
  if (s.method == Method::isosurface && s.isovalues.empty())
    throw p.error("isovalues",
                  "is missing: the numbers of the volume where its surfaces lie, such as \"0.2, 0.5\"");
  using enum Method;
  const auto only_for = [&](std::initializer_list<const char*> names, std::initializer_list<Method> methods,
                            const char* shown) {
    if (std::find(methods.begin(), methods.end(), s.method) != methods.end()) return;
    for (const char* name : names)
      if (p.has(name)) throw p.error(name, std::string("has no effect on this method; it is for ") + shown);
  };
  only_for({"lighting"}, {composite, isosurface}, "composite and isosurface");
  only_for({"classification"}, {composite, single_scattering, xray}, "composite, single_scattering and xray");
  only_for({"skip_empty"}, {composite, emission_absorption, single_scattering, xray},
           "those that composite steps");
  only_for({"termination"}, {composite, emission_absorption, single_scattering, isosurface, splatting},
           "those that composite");
  only_for({"step"}, {composite, emission_absorption, single_scattering, mip, average, xray, splatting},
           "those that take steps");
  only_for({"jitter"}, {composite, mip, average, xray}, "composite, mip, average and xray");
  if (s.steps != Steps::adaptive)
    only_for({"tolerance"}, {emission_absorption}, "emission_absorption and adaptive steps");
  if (s.steps != Steps::fixed) only_for({"steps"}, {composite, xray}, "composite and xray");
  if (p.has("step_opacity") && s.steps != Steps::by_opacity)
    throw p.error("step_opacity", "has no effect without <string name=\"steps\" value=\"by_opacity\"/>");
  only_for({"sheets", "kernel_width"}, {splatting}, "splatting");
  if (p.has("step") && s.method == splatting && s.sheets == Sheets::axis)
    throw p.error("step",
                  "is the distance of sheets parallel to the image; those of <string name=\"sheets\" "
                  "value=\"axis\"/> are the layers of voxels");
  only_for({"isovalues"}, {isosurface}, "isosurface");
  only_for({"form", "alpha", "order"}, {composite}, "composite");
  only_for({"shadows", "ambient_occlusion", "occlusion_radius"}, {composite},
           "composite, with lighting \"gradient\"");
  for (const char* name : {"shadows", "ambient_occlusion", "highlight"})
    if (p.has(name) && !s.gradient_lighting)
      throw p.error(name, "has no effect without <string name=\"lighting\" value=\"gradient\"/>");
  if (p.has("occlusion_radius") && s.occlusion_samples == 0)
    throw p.error("occlusion_radius", "has no effect without \"ambient_occlusion\", the number of rays");
  if (s.steps != Steps::fixed) {
    const auto refuse = [&](const char* name, bool is_wrong, const char* message) {
      if (is_wrong) throw p.error(name, fmt::format("steps \"{}\" {}", steps, message));
    };
    refuse("order", s.order == Order::back_to_front, "go from front to back");
    refuse("form", s.form == Form::premultiplied, "need the form \"opacity_weighted\"");
    refuse("alpha", s.alpha == Alpha::taylor, "need an exponential alpha");
    refuse("skip_empty", !s.skip_empty, "need the blocks that are skipped");
  }
  if (s.steps == Steps::adaptive) {
    if (s.jitter)
      throw p.error("jitter", "has no effect on adaptive steps, whose samples are their ends and middles");
    if (p.has("classification") && !s.preintegrated)
      throw p.error("classification",
                    "adaptive steps take the mean of the function between two samples, \"preintegrated\"");
    s.preintegrated = true;
  }
  if (s.method == single_scattering) s.jitter = true;
  if (p.has("jitter_pattern") && !s.jitter)
    throw p.error("jitter_pattern", "has no effect without <boolean name=\"jitter\" value=\"true\"/>");
  if (s.method == xray) s.termination = 0;
  // The adaptive integral leaves out less light than its tolerance, and finds narrow functions.
  if (s.method == emission_absorption)
    s.termination = std::min(s.termination, 0.1f * s.tolerance), s.preintegrated = true;
  if (s.order == Order::back_to_front && p.has("termination") && s.termination > 0)
    throw p.error("termination", "ends rays early from front to back alone; give 0 with \"back_to_front\"");
  return s;
}

std::vector<ParameterDoc> DvrSettings::rows() {
  return {
      {"method", "string", "", "composite",
       "composite: step by step; emission_absorption: the integral along the ray to a `tolerance`; single_scattering: step by "
       "step, with `jitter`, the light that the scene's lights bring to each point and the medium scatters once; isosurface; "
       "mip: the colour of the largest number along the ray; average: that of the mean number; xray: the part of a uniform "
       "light behind the volume that passes; splatting: the voxels' extinction and colour, spread by a Gaussian kernel and added "
       "up on sheets (Westover 1990)"},
      {"form", "string", "", "opacity_weighted",
       "premultiplied: the colour of a step is the light that it emits, Max and others' C; opacity_weighted: that colour times the opacity of the step"},
      {"alpha", "string", "", "exponential",
       "opacity of a step of optical thickness t: exponential, 1 - exp(-t), or taylor, t (at most 1)"},
      {"order", "string", "", "front_to_back", "front_to_back or back_to_front: equal within rounding"},
      {"classification", "string", "", "post",
       "post: the transfer function of the number in the middle of the step; preintegrated: its mean over all numbers between both ends"},
      {"step", "float", "length", "half a voxel",
       "length of a step along the ray; the last one is shorter. A ray has at most 1,048,576 steps, else they are longer. Adaptive "
       "steps begin with it; splatting: distance of sheets parallel to the image (default: a voxel)"},
      {"steps", "string", "", "fixed",
       "fixed: all of the length `step`; by_opacity: from `step` to 8 times that length, so that none can absorb more than the part "
       "`step_opacity` of the light from behind, by the bound of its block (one volume); adaptive: from a 64th to 8 times `step`, "
       "so that the estimated error of a ray's light, in units of the light of white, and of its transmittance stays below `tolerance`"},
      {"step_opacity", "float", "", "0.02",
       "largest part of the light from behind that a step by_opacity can absorb"},
      {"jitter", "boolean", "", "false",
       "samples lie at a random place of their steps, the same one along a ray, instead of the middle; the places of the samples "
       "of a pixel are spread evenly"},
      {"jitter_pattern", "string", "", "random",
       "random: the places of each pixel are shifted at random; interleaved: by the R2 sequence over the pixels, so that errors of "
       "neighbouring pixels cancel (Keller & Heidrich 2001), the same pattern for every seed"},
      {"skip_empty", "boolean", "", "true",
       "blocks of the volume that are transparent are skipped, which does not change the picture"},
      {"termination", "float", "", "0.001",
       "a ray ends where less than this part of the light from behind would arrive, which is then left out; 0: never"},
      {"tolerance", "float", "", "0.001",
       "relative error at which emission_absorption stops halving its steps; estimated error of adaptive steps"},
      {"sheets", "string", "", "axis",
       "splatting: axis, the layers of voxels across the axis of the grid that is nearest to the sensor's direction, or image, "
       "slabs parallel to the image, to which the kernels' parts within them are added (Mueller & Crawfis 1998)"},
      {"kernel_width", "float", "voxels", "0.6",
       "splatting: standard deviation of the Gaussian kernel, cut at 4 of them"},
      {"lighting", "string", "", "none",
       "gradient: the scene's lights shade the volume by the gradient of its numbers, with the coefficients of the medium; both "
       "sides of a surface are shaded alike"},
      {"highlight", "string", "", "halfway",
       "specular lobe about the halfway vector (Levoy 1988, Blinn) or the reflection (Phong, as in VTK)"},
      {"shadows", "boolean", "", "false",
       "lights are attenuated by all volumes, and blocked by surfaces, between; single_scattering always has it"},
      {"ambient_occlusion", "integer", "", "0",
       "rays that find how much of the ambient light arrives; 0: all of it"},
      {"occlusion_radius", "float", "length", "required with ambient_occlusion", "length of these rays"},
      {"isovalues", "string", "", "required for isosurface", "numbers of the volume at its surfaces"},
      {"integrator", "integrator", "", "path", "what is seen behind the volume and through it"}};
}

}  // namespace aureole
