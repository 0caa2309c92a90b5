# SPDX-License-Identifier: Apache-2.0
"""The pages docs/python.md, docs/optics.md and docs/pigments.md: their examples run, in order, and what the first names exists."""
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

import aureole
import aureole.cluster  # noqa: F401

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"
TEXT = PAGE.read_text(encoding="utf-8")
OPTICS = PAGE.with_name("optics.md")


def blocks(page=TEXT):
    """(line, text) of each block of Python, its lines where they are in the page so that errors point there."""
    for found in re.finditer(r"^```python\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE):
        yield page[: found.start(1)].count("\n") + 1, found[1]


def test_there_are_examples():
    assert len(list(blocks())) >= 10


def test_examples_run(tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    os.symlink(PAGE.parents[1] / "scenes", tmp_path / "scenes")
    os.symlink(PAGE.parents[1] / "tests", tmp_path / "tests")
    names = {"__name__": "docs"}
    for line, text in blocks():
        exec(compile("\n" * (line - 1) + text, str(PAGE), "exec"), names)  # noqa: S102
    # Results that the page states.
    assert (tmp_path / "ball.exr").stat().st_size > 1000 and (tmp_path / "ball.png").stat().st_size > 1000
    assert names["value"].shape == (91, 3)
    assert names["report"].passed


def test_optics_examples_have_their_values():
    names = {"__name__": "docs"}
    checked = 0
    for line, text in blocks(OPTICS.read_text(encoding="utf-8")):
        exec(compile("\n" * (line - 1) + text, str(OPTICS), "exec"), names)  # noqa: S102
        for expression, value in re.findall(r"^(\S.*?\S) +# ([\d.]+)$", text, flags=re.MULTILINE):
            assert f"{float(eval(expression, names)):.{len(value.split('.')[1])}f}" == value, expression  # noqa: S307
            checked += 1
    assert checked >= 3


def test_worked_examples_of_paints_print_what_the_page_states(tmp_path):
    """Commands below "<!-- example -->" of docs/pigments.md, and the lines that the page shows of their output."""
    page = PAGE.with_name("pigments.md").read_text(encoding="utf-8")
    for source in (PAGE.parent / "examples").iterdir():
        shutil.copy(source, tmp_path)
    examples = re.findall(r"<!-- example -->\n```sh\n(.*?)```\n\n```text\n(.*?)```", page, flags=re.DOTALL)
    assert len(examples) == 4
    for commands, shown in examples:
        printed = ""
        for command in commands.splitlines():
            words = shlex.split(command)
            assert words[0] == "aureole", command
            done = subprocess.run([os.environ["AUREOLE_BINARY"], *words[1:]], cwd=tmp_path, capture_output=True, text=True)
            assert done.returncode == 0, command + done.stderr
            printed += done.stdout + done.stderr
        printed = " ".join(printed.split())
        for line in shown.splitlines():
            assert " ".join(line.split()) in printed, f"{line}\n{printed}"


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`aureole\.([A-Za-z_][\w.]*)", TEXT))))
def test_names_exist(name):
    target = aureole
    for part in name.rstrip(".").split("."):
        assert hasattr(target, part), f"aureole.{name}"
        target = getattr(target, part)
