# SPDX-License-Identifier: Apache-2.0
"""Uses of the package that a type checker accepts."""
from typing import List

import numpy as np

import aureole
from aureole._aureole import Bsdf, Object, run_command_line

version: str = aureole.__version__


def places(error: aureole.SceneError) -> List[str]:
    return [f"{problem.file}:{problem.line}" for problem in error.problems if problem.line > 0]


def command(name: str) -> int:
    try:
        return run_command_line(["aureole", name])
    except aureole.SceneError as e:
        print(places(e))
    except aureole.Error as e:
        print(str(e))
    return 2


def name_of(bsdf: Bsdf) -> str:
    thing: Object = bsdf
    return thing.id


def brightness(path: str) -> float:
    scene = aureole.load_file(path, width=32)
    image: aureole.Image = aureole.render(scene, spp=4, progress=False)
    for refined in aureole.render_iter(scene, spp=32):
        image = refined
    return float(np.asarray(image).mean()) + float(image.rgb[0, 0, 1])
