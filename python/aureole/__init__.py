# SPDX-License-Identifier: Apache-2.0
"""aureole: a spectral renderer and toolkit for material appearance, from rays to waves."""
from ._processor import require_processor as _require_processor

_require_processor()

from . import optics, pigment, plot, spectrum  # noqa: E402
from ._aureole import Aperture, Bsdf, Bssrdf, Emitter, Medium, Object, Phase, Texture, __version__  # noqa: E402
from ._check import CheckRecord, CheckReport, check  # noqa: E402
from ._comparison import Comparison, FileInfo, LayerDifference, compare, info  # noqa: E402
from ._coronas import DropletSize, Rings, droplet_size, rings  # noqa: E402
from ._denoise import denoise  # noqa: E402
from ._dict import Transform  # noqa: E402
from ._errors import Error, Problem, SceneError  # noqa: E402
from ._image import Image, convert, read_image  # noqa: E402
from ._instruments import LayerData, MediumData, layer, medium  # noqa: E402
from ._microstructure import Estimate, Microstructure, Particles, microstructure  # noqa: E402
from ._objects import BsdfSample, EmitterSample, Lobe, MediumCoefficients, PhaseSample  # noqa: E402
from ._powermap import PowerMap, powermap  # noqa: E402
from ._python_bsdf import PythonBsdf, as_bsdf  # noqa: E402
from ._render import InterruptedWarning, render, render_iter  # noqa: E402
from ._scene import ParameterError, Scene, load_dict, load_file, load_string  # noqa: E402
from ._volume import read_vol, write_vol  # noqa: E402

__all__ = [
    "Aperture", "Bsdf", "BsdfSample", "Bssrdf", "CheckRecord", "CheckReport", "Comparison", "DropletSize", "Emitter", "EmitterSample", "Error",
    "Estimate", "FileInfo", "Image", "InterruptedWarning", "LayerData", "LayerDifference", "Lobe", "Medium", "MediumCoefficients", "MediumData",
    "Microstructure", "Object", "ParameterError", "Particles", "Phase", "PhaseSample", "PowerMap", "Problem", "PythonBsdf", "Rings", "Scene",
    "SceneError", "Texture", "Transform", "__version__", "as_bsdf", "check", "compare", "convert", "denoise", "droplet_size", "info", "layer", "load_dict",
    "load_file", "load_string", "medium", "microstructure", "optics", "pigment", "plot", "powermap", "read_image", "read_vol", "render",
    "render_iter", "rings", "spectrum", "write_vol",
]
