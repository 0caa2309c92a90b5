# SPDX-License-Identifier: Apache-2.0
"""Uses of the package that a type checker must report, each with its code."""
import aureole
from aureole._aureole import Bsdf, Emitter, run_command_line

version: int = aureole.__version__  # error: assignment
aureole.nothing_of_this_name  # error: attr-defined
run_command_line("--version", 3)  # error: call-arg
code: str = run_command_line(["aureole"])  # error: assignment
aureole.Problem("text", line="3")  # error: arg-type
aureole.SceneError(3)  # error: arg-type
aureole.render("scene.xml")  # error: arg-type
aureole.render(aureole.load_file("scene.xml"), spp="4")  # error: arg-type
size: int = aureole.load_file("scene.xml").size  # error: assignment


def lamp(bsdf: Bsdf) -> Emitter:
    bsdf.id = "a"  # error: misc
    return bsdf  # error: return-value
