// SPDX-License-Identifier: Apache-2.0
#include "harness/oracle_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace aureole::testing {

namespace {

std::string matrix(const Double3& x, const Double3& y, const Double3& z, const Double3& origin) {
  return fmt::format(
      "<transform name=\"to_world\">"
      "<matrix value=\"{} {} {} {} {} {} {} {} {} {} {} {} 0 0 0 1\"/></transform>",
      x.x, y.x, z.x, origin.x, x.y, y.y, z.y, origin.y, x.z, y.z, z.z, origin.z);
}

std::string material_xml(const Material& m) {
  switch (m.kind) {
    case Material::Kind::lambert:
      return "<bsdf type=\"diffuse\">" + m.reflectance.xml("reflectance") + "</bsdf>";
    case Material::Kind::mirror:
      return "<bsdf type=\"conductor\">" + m.reflectance.xml("specular_reflectance") + "</bsdf>";
    case Material::Kind::phong:
      return "<bsdf type=\"test_spectral_phong\">" + m.reflectance.xml("diffuse_reflectance") +
             m.glossy.xml("glossy_reflectance") + m.exponent.xml("exponent") +
             m.diffuse_share.xml("diffuse_share") + "</bsdf>";
  }
  return {};
}

}  // namespace

double Curve::exact(int nm) const {
  const auto after = points_.upper_bound(nm), before = std::prev(after);
  const double t = double(nm - before->first) / (after->first - before->first);
  return before->second + t * (after->second - before->second);
}

double Curve::node(int nm) const {
  // Integral of the spectrum times a hat, of which the first and the last node have halves.
  if (nm == 360) return (2 * exact(360) + exact(361)) / 3;
  if (nm == 830) return (2 * exact(830) + exact(829)) / 3;
  return (exact(nm - 1) + 4 * exact(nm) + exact(nm + 1)) / 6;
}

double Curve::operator()(double nm) const {
  const int below = std::clamp(int(nm), 360, 829);
  const double a = node(below), b = node(below + 1);
  return a + (b - a) * (nm - below);
}

Curve Curve::scaled(double factor) const {
  Curve result = *this;
  for (auto& [nm, value] : result.points_) value *= factor;
  return result;
}

std::string Curve::xml(const std::string& name) const {
  std::string text;
  for (const auto& [nm, value] : points_) text += fmt::format("{}{}:{}", text.empty() ? "" : ", ", nm, value);
  return fmt::format("<spectrum name=\"{}\" value=\"{}\"/>", name, text);
}

double Pinhole::pixel_size() const { return 2 * std::tan(field_of_view * M_PI / 360) / width; }

std::string ClosedFormScene::xml(const std::string& integrator) const {
  std::string text = "<scene version=\"3.0.0\">" + integrator;
  text += fmt::format(
      "<sensor type=\"perspective\"><float name=\"fov\" value=\"{}\"/>"
      "<float name=\"near_clip\" value=\"1e-4\"/>{}"
      "<sampler type=\"sobol\"/><film type=\"hdrfilm\"><integer name=\"width\" value=\"{}\"/>"
      "<integer name=\"height\" value=\"{}\"/><rfilter type=\"box\"/></film></sensor>",
      camera.field_of_view, matrix(camera.left, camera.up, camera.forward, camera.p), camera.width,
      camera.height);
  for (std::size_t i = 0; i < rectangles.size(); ++i) {
    const Rectangle& r = rectangles[i];
    text +=
        fmt::format("<shape type=\"rectangle\" id=\"r{}\">{}{}{}</shape>", i,
                    matrix(r.half_x, r.half_y, r.normal(), r.center), material_xml(r.material),
                    r.radiance ? "<emitter type=\"area\">" + r.radiance->xml("radiance") + "</emitter>" : "");
  }
  if (point)
    text += fmt::format("<emitter type=\"point\"><point name=\"position\" value=\"{}, {}, {}\"/>{}</emitter>",
                        point->p.x, point->p.y, point->p.z, point->intensity.xml("intensity"));
  if (sky) text += "<emitter type=\"constant\">" + sky->xml("radiance") + "</emitter>";
  if (fog) {
    const Double3 half = (fog->upper - fog->lower) * 0.5, center = (fog->upper + fog->lower) * 0.5;
    text += fmt::format(
        "<shape type=\"cube\" id=\"fog\">{}<bsdf type=\"null\"/>"
        "<medium name=\"interior\" type=\"homogeneous\">{}{}"
        "<phase type=\"hg\"><float name=\"g\" value=\"{}\"/></phase></medium></shape>",
        matrix({half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}, center), fog->scattering.xml("sigma_s"),
        fog->absorption.xml("sigma_a"), fog->mean_cosine);
  }
  return text + "</scene>";
}

}  // namespace aureole::testing
