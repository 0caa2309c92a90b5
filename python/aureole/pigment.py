# SPDX-License-Identifier: Apache-2.0
"""Paints by Kubelka and Munk: K and S from measurements, mixtures, recipes for a colour (docs/pigments.md).

Reflectances are fractions. "Inner" reflectances belong to the pigmented layer within its binder, "outer"
reflectances are measured through the interface to air. Wavelengths are in nm. Functions of numbers broadcast as numpy does.
"""
from __future__ import annotations

from ._paint_colours import Colour, Comparison, ciede2000, colour, compare, difference, lab
from ._paint_fits import HeldOut, JointFit, Residuals, Specimen, TheoryFit, fit, joint_fit
from ._paint_layers import (Fluxes, Layer, Surface, TwoFluxError, coefficients, coefficients_of_transport, fluxes_within, k_over_s,
                            layer, opaque_reflectance, saunderson, surface, two_flux_error)
from ._paint_palettes import Match, Paint, Palette, Streams, grain_index, grain_names, paint_of_grains

__all__ = ["Colour", "Comparison", "Fluxes", "HeldOut", "JointFit", "Layer", "Match", "Paint", "Palette", "Residuals", "Specimen", "Streams", "Surface",
           "TheoryFit", "TwoFluxError",
           "ciede2000", "coefficients", "coefficients_of_transport", "colour", "compare", "difference", "fit", "fluxes_within", "grain_index",
           "grain_names", "joint_fit", "k_over_s", "lab", "layer", "opaque_reflectance", "paint_of_grains", "saunderson", "surface",
           "two_flux_error"]
