// SPDX-License-Identifier: Apache-2.0
// Absorption in all its quantities, phase functions, and scattering of air, water and dipoles in closed form. aureole/_media.py checks the arguments and
// shapes the results.
#include "aureole/optics/medium/absorption.h"
#include "aureole/optics/medium/diffusion_dipole.h"
#include "aureole/optics/particle/hard_spheres.h"
#include "aureole/optics/particle/henyey_greenstein.h"
#include "aureole/optics/particle/rayleigh_scattering.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

void define(nb::module_& m, const char* name, double (*f)(double), const char* argument) {
  m.def(
      name,
      [name, f](const Reals& numbers, const Array<double>& result) { map_numbers(name, numbers, result, f); },
      nb::arg(argument), nb::arg("result").noconvert());
}

void define(nb::module_& m, const char* name, double (*f)(double, double), const char* first,
            const char* second) {
  m.def(
      name,
      [name, f](const Reals& a, const Reals& b, const Array<double>& result) {
        map_pairs(name, a, b, result, f);
      },
      nb::arg(first), nb::arg(second), nb::arg("result").noconvert());
}

}  // namespace

void bind_absorption(nb::module_& m) {
  define(m, "transmittance", &optics::transmittance, "absorption", "distance");
  define(m, "absorptance", &optics::absorptance, "absorption", "distance");
  define(m, "napierian_absorbance", &optics::napierian_absorbance, "transmittance");
  define(m, "decadic_absorbance", &optics::decadic_absorbance, "transmittance");
  define(m, "transmittance_of_napierian", &optics::transmittance_of_napierian, "absorbance");
  define(m, "transmittance_of_decadic", &optics::transmittance_of_decadic, "absorbance");
  define(m, "absorption_of_napierian", &optics::absorption_of_napierian, "absorbance", "distance");
  define(m, "absorption_of_decadic", &optics::absorption_of_decadic, "absorbance", "distance");
  define(m, "absorption_of_index", &optics::absorption_of_index, "k", "nm");
  define(m, "index_of_absorption", &optics::index_of_absorption, "absorption", "nm");
  define(m, "absorption_of_molar", &optics::absorption_of_molar, "molar", "concentration");
  define(m, "cross_section_of_molar", &optics::cross_section_of_molar, "molar");
  define(m, "absorption_of_mass", &optics::absorption_of_mass, "specific", "concentration");
  define(m, "absorption_of_number", &optics::absorption_of_number, "cross_section", "number_density");
  define(m, "henyey_greenstein", &optics::henyey_greenstein, "mu", "g");
  define(m, "rayleigh_phase", &optics::rayleigh_phase, "mu", "depolarization");
  define(m, "air_refractivity", &optics::air_refractivity, "nm");
  define(m, "air_cross_section", &optics::air_cross_section, "nm");
  define(m, "air_depolarization", &optics::air_depolarization, "nm");
  define(m, "water_scattering", &optics::water_scattering, "nm");
  define(m, "dipole_reflectance", &optics::dipole_reflectance, "reduced_albedo", "index");
  define(m, "dipole_albedo", &optics::dipole_albedo, "reflectance", "index");
  define(m, "hard_sphere_structure_factor", &optics::hard_sphere_structure_factor, "u", "fraction");
}

}  // namespace aureole::python
