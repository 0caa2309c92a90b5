// SPDX-License-Identifier: Apache-2.0
// aureole pigment error: the error of Kubelka and Munk's two-flux theory against radiative transfer.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/units.h"
#include "aureole/pigment/two_flux_error.h"
#include "command.h"

namespace aureole {
namespace {

struct ErrorOptions {
  std::string albedo = "0.5,0.9,0.99,0.999", thickness = "0.1,1,10,100", g = "0,0.5,0.9",
              convention = "three_quarters", json;
  double index = 1.5, substrate = 0;
};

std::vector<double> list_of(const char* option, const std::string& text, double min, double max) {
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    try {
      values.push_back(parse_number(part));
    } catch (const Error& e) {
      throw Error(fmt::format("{}: {}", option, e.message()));
    }
    if (!(values.back() >= min && values.back() <= max))
      throw Error(fmt::format("{}: {} must be in [{:g}, {:g}]", option, part, min, max));
  }
  return values;
}

int error_map(const ErrorOptions& o) {
  const std::vector<double> albedos = list_of("--albedo", o.albedo, 1e-6, 1),
                            gs = list_of("--g", o.g, -0.99, 0.99),
                            thicknesses = list_of("--thickness", o.thickness, 1e-6, 1e6);
  const pigment::Convention convention = pigment::convention_named(o.convention);

  fmt::print(
      "Diffuse light on a layer of index {:g} over {:g}: R by transport, and R and L* by Kubelka and Munk ({})\n",
      o.index, o.substrate, o.convention);
  fmt::print("less these. Thickness counts in 1/(sigma_s (1 - g)).\n\n");
  fmt::print("{:>6} {:>8} {:>10} {:>9} {:>9} {:>8} {:>8}\n", "g", "albedo", "thickness", "R", "L*", "error R",
             "error L*");
  nlohmann::json rows = nlohmann::json::array();
  double worst = 0;
  bool any = false;
  for (const double g : gs)
    for (const double albedo : albedos)
      for (const double thickness : thicknesses) {
        const pigment::TwoFluxError e =
            pigment::two_flux_error({albedo, thickness, g, o.index, o.substrate}, convention);
        const auto number = [](const std::optional<double>& value) {
          return value ? nlohmann::json(*value) : nlohmann::json();
        };
        rows.push_back({{"g", g},
                        {"albedo", albedo},
                        {"thickness", thickness},
                        {"reflectance", e.reflectance},
                        {"error", number(e.error)},
                        {"error_lightness", number(e.lightness_error)}});
        fmt::print("{:6g} {:8g} {:10g} {:9.5f} {:9.3f} {}\n", g, albedo, thickness, e.reflectance,
                   e.lightness,
                   e.error ? fmt::format("{:+8.4f} {:+8.2f}", *e.error, *e.lightness_error) : "  negative S");
        if (!e.error) continue;
        worst = std::max(worst, std::abs(*e.lightness_error));
        any = true;
      }
  if (any)
    fmt::print("\nat most {:.2f} L*\n", worst);
  else
    fmt::print("\nS is negative everywhere: Kubelka and Munk say nothing of these layers\n");
  if (!o.json.empty())
    write_file_atomically(
        o.json,
        nlohmann::json{
            {"index", o.index}, {"substrate", o.substrate}, {"convention", o.convention}, {"rows", rows}}
                .dump(1) +
            "\n");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<ErrorOptions>();
  options.add("--albedo", o->albedo, "single-scattering albedos, separated by commas").shows_default();
  options.add("--thickness", o->thickness, "thicknesses in 1/(sigma_s (1 - g)), separated by commas")
      .shows_default();
  options.add("--g", o->g, "mean cosines of the scattering angle, separated by commas").shows_default();
  options.add("--index", o->index, "index of refraction of the binder; 1: no interface")
      .between(1.0, 10.0)
      .shows_default();
  options.add("--substrate", o->substrate, "reflectance of the substrate").between(0.0, 1.0).shows_default();
  options.add("--convention", o->convention, "relation of K and S to the transport coefficients")
      .one_of(pigment::convention_names())
      .shows_default();
  options.add("--json", o->json, "write the map to this file").names_output();
  return [o] { return error_map(*o); };
}

AUREOLE_COMMAND("pigment error", "Error of Kubelka and Munk's theory, by albedo, thickness and g", declare);

}  // namespace
}  // namespace aureole
