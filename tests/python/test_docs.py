# SPDX-License-Identifier: Apache-2.0
"""The page docs/python.md: its examples run, in order, and what it names exists."""
import os
import re
from pathlib import Path

import pytest

import aureole

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"
TEXT = PAGE.read_text(encoding="utf-8")


def blocks():
    """(line, text) of each block of Python, its lines where they are in the page so that errors point there."""
    for found in re.finditer(r"^```python\n(.*?)^```", TEXT, flags=re.DOTALL | re.MULTILINE):
        yield TEXT[: found.start(1)].count("\n") + 1, found[1]


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
    # What the examples promise.
    assert (tmp_path / "ball.exr").stat().st_size > 1000 and (tmp_path / "ball.png").stat().st_size > 1000
    assert names["value"].shape == (91, 3)
    assert names["report"].passed


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`aureole\.([A-Za-z_][\w.]*)", TEXT))))
def test_names_exist(name):
    target = aureole
    for part in name.rstrip(".").split("."):
        assert hasattr(target, part), f"aureole.{name}"
        target = getattr(target, part)
