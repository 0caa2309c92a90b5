# SPDX-License-Identifier: Apache-2.0
"""aureole: a spectral renderer and toolkit for material appearance, from rays to waves."""
from ._processor import require_processor as _require_processor

_require_processor()

from . import cache, optics, pigment, plot, spectrum  # noqa: E402
from ._aureole import Aperture, Bsdf, Bssrdf, Emitter, Medium, Object, Phase, Texture, __version__  # noqa: E402
from ._check import CheckRecord, CheckReport, check  # noqa: E402
from ._colours import AppearanceData, ColorData, ColorRendering, ColorTable, cam16, color, color_rendering  # noqa: E402
from ._comparison import Comparison, FileInfo, LayerDifference, compare, info  # noqa: E402
from ._coronas import DropletSize, Rings, droplet_size, rings  # noqa: E402
from ._denoise import denoise  # noqa: E402
from ._dict import Transform  # noqa: E402
from ._errors import Error, Problem, SceneError  # noqa: E402
from ._goniometer import BrdfFit, GoniometerData, LateralSpread, Reflectances, goniometer, goniometer_report, lateral_spread  # noqa: E402
from ._exposure import ExposureData, expose  # noqa: E402
from ._goniophotometer import LuminaireData, goniophotometer  # noqa: E402
from ._illumination import IlluminationData, illumination  # noqa: E402
from ._image import Image, convert, read_image  # noqa: E402
from ._instruments import LayerData, MediumData, layer, medium  # noqa: E402
from ._laboratory import ConvertedBsdf, GlossAndHaze, MeasuredSpectrum, RadiometerReading, convert_bsdf, spectrophotometer, spectroradiometer  # noqa: E402
from ._lens import LensData, lens  # noqa: E402
from ._light_field import LightField, lightfield  # noqa: E402
from ._microstructure import Estimate, Microstructure, Particles, microstructure  # noqa: E402
from ._objects import BsdfSample, EmitterSample, Lobe, MediumCoefficients, PhaseSample  # noqa: E402
from ._photometry import Glare, PhotometryData, RegionStatistics, photometry  # noqa: E402
from ._powermap import PowerMap, powermap  # noqa: E402
from ._python_bsdf import PythonBsdf, as_bsdf  # noqa: E402
from ._render import InterruptedWarning, render, render_iter  # noqa: E402
from ._scene import ParameterError, Scene, load_dict, load_file, load_string  # noqa: E402
from ._ugr import UgrData, UgrVariation, ugr  # noqa: E402
from ._volume import read_vol, write_vol  # noqa: E402

__all__ = [
    "Aperture", "AppearanceData", "BrdfFit", "Bsdf", "BsdfSample", "Bssrdf", "CheckRecord", "CheckReport", "ColorData",
    "ColorRendering", "ColorTable", "Comparison", "ConvertedBsdf", "DropletSize", "Emitter", "EmitterSample", "Error", "Estimate",
    "ExposureData", "FileInfo", "Glare", "GlossAndHaze", "GoniometerData", "IlluminationData", "Image", "InterruptedWarning",
    "LateralSpread", "LayerData", "LayerDifference", "LensData", "LightField", "Lobe", "LuminaireData", "MeasuredSpectrum", "Medium",
    "MediumCoefficients", "MediumData", "Microstructure", "Object", "ParameterError", "Particles", "Phase", "PhaseSample",
    "PhotometryData", "PowerMap", "Problem", "PythonBsdf", "RadiometerReading", "Reflectances", "RegionStatistics", "Rings", "Scene",
    "SceneError", "Texture", "Transform", "UgrData", "UgrVariation", "__version__", "as_bsdf", "cache", "cam16", "check", "color", "color_rendering", "compare",
    "convert", "convert_bsdf", "denoise", "droplet_size", "expose", "goniometer", "goniometer_report", "goniophotometer",
    "illumination", "info", "lateral_spread", "layer", "lens", "lightfield", "load_dict", "load_file", "load_string", "medium",
    "microstructure", "optics", "photometry", "pigment", "plot", "powermap", "read_image", "read_vol", "render", "render_iter",
    "rings", "spectrophotometer", "spectroradiometer", "spectrum", "ugr", "write_vol",
]
