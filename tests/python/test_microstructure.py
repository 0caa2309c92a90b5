# SPDX-License-Identifier: Apache-2.0
"""`aureole.microstructure`: synthetic pictures with a known truth, photographs, bad input."""
import re

import numpy as np
import pytest

import aureole
from aureole import optics


def picture_of(discs, n=400, pixel=0.4, blur=0.8, noise=0.03, bright=False, origin=(20, 20)):
    at = (np.arange(n * 4) + 0.5) * pixel / 4
    covered = np.zeros((n * 4, n * 4), bool)
    for (x, y), r in zip(discs.positions - np.array(origin), discs.radius):
        (i0, i1), (j0, j1) = np.searchsorted(at, [x - r, x + r]), np.searchsorted(at, [y - r, y + r])
        covered[j0:j1, i0:i1] |= (at[j0:j1, None] - y) ** 2 + (at[i0:i1] - x) ** 2 < r**2
    coverage = covered.reshape(n, 4, n, 4).mean((1, 3))
    f = np.fft.fftfreq(n)
    coverage = np.fft.ifft2(np.fft.fft2(coverage) * np.exp(-2 * (np.pi * blur) ** 2 * (f[:, None] ** 2 + f**2))).real
    grey = 0.7 - 0.45 * coverage if not bright else 0.2 + 0.5 * coverage
    return grey + np.random.default_rng(1).normal(0, noise, (n, n))


@pytest.fixture(scope="module")
def discs():
    return optics.hard_discs(700, 0.4, seed=5, radius=4.0)


@pytest.fixture(scope="module")
def picture(discs):
    return picture_of(discs)


@pytest.fixture(scope="module")
def found(picture):
    return aureole.microstructure(picture, "0.4um")


def test_truth_is_found(found, discs):
    assert found.mean_radius.value == pytest.approx(4e-6, rel=2e-3)
    assert found.correlation_radius.value == pytest.approx(4e-6, rel=0.01)
    assert found.area_fraction.low < 0.4 < found.area_fraction.high and found.area_fraction.value == pytest.approx(0.4, abs=0.03)
    assert found.density.value == pytest.approx(0.4 / (np.pi * 16e-12), rel=0.08)
    assert found.round and found.notes == []
    # Every particle is where a disc is.
    centres = np.stack([found.particles.x, found.particles.y], -1)[~found.particles.cut] * 1e6 + 20
    nearest = np.min(np.linalg.norm(centres[:, None] - discs.positions, axis=-1), axis=1)
    assert len(centres) > 100 and np.max(nearest) < 0.2 and np.median(nearest) < 0.02  # half a pixel; a twentieth
    assert found.particles.weight.sum() == pytest.approx(1) and np.all(found.particles.weight[found.particles.cut] == 0)
    assert len(found.particles) == found.fields[0]["whole"] + found.fields[0]["cut"]


def test_curves_are_those_of_hard_discs(found):
    g, s = found.pair_correlation, found.structure_factor
    contact = (g.r > 8.2e-6) & (g.r < 9.5e-6)
    assert np.mean(g.g[contact]) == pytest.approx(np.mean(optics.hard_disc_pair_correlation(g.r[contact] / 4e-6, 0.4)), rel=0.15)
    assert np.all(g.g[g.r < 7.6e-6] == 0)
    theory = optics.structure_factor(s.q * 4e-6, 0.4)
    assert np.mean((s.s - theory) ** 2 / np.maximum(s.error, 0.02) ** 2) < 3
    assert np.all((s.low <= s.s) & (s.s <= s.high))


def test_outlines_are_closed_curves_around_particles(found):
    p = found.particles
    k = int(np.flatnonzero(~p.cut)[0])
    x, y = p.outline[k].T
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    assert area == pytest.approx(p.area[k], rel=0.02)
    assert p.outline[int(np.flatnonzero(p.cut)[0])].shape == (0, 2)


def test_material_is_a_layer(found):
    description = found.material()
    assert description["type"] == "correlated_scatterers"
    layer = aureole.load_dict(description)
    truth = aureole.load_dict({"type": "correlated_scatterers", "radius": "4um", "area_fraction": 0.4})
    t = np.radians([0.5, 2, 6])
    wi = np.stack([np.sin(t), 0 * t, np.cos(t)], -1)
    assert layer.eval(wi, [0, 0, -1], 550) == pytest.approx(truth.eval(wi, [0, 0, -1], 550), rel=0.15)
    assert isinstance(aureole.load_string(re.search(r"<bsdf.*</bsdf>", found.scene_text, re.DOTALL)[0]), aureole.Bsdf)


