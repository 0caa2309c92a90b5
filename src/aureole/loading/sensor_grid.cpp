// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/sensor_grid.h"

#include <optional>

#include "aureole/core/units.h"
#include "aureole/loading/aliases.h"
#include "aureole/loading/overrides.h"
#include "aureole/loading/values.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Limits in nm: hard gamma rays to waves of 1000 km; the range of single precision ends not far beyond.
constexpr double kShortest = 1e-6, kLongest = 1e15;

/// Returns the parameters of an object and of those below it, before anything is built. Unreadable values are
/// skipped, because they are reported when the object is built.
Properties raw_parameters(const Node& object, const References& references) {
  const PluginInfo* plugin = find_plugin(object_family(object), object.get("type"));
  Properties raw(plugin ? plugin->name : object.get("type"), object.get("id"), object.where, nullptr, plugin);
  Diagnostics unheard;
  for (const Node& child : object.children) {
    const Node* target = references.follow(child);
    std::optional<Properties::Value> value;
    if (is_property(child))
      value = property_value(child, unheard);
    else if (target && !object_family(*target).empty())
      value = std::make_shared<Object>(raw_parameters(*target, references));
    const std::string name = child.get("name");
    if (value && (name.empty() || !raw.has(name))) raw.add(name, std::move(*value), child.where);
  }
  return raw;
}

/// Returns the range that the film's plug-in derives from its parameters, or else the visible range.
WavelengthRange range_of_film(const Node* film, const References& references) {
  const WavelengthRange visible{SpectralGrid().min_nm, SpectralGrid().max_nm};
  const PluginInfo* plugin = film ? find_plugin(object_family(*film), film->get("type")) : nullptr;
  if (!plugin || !plugin->wavelength_range) return visible;
  try {
    const auto stated = plugin->wavelength_range(raw_parameters(*film, references));
    return stated && stated->is_proper() ? *stated : visible;
  } catch (const Error&) {
    return visible;
  }
}

/// Returns the wavelength in nm of a film parameter, or `fallback` if it is absent or cannot be read
/// (reported).
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

SpectralGrid sensor_grid(const References& references, Diagnostics& diagnostics) {
  Node* sensor = first_sensor(references.ids);
  Node* film = sensor ? child_of_family(references.ids, *sensor, "film") : nullptr;
  const WavelengthRange fallback = range_of_film(film, references);
  const double min_nm = wavelength(film, "wavelength_min", fallback.min_nm, diagnostics);
  const double max_nm = wavelength(film, "wavelength_max", fallback.max_nm, diagnostics);
  const bool computable = min_nm >= kShortest && max_nm <= kLongest;
  if (computable && min_nm < max_nm) return SpectralGrid::over(min_nm, max_nm);
  Node* named = film->named_child("wavelength_min");
  if (!named) named = film->named_child("wavelength_max");
  if (!named) named = film;
  if (!computable)
    diagnostics.error(named->where, "wavelengths from " + number_text(min_nm) + " to " + number_text(max_nm) +
                                        " nm: only " + number_text(kShortest) + " to " +
                                        number_text(kLongest) + " nm can be computed with");
  else
    diagnostics.error(named->where, "wavelength_min (" + number_text(min_nm) +
                                        " nm) must be less than wavelength_max (" + number_text(max_nm) +
                                        " nm)");
  return {};
}

}  // namespace aureole
