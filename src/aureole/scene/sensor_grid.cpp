// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/sensor_grid.h"

#include <algorithm>
#include <optional>

#include "aureole/core/units.h"
#include "aureole/scene/overrides.h"
#include "aureole/scene/values.h"

namespace aureole {

namespace {

struct WavelengthRange {
  double min_nm = kInfinity, max_nm = 0;
  void extend(double nm) { min_nm = std::min(min_nm, nm), max_nm = std::max(max_nm, nm); }
  void extend(const WavelengthRange& r) { extend(r.min_nm), extend(r.max_nm); }
};
const WavelengthRange kVisible{SpectralGrid().min_nm, SpectralGrid().max_nm};

std::string value_of(const Node& object, std::string_view name) {
  for (const Node& child : object.children)
    if (child.get("name") == name) return child.get("value");
  return "";
}

WavelengthRange range_of_list(std::string_view text) {
  WavelengthRange r;
  for (std::string_view word : split_list(text)) r.extend(parse_wavelength_nm(word));
  return r;
}

/// Where a response is defined, as Mitsuba has it. May throw: the reader of the value reports it.
WavelengthRange range_of_response(const Node& node) {
  if (node.find("type")) {
    if (node.get("type") == "regular")
      return {parse_number(value_of(node, "wavelength_min")), parse_number(value_of(node, "wavelength_max"))};
    if (node.get("type") == "irregular") return range_of_list(value_of(node, "wavelengths"));
    return kVisible;
  }
  const SpectrumLiteral s =
      node.find("filename") ? read_spectrum_file(node.get("filename")) : parse_spectrum(node.get("value"));
  return s.nm.empty() ? kVisible : WavelengthRange{s.nm.front(), s.nm.back()};
}

WavelengthRange range_of_spectral_film(const Node& film, const References& references) {
  WavelengthRange all;
  for (const Node& child : film.children) {
    const auto reference = references.targets.find(&child);
    const Node& node = reference == references.targets.end() ? child : *reference->second;
    try {
      if (node.tag == "spectrum" || node.tag == "texture") all.extend(range_of_response(node));
      if (child.get("name") == "bin_edges") all.extend(range_of_list(node.get("value")));
    } catch (const Error&) {
    }
  }
  return all.min_nm > 0 && all.min_nm < all.max_nm ? all : kVisible;
}

/// The wavelength in nm that a film parameter gives; `fallback` where it is absent or can't be read, which is
/// reported.
double wavelength(Node* film, std::string_view name, double fallback, Diagnostics& diagnostics) {
  Node* node = film ? film->named_child(name) : nullptr;
  Attribute* value = node ? node->find("value") : nullptr;
  if (!value || value->failed) return fallback;
  try {
    const double nm = parse_wavelength_nm(value->value);
    if (!(nm > 0)) throw Error("must be positive, got \"" + value->value + "\"");
    return nm;
  } catch (const Error& e) {
    diagnostics.error(value->where, "parameter \"" + std::string(name) + "\": " + e.message());
    value->failed = true;
    return fallback;
  }
}

}  // namespace

SpectralGrid sensor_grid(Node& root, const References& references, Diagnostics& diagnostics) {
  Node* sensor = first_sensor(root);
  Node* film = sensor ? child_of_family(root, *sensor, "film") : nullptr;
  const bool spectral = film && film->get("type") == "specfilm";
  const WavelengthRange fallback = spectral ? range_of_spectral_film(*film, references) : kVisible;
  const double min_nm = wavelength(film, "wavelength_min", fallback.min_nm, diagnostics);
  const double max_nm = wavelength(film, "wavelength_max", fallback.max_nm, diagnostics);
  if (min_nm < max_nm) return SpectralGrid::over(min_nm, max_nm);
  Node* named = film->named_child("wavelength_min");
  if (!named) named = film->named_child("wavelength_max");
  diagnostics.error(named->where, "wavelength_min (" + number_text(min_nm) +
                                      " nm) must be less than wavelength_max (" + number_text(max_nm) +
                                      " nm)");
  return {};
}

Node* first_sensor(Node& root) {
  for (Node& child : root.children) {
    Node* node = target_of(root, child);
    if (!node) continue;
    if (object_family(*node) == "sensor") return node;
    if (object_family(*node) != "shape") continue;
    if (Node* sensor = child_of_family(root, *node, "sensor")) return sensor;
  }
  return nullptr;
}

}  // namespace aureole
