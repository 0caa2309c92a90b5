# SPDX-License-Identifier: Apache-2.0
"""Grids as files and as arrays."""
import numpy as np
import pytest

import aureole


def test_what_is_written_is_read(tmp_path):
    values = np.random.default_rng(1).random((3, 4, 5, 3), dtype=np.float32)
    box = [[0, -1, 2], [1, 3, 5]]
    aureole.write_vol(tmp_path / "a.vol", values, box)
    found, found_box = aureole.read_vol(tmp_path / "a.vol")
    assert (found == values).all() and (found_box == box).all()


def test_the_renderer_reads_it(tmp_path):
    aureole.write_vol(tmp_path / "a.vol", np.ones((2, 3, 4)))
    aureole.load_dict({"type": "gridvolume", "filename": str(tmp_path / "a.vol")})
    aureole.load_dict({"type": "gridvolume", "data": np.ones((2, 3, 4))})
    with pytest.raises(aureole.Error, match="got 3 x 4"):
        aureole.load_dict({"type": "gridvolume", "data": np.ones((3, 4))})


@pytest.mark.parametrize("values, box, message", [
    (np.ones((2, 3)), ((0, 0, 0), (1, 1, 1)), "depth x height x width"),
    (np.ones((2, 3, 4, 2)), ((0, 0, 0), (1, 1, 1)), "depth x height x width"),
    (np.full((1, 1, 1), np.nan), ((0, 0, 0), (1, 1, 1)), "values"),
    (np.full((1, 1, 1), 1e300), ((0, 0, 0), (1, 1, 1)), "single precision"),
    (np.ones((1, 1, 1)), ((0, 0, 0), (1, 0, 1)), "box"),
])
def test_wrong_arguments(tmp_path, values, box, message):
    with pytest.raises((aureole.Error, ValueError, TypeError), match=message):
        aureole.write_vol(tmp_path / "a.vol", values, box)
    assert not (tmp_path / "a.vol").exists()


def test_wrong_files(tmp_path):
    file = tmp_path / "a.vol"
    aureole.write_vol(file, np.ones((2, 2, 2)))
    content = file.read_bytes()
    for damaged in (b"", content[:20], content[:-1], b"VOL\x02" + content[4:], content[:4] + b"\2" + content[5:]):
        file.write_bytes(damaged)
        with pytest.raises(aureole.Error):
            aureole.read_vol(file)


def test_a_picture_states_the_errors_of_its_approximations():
    def states(**of_integrator):
        volume = {"type": "gridvolume", "data": np.linspace(0, 1, 8, dtype=np.float32).reshape(1, 1, 8) * np.ones((8, 8, 1), np.float32), "raw": True}
        box = {"type": "cube", "bsdf": {"type": "null"}, "interior": {
            "type": "classified", "value": volume, "opacity": "0 0, 0.45 0, 0.5 0.5, 0.55 0, 1 0", "colors": "0 1 0 0, 1 0 0 1"}}
        scene = aureole.load_dict({
            "type": "scene", "length_unit": "mm", "integrator": {"type": "dvr", **of_integrator}, "box": box, "emitter": {"type": "constant"},
            "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 8},
                       "to_world": aureole.Transform.look_at((5, 4, 3), (0, 0, 0), (0, 0, 1))}})
        return aureole.render(scene, spp=1, progress=False).info["approximations"]

    coarse, fine = (float(states(step=step)[0].split("light by ")[1].split(" %")[0]) for step in (2.0, 0.125))
    assert coarse > 4 * fine
    assert any("taylor" in line for line in states(alpha="taylor"))
    assert states(classification="preintegrated", termination=0.0) != states(termination=0.0)
