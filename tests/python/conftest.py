# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of the Python package."""
import os
from pathlib import Path
from typing import Any, Dict

import numpy as np
import pytest

os.environ["AUREOLE_CACHE"] = "off"  # tests read no table that the user's programs have kept

import aureole  # noqa: E402


@pytest.fixture
def repository() -> Path:
    """The folder of the repository."""
    return Path(__file__).resolve().parents[2]


@pytest.fixture
def small_scene() -> Dict[str, Any]:
    """A sphere and a quad under a sky, 24 x 16 pixels, 16 samples."""
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 4},
        "camera": {
            "type": "perspective",
            "fov": 40.0,
            "to_world": aureole.Transform.look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 24, "height": 16},
            "sampler": {"type": "sobol", "sample_count": 16},
        },
        "ball": {"type": "sphere", "radius": 0.8, "bsdf": {"type": "diffuse", "reflectance": [0.8, 0.3, 0.2]}},
        "quad": {
            "type": "mesh",
            "vertices": np.array([[-2, -2, -1], [2, -2, -1], [2, 2, -1], [-2, 2, -1]]),
            "faces": np.array([[0, 1, 2], [0, 2, 3]]),
            "uvs": np.array([[0, 0], [1, 0], [1, 1], [0, 1]]),
            "bsdf": {"type": "diffuse", "reflectance": 0.5},
        },
        "sky": {"type": "constant", "radiance": 1.0},
    }
