// SPDX-License-Identifier: Apache-2.0
// Shared by the files of the Python module. Each file binds one part of the library in a function that is
// declared here and called by module.cpp.
#pragma once

#include <nanobind/nanobind.h>

#include "unlocked.h"

namespace aureole::python {

namespace nb = nanobind;

void bind_errors(nb::module_& m);
void bind_objects(nb::module_& m);      ///< plug-in objects over arrays: BSDFs, emitters, apertures, spectra
void bind_python_bsdf(nb::module_& m);  ///< BSDFs written in Python
void bind_scene(nb::module_& m);        ///< scenes, their parameters, rendering
void bind_image(nb::module_& m);        ///< pictures
void bind_parts(nb::module_& m);        ///< parts of pictures from several machines
void bind_instruments(nb::module_& m);  ///< instruments that the command line has, too
void bind_light(nb::module_& m);        ///< photometry, lenses, cameras, light fields
void bind_optics(nb::module_& m);       ///< physics without a renderer
void bind_pigment(nb::module_& m);      ///< paints
void bind_spectrum(nb::module_& m);     ///< observer, illuminants, colour, refractive indices
void bind_cache(nb::module_& m);        ///< tables that are kept on disc
void bind_check(nb::module_& m);        ///< the harness for BSDFs
void bind_microstructure(nb::module_& m);  ///< scatterers found in microscope pictures
void bind_laboratory(nb::module_& m);      ///< instruments that measure materials, colours

}  // namespace aureole::python
