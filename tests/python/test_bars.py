# SPDX-License-Identifier: Apache-2.0
"""Progress of loading and of tables: as a function's arguments, and as a bar of text."""
from __future__ import annotations

import time
from typing import Any, List, Optional, Tuple

import pytest

import aureole
from aureole import _bars

SLOW = {"type": "mie", "radius": "250um", "distribution": "gamma"}  # tables of a minute and a half
SCENE = {"type": "scene", "integrator": {"type": "volpath"}, "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 8}},
         "sky": {"type": "constant"},
         "fog": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 1.0, "phase": {"type": "mie", "radius": "0.5um", "distribution": "gamma"}}}}


class Enough(Exception):
    pass


class Until:
    """A function of progress that ends the loading after some reports of tables."""

    def __init__(self, reports: int) -> None:
        self.seen: List[Tuple[str, Optional[float]]] = []
        self._reports = reports

    def __call__(self, name: str, part: Optional[float]) -> None:
        self.seen.append((name, part))
        if sum(p is not None for _, p in self.seen) == self._reports:
            raise Enough

    def parts(self) -> List[float]:
        return [p for _, p in self.seen if p is not None]


def test_tables_of_an_object() -> None:
    report = Until(3)
    begun = time.monotonic()
    with pytest.raises(Enough):
        aureole.load_dict(SLOW, progress=report)
    assert time.monotonic() - begun < 30
    assert report.seen[0] == ("the mie", None)
    parts = report.parts()
    assert len(parts) == 3 and parts == sorted(parts) and 0 <= parts[0] and parts[-1] < 1
    assert "mie" in report.seen[-1][0]


def test_tables_of_a_change_and_the_scene_stays_as_it_was() -> None:
    scene = aureole.load_dict(SCENE, progress=False)
    path = next(p for p in scene.paths() if p.endswith("radius"))
    report = Until(2)
    with pytest.raises(Enough):
        scene.update({path: "250um"}, progress=report)
    assert len(report.parts()) == 2 and scene[path] == "0.5um"
    scene.update({path: "0.6um"}, progress=Until(10000))
    assert scene[path] == "0.6um"
    assert aureole.render(scene, 16, progress=False).complete


def test_a_function_that_raises_at_once_leaves_nothing_behind() -> None:
    def report(name: str, part: Optional[float]) -> None:
        raise Enough

    with pytest.raises(Enough):
        aureole.load_dict(SCENE, progress=report)
    assert not _bars._entered.bars


def test_a_bar_of_text(monkeypatch: pytest.MonkeyPatch, capfd: Any) -> None:
    monkeypatch.setattr(_bars, "_WAIT_S", 0.05)
    monkeypatch.setattr(_bars, "_STEP_S", 0.05)
    with _bars.LoadBar("street.xml"):
        time.sleep(0.4)
        _bars.show_tables("mie", 0.25)
        _bars.show_tables("mie", 0.5)
        _bars.show_tables("layer", 0.1)
    shown = capfd.readouterr()
    assert shown.out == "" and "loading street.xml" in shown.err
    assert "tables of mie:  50%" in shown.err and "tables of layer:  10%" in shown.err
    assert not _bars._entered.bars


def test_no_bar_where_it_is_not_wanted_or_not_needed(monkeypatch: pytest.MonkeyPatch, capfd: Any) -> None:
    aureole.load_dict(SCENE)
    monkeypatch.setattr(_bars, "_WAIT_S", 0.01)
    with _bars.LoadBar("street.xml", False):
        time.sleep(0.1)
        _bars.show_tables("mie", 0.25)
    with _bars.LoadBar("an object", shows_time=False):
        time.sleep(0.1)
    _bars.show_tables("mie", 0.25)  # nothing is entered
    assert capfd.readouterr().err == ""


def test_bad_input() -> None:
    for wrong in (None, 3, "yes"):
        for load in (lambda: aureole.load_dict(SCENE, progress=wrong), lambda: aureole.load_string("<scene/>", progress=wrong),  # noqa: B023
                     lambda: aureole.load_file("none.xml", progress=wrong)):  # noqa: B023
            with pytest.raises(TypeError, match="progress: expected True, False or a function"):
                load()