def test_scatterers_are_chosen_visibly(picture, found):
    assert len(found.choices) == 2 and "scatterer apertures" in found.choices[1] and "choice" in str(found)
    assert found.material()["scatterer"] == "discs"
    beads = aureole.microstructure(picture, "0.4um", polarity="dark", scatterer="spheres", int_ior=1.5, overlays=False)
    assert beads.choices == [] and beads.material()["type"] == "correlated_spheres" and beads.material()["int_ior"] == 1.5
    assert aureole.microstructure(picture, "0.4um", scatterer="apertures", overlays=False).material()["scatterer"] == "apertures"
    for arguments, message in (({"scatterer": "spheres"}, "scatterer spheres needs int_ior"), ({"int_ior": 1.5}, "int_ior is for"),
                               ({"scatterer": "disks"}, "scatterer")):
        with pytest.raises(aureole.Error, match=message):
            aureole.microstructure(picture, "0.4um", **arguments)


def test_sizes_become_classes_without_files():
    radii = np.random.default_rng(0).uniform(2.5, 4.0, 500)
    discs = optics.hard_discs(500, 0.25, seed=2, radius=radii)
    found = aureole.microstructure(picture_of(discs), 4e-7)
    assert found.radius_deviation.value == pytest.approx(radii.std() * 1e-6, rel=0.2)
    circles = [v for v in found.material().values() if isinstance(v, dict)]
    assert len(circles) >= 4 and sum(c["fraction"] for c in circles) == pytest.approx(1)
    assert isinstance(aureole.load_dict(found.material()), aureole.Bsdf)


def test_aligned_shapes_keep_their_direction(tmp_path):
    """Ellipses of 2 : 1, their long axes 30 degrees counter-clockwise of x as the picture shows them."""
    n, angle = 420, np.radians(30)
    y, x = np.mgrid[0:n, 0:n] + 0.5
    grey = np.full((n, n), 0.8)
    for cx, cy in optics.hard_discs(64, 0.35, seed=4, radius=20).positions:
        along, across = (x - cx) * np.cos(angle) - (y - cy) * np.sin(angle), (x - cx) * np.sin(angle) + (y - cy) * np.cos(angle)
        grey -= 0.5 * np.clip(0.5 + 10 * (1 - np.hypot(along / 17, across / 8.5)), 0, 1)
    found = aureole.microstructure(grey, "0.5um")
    found.save(tmp_path / "found")
    aperture = found.material(tmp_path / "found")["aperture"]
    assert aperture["rotation"] % 180 == pytest.approx(30, abs=1) and "random_rotation" not in aperture
    # The layer spreads light most across the long axes.
    layer = aureole.load_dict(found.material(tmp_path / "found"))
    phi, t = np.radians(np.arange(0, 180, 10)), np.radians(2.5)
    wi = np.stack([np.sin(t) * np.cos(phi), np.sin(t) * np.sin(phi), np.full(phi.shape, np.cos(t))], -1)
    assert 10 * int(np.argmax(layer.eval(wi, [0, 0, -1], 550))) in (110, 120, 130)


def test_fields_are_pooled(discs, picture):
    other = picture_of(discs, origin=(2, 30))
    two = aureole.microstructure([picture, other], "400nm", overlays=False)
    assert len(two.fields) == 2 and set(two.particles.field) == {0, 1} and two.overlays == []
    assert two.mean_radius.value == pytest.approx(4e-6, rel=2e-3)


def test_polarity_and_kinds_of_arrays(discs, picture, found):
    bright = aureole.microstructure(picture_of(discs, bright=True), "0.4um", overlays=False)
    assert bright.fields[0]["bright"] and not found.fields[0]["bright"]
    assert bright.mean_radius.value == pytest.approx(4e-6, rel=3e-3)
    same = aureole.microstructure(aureole.Image(np.repeat(picture[..., None], 3, axis=2)), "0.4um", overlays=False)
    assert same.mean_radius.value == pytest.approx(found.mean_radius.value, rel=1e-4)
    assert aureole.microstructure(picture.tolist(), "0.4um", overlays=False).mean_radius == found.mean_radius


def test_mask_leaves_parts_out(picture):
    mask = np.ones(picture.shape, bool)
    mask[:, 200:] = False
    half = aureole.microstructure(picture, "0.4um", mask=mask, overlays=False)
    assert np.max(half.particles.x) < 201 * 0.4e-6
    assert half.fields[0]["seen"] == pytest.approx(400 * 200 * 0.16e-12)


