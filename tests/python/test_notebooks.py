# SPDX-License-Identifier: Apache-2.0
"""The notebooks run from top to bottom, in a fresh kernel of this interpreter. What they claim they assert themselves."""
import os
import sys
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

from jupyter_client import AsyncKernelManager  # noqa: E402
from jupyter_client.kernelspec import KernelSpec  # noqa: E402

import aureole  # noqa: E402

NOTEBOOKS = Path(__file__).resolve().parents[2] / "notebooks"
NAMES = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))


def test_there_are_notebooks():
    assert NAMES == ["a_camera_that_counts", "corona", "is_my_bsdf_right", "knife_edge_to_city", "microscope", "mitsuba_scene", "one_volume", "paint",
                     "paint_chip_to_product_shot"]


@pytest.mark.parametrize("name", NAMES)
def test_is_stored_without_outputs(name):
    notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code), "strip it: jupyter nbconvert --clear-output --inplace"
    assert any(line.startswith("assert ") for line in code[-1].source.splitlines()), "the last cell asserts what the notebook claims"


def executed(notebook, folder, tmp_path):
    """Runs all cells in a new kernel of this interpreter, whatever kernels are installed under that name. Raises what a cell raises."""
    manager = AsyncKernelManager()
    manager._kernel_spec = KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                                      display_name="this Python", language="python")
    environment = dict(os.environ)
    package = str(Path(aureole.__file__).resolve().parents[1]) if "PYTHONPATH" not in os.environ else os.environ["PYTHONPATH"]
    environment["PYTHONPATH"] = os.pathsep.join(os.path.abspath(p) for p in package.split(os.pathsep) if p)
    environment.pop("MPLBACKEND", None)  # the kernel's own shows plots
    for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "MPLCONFIGDIR"):
        (tmp_path / name).mkdir()
        environment[name] = str(tmp_path / name)
    environment["MPLCONFIGDIR"] = os.environ.get("MPLCONFIGDIR", environment["MPLCONFIGDIR"])  # with its list of fonts
    client = nbclient.NotebookClient(notebook, km=manager, timeout=300, resources={"metadata": {"path": str(folder)}})
    client.execute(env=environment)


@pytest.mark.parametrize("name", NAMES)
def test_runs(name, tmp_path):
    notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    executed(notebook, NOTEBOOKS, tmp_path)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not [o for cell in code for o in cell.outputs if o.output_type == "error"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    warned = [o.text for cell in code for o in cell.outputs if o.output_type == "stream" and "Warning" in o.text]
    assert not warned
    # A plot that is made is seen: nothing goes to a window or a file instead.
    pictures = sum("image/png" in o.get("data", {}) for cell in code for o in cell.outputs)
    assert pictures >= (1 if name == "mitsuba_scene" else 4)


def test_bars_without_ipywidgets(tmp_path):
    """A render, loading and tables show bars of text where a notebook has no widgets, and no warning."""
    cells = ["""
import sys, time
sys.modules["ipywidgets"] = None  # as where it is not installed
import aureole
from aureole import _bars
scene = aureole.load_dict({"type": "scene", "integrator": {"type": "path"}, "sky": {"type": "constant"},
    "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 256, "height": 256}}, "ball": {"type": "sphere", "center": [0, 0, 4]}})
""", "aureole.render(scene, 16384, time=3.0).complete;", """
with _bars.LoadBar("street.xml"):
    time.sleep(2.0)
    _bars.show_tables("mie", 0.5)
"""]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    executed(notebook, tmp_path, tmp_path)
    outputs = ["".join(o.text for o in cell.outputs if o.output_type == "stream" and o.name == "stderr") for cell in notebook.cells]
    assert outputs[0] == "" and "Warning" not in "".join(outputs)
    assert "Msamples/s" in outputs[1] and "%|" in outputs[1]
    assert "loading street.xml" in outputs[2] and "tables of mie:  50%" in outputs[2]
    assert all(o.output_type == "stream" or o.output_type == "execute_result" for cell in notebook.cells for o in cell.outputs)
