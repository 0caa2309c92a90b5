// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/settings.h"

#include <algorithm>

#include "aureole/plugin/number_list.h"

namespace aureole {

namespace {

const std::vector<std::string> kMethods = {
    "composite", "emission_absorption", "single_scattering", "isosurface", "mip", "average", "xray"};

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
  s.jitter = p.get_bool("jitter", false);
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
  const bool is_isosurface = s.method == Method::isosurface;
  if (is_isosurface && s.isovalues.empty())
    throw p.error("isovalues",
                  "is missing: the numbers of the volume where its surfaces lie, such as \"0.2, 0.5\"");
  if (!is_isosurface && !s.isovalues.empty()) throw p.error("isovalues", "is for the method \"isosurface\"");
  const bool is_lit = s.gradient_lighting || s.method == Method::single_scattering;
  for (const auto& [name, needed] : {std::pair{"shadows", is_lit},
                                     {"ambient_occlusion", s.gradient_lighting},
                                     {"highlight", s.gradient_lighting}})
    if (p.has(name) && !needed)
      throw p.error(name, "has no effect without <string name=\"lighting\" value=\"gradient\"/>");
  if (s.gradient_lighting && (s.method == Method::mip || s.method == Method::average ||
                              s.method == Method::xray || s.method == Method::single_scattering))
    throw p.error("lighting",
                  "gradient shading is for the methods composite, emission_absorption and isosurface");
  const bool is_discrete = s.method == Method::composite;
  for (const char* name : {"form", "alpha", "order"})
    if (p.has(name) && !is_discrete) throw p.error(name, "is for the method \"composite\"");
  if (s.order == Order::back_to_front && p.has("termination") && s.termination > 0)
    throw p.error("termination", "ends rays early from front to back alone; give 0 with \"back_to_front\"");
  return s;
}

std::vector<ParameterDoc> DvrSettings::rows() {
  return {
      {"method", "string", "", "composite",
       "composite: step by step; emission_absorption and single_scattering: the integral along the ray to a `tolerance`, the latter "
       "with the light that the scene's lights bring to each point and the medium scatters once; isosurface; mip: the colour "
       "of the largest number along the ray; average: that of the mean number; xray: the part of a uniform light behind the volume that passes"},
      {"form", "string", "", "opacity_weighted",
       "premultiplied: the colour of a step is the light that it emits, Max and others' C; opacity_weighted: that colour times the opacity of the step"},
      {"alpha", "string", "", "exponential",
       "opacity of a step of optical thickness t: exponential, 1 - exp(-t), or taylor, t (at most 1)"},
      {"order", "string", "", "front_to_back", "front_to_back or back_to_front: equal within rounding"},
      {"classification", "string", "", "post",
       "post: the transfer function of the number in the middle of the step; preintegrated: its mean over all numbers between both ends"},
      {"step", "float", "length", "half a voxel", "length of a step along the ray; the last one is shorter"},
      {"jitter", "boolean", "", "false",
       "samples lie at a random place of their steps, the same one along a ray, instead of the middle"},
      {"skip_empty", "boolean", "", "true",
       "blocks of the volume that are transparent are skipped, which does not change the picture"},
      {"termination", "float", "", "0.001",
       "a ray ends where so little of the light behind would arrive: the error is at most this part of the light left out; 0: never"},
      {"tolerance", "float", "", "0.001",
       "relative error at which emission_absorption and single_scattering stop halving their steps"},
      {"lighting", "string", "", "none",
       "gradient: the scene's lights shade the volume by the gradient of its numbers, with the coefficients of the medium"},
      {"highlight", "string", "", "halfway",
       "specular lobe about the halfway vector (Levoy 1988, Blinn) or the reflection (Phong, as in VTK)"},
      {"shadows", "boolean", "", "false",
       "lights are attenuated by all media and surfaces between; single_scattering always has it"},
      {"ambient_occlusion", "integer", "", "0",
       "rays that find how much of the ambient light arrives; 0: all of it"},
      {"occlusion_radius", "float", "length", "required with ambient_occlusion", "length of these rays"},
      {"isovalues", "string", "", "required for isosurface", "numbers of the volume at its surfaces"},
      {"integrator", "integrator", "", "path", "what is seen behind the volume and through it"}};
}

}  // namespace aureole
