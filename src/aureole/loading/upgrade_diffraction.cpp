// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade_diffraction.h"

#include <algorithm>
#include <optional>

#include "aureole/core/units.h"
#include "aureole/loading/aliases.h"
#include "aureole/loading/values.h"

namespace aureole {
namespace {

/// Half the width of the film's band over its wavelength. The band is so narrow that the phase differs little
/// over the edges of a beam, which are at most 14 sigma apart. One wavelength then represents the band for
/// sigma below some 50 wavelengths (optics/diffraction/edge_group.cpp).
constexpr double kHalfBand = 5e-6;

void add(Node& owner, const Node& near, std::string_view tag, std::string name, std::string value) {
  owner.children.push_back(
      {std::string(tag),
       {{"name", std::move(name), near.where, false}, {"value", std::move(value), near.where, false}},
       {},
       near.where,
       near.file});
}

Node* child_with_tag(Node& node, std::string_view tag) {
  const auto found =
      std::find_if(node.children.begin(), node.children.end(), [&](const Node& c) { return c.tag == tag; });
  return found == node.children.end() ? nullptr : &*found;
}

/// Returns the wavelength in metres; reports an error unless it is one positive number.
std::optional<double> wavelength(Node& scene, const Node& given, Diagnostics& diagnostics) {
  const Attribute* value = given.find("value");
  if (!value || value->failed) return {};
  try {
    const std::vector<double> numbers = parse_numbers(value->value);
    if (numbers.size() != 1 || !(numbers[0] > 0))
      throw Error(
          "one positive number is read, a length in units of the scene; for several wavelengths use the film "
          "\"specfilm\" with \"bin_edges\"");
    double unit = 1;
    if (const Node* named = scene.named_child("length_unit"))
      unit = parse_length_m("1" + named->get("value"));
    return numbers[0] * unit;
  } catch (const Error& e) {
    diagnostics.error(value->where, "parameter \"wavelengths\": " + e.message());
    return {};
  }
}

/// Replaces grey colours of reflectances and lights by spectra that are constant at all wavelengths; other
/// colours are undefined outside the visible.
void make_grey(Node& node) {
  for (Node& child : node.children) make_grey(child);
  if (node.tag != "rgb") return;
  Attribute* value = node.find("value");
  if (!value || value->failed) return;
  try {
    const std::vector<double> numbers = parse_numbers(value->value);
    if (numbers.empty() || numbers.size() > 3 || numbers.front() != numbers.back() ||
        numbers.front() != numbers[numbers.size() / 2])
      return;
    node.tag = "spectrum";
    value->value = number_text(numbers[0]);
  } catch (const Error&) {  // the reader of colours reports the error
  }
}

}  // namespace

void upgrade_diffraction(Node& scene, Diagnostics& diagnostics) {
  Node* integrator = child_with_tag(scene, "integrator");
  if (!integrator || integrator->get("type") != "bdpt" || !integrator->named_child("wavelengths")) return;
  const Node given = *integrator->named_child("wavelengths");
  const std::optional<double> metres = wavelength(scene, given, diagnostics);
  std::erase_if(integrator->children, [](const Node& c) { return c.get("name") == "wavelengths"; });

  const Node* switched = integrator->named_child("diffraction");
  const bool is_off = switched && switched->get("value") == "false";
  if (!switched) add(*integrator, given, "boolean", "diffraction", "true");
  if (!is_off && !integrator->named_child("diffraction_model") &&
      !integrator->named_child("diffraction_polarisation")) {
    add(*integrator, given, "string", "diffraction_model", "beams");
    diagnostics.note(
        given.where,
        "edges diffract by the published model that this scene is written for, with \"sigma\" and "
        "\"scale\" of its \"freespacediffraction\": state diffraction_model=\"segments\" for the "
        "phases of direct and diffracted light");
  }

  if (!metres) return;
  Node* sensor = child_with_tag(scene, "sensor");
  Node* film = sensor ? child_with_tag(*sensor, "film") : nullptr;
  if (!film || film->get("type") != "hdrfilm") {
    diagnostics.note(
        given.where,
        "\"wavelengths\" is not read here: give the film \"wavelength_min\" and \"wavelength_max\"");
    return;
  }
  if (film->named_child("wavelength_min") || film->named_child("wavelength_max")) return;
  const double nm = *metres * 1e9;
  diagnostics.note(given.where, "\"wavelengths\" becomes the film's band about " + number_text(nm) +
                                    " nm; grey colours are the same there as in the visible range");
  add(*film, given, "string", "wavelength_min", number_text(nm * (1 - kHalfBand)));
  add(*film, given, "string", "wavelength_max", number_text(nm * (1 + kHalfBand)));
  if (!film->named_child("response")) add(*film, given, "string", "response", "uniform");
  make_grey(scene);
}

}  // namespace aureole