def test_photograph(repository, tmp_path):
    found = aureole.microstructure(repository / "tests/instrument/data/blobs.png", "1um")
    assert found.fields[0]["whole"] == pytest.approx(46, abs=2) and not found.round
    with pytest.raises(aureole.Error, match="folder: "):
        found.material()
    found.save(tmp_path / "blobs")
    assert {"result.json", "scene.xml", "overlay-0.png"} <= {p.name for p in (tmp_path / "blobs").iterdir()}
    assert (tmp_path / "blobs" / found.material(tmp_path / "blobs")["aperture"]["filename"]).is_file()
    with pytest.raises(aureole.Error):  # not a result
        (tmp_path / "other").mkdir()
        (tmp_path / "other" / "mine.txt").write_text("mine")
        found.save(tmp_path / "other")


def test_tables(found, tmp_path):
    found.to_csv(tmp_path / "a.csv")
    rows = [line.split(",") for line in (tmp_path / "a.csv").read_text().splitlines()]
    assert rows[0] == ["quantity", "unit", "value", "low", "high"]
    table = {row[0]: row[1:] for row in rows[1:]}
    assert table["mean_radius"] == ["m", *(str(v) for v in found.mean_radius)] and table["density"][0] == "1/m^2"
    assert {name for name in table if name.startswith("radius_quantile")} == {f"radius_quantile_{p:g}" for p in found.radius_quantiles}
    assert "<td>mean_radius</td>" in found._repr_html_() and "correlation radius" in found._repr_html_()
    particles = found.particles.to_csv().splitlines()
    assert particles[0] == "field,x_m,y_m,radius_m,area_m2,circularity,aspect,angle_deg,cut,touching,weight"
    assert len(particles) == len(found.particles) + 1 and float(particles[1].split(",")[3]) == found.particles.radius[0]
    assert "<th>radius_m</th>" in found.particles._repr_html_()


def test_it_tells_of_itself(found):
    text = repr(found)
    assert "mean radius" in text and "um" in text and "4.0" in text
    assert f"{found.area_fraction:.2f}".startswith("0.4") and float(found.area_fraction) == found.area_fraction.value
    pytest.importorskip("matplotlib").use("Agg")
    axes = found.plot()
    assert axes.shape == (3,) and all(ax.get_xlabel() for ax in axes)
    with pytest.raises(aureole.Error, match="axes: expected three"):
        found.plot(axes[:2])


NOISE = np.random.default_rng(0).random((64, 64))


@pytest.mark.parametrize("arguments, error, words", [
    ({"images": NOISE}, aureole.Error, "pixel_size"),
    ({"images": NOISE, "pixel_size": "2"}, aureole.Error, "pixel_size.*0.2um"),
    ({"images": NOISE, "pixel_size": -1}, aureole.Error, "pixel_size"),
    ({"images": NOISE, "pixel_size": np.nan}, aureole.Error, "pixel_size"),
    ({"images": NOISE[:10], "pixel_size": 1e-6}, aureole.Error, "images: expected at least 32"),
    ({"images": NOISE[0], "pixel_size": 1e-6}, aureole.Error, "images: expected shape"),
    ({"images": NOISE * np.nan, "pixel_size": 1e-6}, aureole.Error, "images: expected finite"),
    ({"images": NOISE * 1e300, "pixel_size": 1e-6}, aureole.Error, "images: expected numbers that fit"),
    ({"images": NOISE * 0, "pixel_size": 1e-6}, aureole.Error, "images"),
    ({"images": None, "pixel_size": 1e-6}, TypeError, "images"),
    ({"images": [], "pixel_size": 1e-6}, aureole.Error, "images"),
    ({"images": "none.png", "pixel_size": 1e-6}, aureole.Error, "none.png"),
    ({"images": NOISE, "pixel_size": 1e-6, "mask": np.ones((3, 3), bool)}, aureole.Error, "mask"),
    ({"images": NOISE, "pixel_size": 1e-6, "mask": np.ones((64, 64))}, TypeError, "mask"),
    ({"images": NOISE, "pixel_size": 1e-6, "mask": np.zeros((64, 64), bool)}, aureole.Error, "mask: leaves 0"),
    ({"images": NOISE, "pixel_size": 1e-6, "mask": [np.ones((64, 64), bool)] * 2}, aureole.Error, "mask: expected one"),
    ({"images": NOISE, "pixel_size": 1e-6, "polarity": "grey"}, aureole.Error, "polarity: expected one of auto"),
    ({"images": NOISE, "pixel_size": 1e-6, "background": "morphology"}, aureole.Error, "background_scale"),
    ({"images": NOISE, "pixel_size": 1e-6, "resamples": 1}, aureole.Error, "resamples"),
    ({"images": NOISE, "pixel_size": 1e-6, "fill_holes": "yes"}, TypeError, "fill_holes"),
    ({"images": NOISE, "pixel_size": 1e-6, "seed": -1}, aureole.Error, "seed"),
])
def test_bad_input(arguments, error, words):
    with pytest.raises(error, match=words) as caught:
        aureole.microstructure(**arguments)
    assert "--" not in str(caught.value)
