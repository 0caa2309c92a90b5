// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/units.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

#include "aureole/core/error.h"

namespace aureole {

namespace {

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t' || s.front() == '\n' || s.front() == '\r'))
    s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t' || s.back() == '\n' || s.back() == '\r'))
    s.remove_suffix(1);
  return s;
}

struct Unit {
  std::string_view name;
  double factor;
};
constexpr Unit kLengths[] = {{"nm", 1e-9}, {"um", 1e-6}, {"µm", 1e-6}, {"μm", 1e-6},        {"mm", 1e-3},
                             {"cm", 1e-2}, {"m", 1},     {"km", 1e3},  {"angstrom", 1e-10}, {"Å", 1e-10}};
constexpr Unit kFrequencies[] = {{"Hz", 1}, {"kHz", 1e3}, {"MHz", 1e6}, {"GHz", 1e9}, {"THz", 1e12}};

/// Returns the number at the start of `text` and the remaining text.
std::pair<double, std::string_view> split(std::string_view text) {
  text = trimmed(text);
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || !std::isfinite(value))
    throw Error("\"" + std::string(text) + "\" is not a number");
  return {value, trimmed(digits.substr(size_t(end - digits.data())))};
}

double finite(double value, std::string_view text) {
  if (!std::isfinite(value)) throw Error("\"" + std::string(trimmed(text)) + "\" is out of range");
  return value;
}

}  // namespace

std::string shown_number(double value) { return fmt::format("{:.8g}", value); }
std::string shown_number(float value) { return fmt::format("{}", value); }

double parse_number(std::string_view text) {
  const auto [value, rest] = split(text);
  if (!rest.empty()) throw Error("\"" + std::string(trimmed(text)) + "\" is not a number");
  return value;
}

double parse_length_m(std::string_view text) {
  const auto [value, unit] = split(text);
  for (const Unit& u : kLengths)
    if (u.name == unit) return finite(value * u.factor, text);
  const std::string shown = "\"" + std::string(trimmed(text)) + "\"";
  if (unit.empty()) throw Error(shown + " has no unit: write a length as \"5um\" (nm, um, mm, cm, m or km)");
  throw Error(shown + " has the unknown unit \"" + std::string(unit) + "\": use nm, um, mm, cm, m or km");
}

double parse_wavelength_nm(std::string_view text) {
  const auto [value, unit] = split(text);
  if (unit.empty()) return value;
  for (const Unit& u : kLengths)
    if (u.name == unit) return finite(value * u.factor * 1e9, text);
  for (const Unit& u : kFrequencies)
    if (u.name == unit) return finite(299792458.0 / (value * u.factor) * 1e9, text);
  throw Error("\"" + std::string(trimmed(text)) + "\" has the unknown unit \"" + std::string(unit) +
              "\": use nm, um, mm, cm, m, km, Hz, kHz, MHz, GHz or THz");
}

}  // namespace aureole
