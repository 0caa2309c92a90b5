// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/amount/emission_amount.h"

#include <fmt/format.h>

#include <cmath>

#include "aureole/core/units.h"
#include "aureole/spectrum/photometry.h"

namespace aureole {

namespace {

using Quantity = EmissionAmount::Quantity;

struct AmountUnit {
  const char* name;
  Quantity quantity;
  bool is_photometric;
  double factor;
};

constexpr double kFootcandle = 10.763910416709722;  // one foot-candle (lm/ft^2) in lx

constexpr AmountUnit kAmountUnits[] = {{"W", Quantity::flux, false, 1},
                                       {"mW", Quantity::flux, false, 1e-3},
                                       {"kW", Quantity::flux, false, 1e3},
                                       {"lm", Quantity::flux, true, 1},
                                       {"klm", Quantity::flux, true, 1e3},
                                       {"W/sr", Quantity::intensity, false, 1},
                                       {"cd", Quantity::intensity, true, 1},
                                       {"kcd", Quantity::intensity, true, 1e3},
                                       {"W/m^2", Quantity::irradiance, false, 1},
                                       {"lx", Quantity::irradiance, true, 1},
                                       {"klx", Quantity::irradiance, true, 1e3},
                                       {"fc", Quantity::irradiance, true, kFootcandle},
                                       {"W/(m^2 sr)", Quantity::radiance, false, 1},
                                       {"cd/m^2", Quantity::radiance, true, 1},
                                       {"kcd/m^2", Quantity::radiance, true, 1e3},
                                       {"nit", Quantity::radiance, true, 1}};

std::vector<std::string> unit_names() {
  std::vector<std::string> names;
  for (const AmountUnit& u : kAmountUnits) names.emplace_back(u.name);
  return names;
}

const char* quantity_name(Quantity quantity, bool is_photometric) {
  switch (quantity) {
    case Quantity::flux:
      return is_photometric ? "luminous flux" : "radiant flux";
    case Quantity::intensity:
      return is_photometric ? "luminous intensity" : "radiant intensity";
    case Quantity::irradiance:
      return is_photometric ? "illuminance" : "irradiance";
    default:
      return is_photometric ? "luminance" : "radiance";
  }
}

}  // namespace

EmissionAmount parse_emission_amount(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == text.npos) throw Error("expected a number with a unit, such as \"800 lm\"");
  text = text.substr(first, text.find_last_not_of(' ') - first + 1);
  const auto end = text.find_first_not_of("+-0123456789.eE");
  std::string_view number = text.substr(0, end), unit;
  if (end != text.npos) unit = text.substr(end);
  while (number.ends_with(' ')) number.remove_suffix(1);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty())
    throw Error("\"" + std::string(text) + "\": a unit is missing, such as \"800 lm\"" +
                did_you_mean_or_all("", unit_names()));
  for (const AmountUnit& u : kAmountUnits)
    if (unit == u.name) {
      const double value = parse_number(number) * u.factor;
      if (!(value > 0 && std::isfinite(value)))
        throw Error("\"" + std::string(text) + "\": must be positive");
      return {u.quantity, u.is_photometric, value};
    }
  throw Error("unknown unit \"" + std::string(unit) + "\"" + did_you_mean_or_all(unit, unit_names()));
}

std::vector<ParameterDoc> with_amount_parameters(std::vector<ParameterDoc> rows, const std::string& units,
                                                 const std::string& meaning) {
  rows.push_back({"amount", "string", units, "none",
                  meaning + "; the spectrum then gives only the relative distribution over wavelengths"});
  rows.push_back(
      {"efficacy", "float", "lm/W", "none",
       "luminous efficacy, at most 683.002, with an amount in W: that is the electrical power, and the luminous flux is "
       "their product"});
  rows.push_back(
      {"color_temperature", "float", "K", "none",
       "with an amount, instead of the spectrum: the spectrum of a black body of this temperature"});
  return rows;
}

double per_square_unit(const Properties& properties) {
  const double unit = properties.context().length_unit_m;
  return 1 / (unit * unit);
}

Emission::Emission(const Properties& p, std::string_view name) : properties_(p), name_(name) {
  if (p.has("amount")) {
    try {
      amount_ = parse_emission_amount(p.get_string("amount"));
    } catch (const Error& e) {
      if (!e.where().file.empty()) throw;
      throw p.error("amount", e.message());
    }
  } else {
    p.find("amount");
  }
  // No light has a higher efficacy than that of 555 nm.
  const double efficacy = p.get_float("efficacy", 1, Range{0, kPhotopicEfficacy, true});
  if (p.has("efficacy")) {
    if (!amount_ || amount_->quantity != Quantity::flux || amount_->is_photometric)
      throw p.error("efficacy", "is that of an amount in W, the electrical power");
    amount_->value *= efficacy;
    amount_->is_photometric = true;
  }
  const double kelvin = p.get_float("color_temperature", 6500, Range{100, 1e6});
  if (p.has("color_temperature")) {
    if (p.has(name))
      throw p.error("color_temperature", "give either \"color_temperature\" or \"" + name_ + "\"");
    if (!amount_)
      throw p.error("color_temperature",
                    "needs an \"amount\", such as \"800 lm\", which says how strong the light is");
    p.find(name);
    texture_ = std::dynamic_pointer_cast<const Texture>(
        make_object(p, "texture", "blackbody", {{"temperature", Properties::Value(kelvin)}}));
  } else {
    texture_ = get_texture(p, name, 1, SpectrumRole::emission);
  }
  if (amount_ && std::dynamic_pointer_cast<const AttributeTexture>(texture_))
    throw p.error("amount", "cannot scale an attribute of a mesh, whose mean is not known before the shape");
  if (amount_ && amount_->is_photometric && !covers_photopic_vision(p.context().grid))
    throw p.error("amount",
                  "the film's wavelengths do not cover the visible, so that they cannot hold a photometric "
                  "amount: state it in W");
}

double Emission::scale(const AmountFactors& factors, const SampledSpectrum& average) const {
  if (!amount_) return 1;
  double factor = 0;
  switch (amount_->quantity) {
    case Quantity::flux:
      factor = factors.flux;
      break;
    case Quantity::intensity:
      factor = factors.intensity;
      break;
    case Quantity::irradiance:
      factor = factors.irradiance;
      break;
    case Quantity::radiance:
      factor = factors.radiance;
  }
  if (factor == 0) {
    const PluginInfo* plugin = properties_.plugin();
    const ParameterDoc* row = plugin ? plugin->parameter("amount") : nullptr;
    throw properties_.error("amount",
                            fmt::format("\"{}\" has no {}: give its amount in {}", properties_.type(),
                                        quantity_name(amount_->quantity, amount_->is_photometric),
                                        row ? row->unit : "another unit"));
  }
  const double total = amount_->is_photometric
                           ? product(average, photopic_efficacy(average.grid())).integral()
                           : average.integral();
  if (!(total > 0))
    throw properties_.error(name_,
                            amount_->is_photometric
                                ? "has no light that the eye sees, so that no photometric amount can scale it"
                                : "is dark at the film's wavelengths, so that no amount can scale it");
  return amount_->value * factor / total;
}

TexturePtr Emission::scaled(const AmountFactors& factors) const {
  return amount_ ? scaled_texture(texture_, scale(factors, texture_->average())) : texture_;
}

}  // namespace aureole
