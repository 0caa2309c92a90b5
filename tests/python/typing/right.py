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


def lamps(path: str) -> float:
    scene = aureole.load_file(path)
    seen = aureole.photometry(scene, 16, regions=[(0, 0, 2, 2)], progress=False)
    both = aureole.illumination(path, 16, runs=4, progress=False)
    lamp = aureole.goniophotometer(path, 64, c_step=30)
    lamp.save("lamp.ies")
    glare: aureole.UgrData = aureole.ugr(lamp, spacing=1, uncorrected=True)
    glass = aureole.lens("double_gauss.lens", f_number=4, fields=[0, 5.0])
    raw = aureole.expose(path, exposure=0.01, frames=2, gain=0.5)
    field = aureole.lightfield(path)
    view: aureole.Image = field.picture((0.0, 0.1), diameter=0.2)
    lit = aureole.optics.disc_solid_angle([0, 0, 2], [0, 0, 1], 1.0, normal=[0, 0, 1])
    return seen.regions[0].mean + float(both.total[0]) + lamp.flux + float(glare.crosswise[0, 0]) + glass.focal_length + float(raw.electrons.mean()) + view.height + float(lit.projected)


def brightness(path: str) -> float:
    scene = aureole.load_file(path, width=32)
    image: aureole.Image = aureole.render(scene, spp=4, progress=False)
    for refined in aureole.render_iter(scene, spp=32):
        image = refined
    return float(np.asarray(image).mean()) + float(image.rgb[0, 0, 1])
