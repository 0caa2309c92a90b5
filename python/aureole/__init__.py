# SPDX-License-Identifier: Apache-2.0
"""aureole: a spectral renderer and toolkit for material appearance, from rays to waves."""
from ._processor import require_processor as _require_processor

_require_processor()

from ._aureole import Aperture, Bsdf, Emitter, Object, Texture, __version__  # noqa: E402
from ._errors import Error, Problem, SceneError  # noqa: E402
from ._objects import BsdfSample, EmitterSample, Lobe  # noqa: E402
from ._python_bsdf import PythonBsdf, as_bsdf  # noqa: E402

__all__ = ["Aperture", "Bsdf", "BsdfSample", "Emitter", "EmitterSample", "Error", "Lobe", "Object", "Problem", "PythonBsdf", "SceneError",
           "Texture", "__version__", "as_bsdf"]
