# SPDX-License-Identifier: Apache-2.0
"""aureole: a spectral renderer and toolkit for material appearance, from rays to waves."""
from ._processor import require_processor as _require_processor

_require_processor()

from ._aureole import __version__  # noqa: E402
from . import optics, plot, spectrum  # noqa: E402
from ._check import CheckRecord, CheckReport, check  # noqa: E402
from ._errors import Error, Problem, SceneError  # noqa: E402

__all__ = ["CheckRecord", "CheckReport", "Error", "Problem", "SceneError", "__version__", "check", "optics", "plot", "spectrum"]
