# SPDX-License-Identifier: Apache-2.0
"""Plots: the numbers in the artists are the right ones, and the axes are the caller's."""
from __future__ import annotations

import subprocess
import sys

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import aureole
from aureole import optics, plot, spectrum


@pytest.fixture(autouse=True)
def close_figures():
    yield
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()  # what cannot be drawn raises here
    plt.close("all")


@pytest.fixture(scope="module")
def rough():
    return aureole.load_dict({"type": "roughconductor", "alpha": 0.3, "material": "Cu"})


def polar_axes():
    return plt.subplots(subplot_kw={"projection": "polar"})[1]


def flat_axes():
    return plt.subplots()[1]


def curves(ax, n):
    """Data of the lines with n points."""
    return [line.get_xydata() for line in ax.lines if len(line.get_xdata()) == n]


@pytest.mark.parametrize("log", [False, True])
def test_lobe_polar_is_eval(rough, log):
    nm = [450, 550, 650]
    given = polar_axes()
    ax = plot.lobe_polar(rough, 30, nm, samples=721, log=log, decades=5, ax=given)
    assert ax is given
    lines = curves(ax, 721)
    assert len(lines) == 3
    wi = [-0.5, 0, np.sqrt(0.75)]
    for k, data in enumerate(lines):
        wo = np.stack([np.sin(data[:, 0]), 0 * data[:, 0], np.cos(data[:, 0])], -1)
        values = rough.eval(wi, wo, nm[k])
        if log:
            values = np.maximum(values, max(c[:, 1].max() for c in lines) * 1e-5)
        np.testing.assert_allclose(data[:, 1], values, rtol=1e-6, atol=1e-12)
        # The lobe lies on the other side of the normal: at a positive angle.
        assert 15 < np.degrees(data[np.argmax(data[:, 1]), 0]) < 60
    red, green, blue = (line.get_color() for line in [ln for ln in ax.lines if len(ln.get_xdata()) == 721][::-1])
    assert red[0] > red[2] and blue[2] > blue[0] and green[1] > max(green[0], green[2])


def test_lobe_polar_without_cosine(rough):
    with_cosine, without = (curves(plot.lobe_polar(rough, 40, cosine=c, samples=361), 361)[0] for c in (True, False))
    cosine = np.abs(np.cos(with_cosine[:, 0]))
    np.testing.assert_allclose(without[:, 1] * cosine, with_cosine[:, 1], atol=1e-6)


def test_lobe_polar_transmits():
    ax = plot.lobe_polar(aureole.load_dict({"type": "roughdielectric", "alpha": 0.1}), 30, samples=3601)
    angle, value = curves(ax, 3601)[0].T
    below = np.abs(angle) > np.pi / 2
    # Snell: 30 degrees in air is 19.4 in glass of 1.5046, behind the normal.
    assert np.degrees(angle[below][np.argmax(value[below])]) == pytest.approx(180 - 19.4, abs=2)


def test_lobe_map_is_eval(rough):
    given = flat_axes()
    ax = plot.lobe_map(rough, 50, 600, resolution=101, ax=given)
    assert ax is given
    image = ax.images[0].get_array()
    assert image.shape == (101, 101)
    at = (np.arange(101) + 0.5) * 2 / 101 - 1
    theta = np.radians(50)
    wi = [-np.sin(theta), 0, np.cos(theta)]
    for row, column in ((50, 50), (50, 80), (20, 60)):
        x, y = at[column], at[row]
        value = rough.eval(wi, [x, y, np.sqrt(1 - x * x - y * y)], 600)
        assert image[row, column] == pytest.approx(float(value), rel=1e-6)
    assert np.ma.getmaskarray(np.ma.masked_invalid(image))[0, 0]
    assert image.shape[0] and ax.images[0].get_extent() == [-1, 1, -1, 1]
    # The mirror direction is marked.
    marked = [ln for ln in ax.lines if len(ln.get_xdata()) == 1][0].get_xydata()[0]
    np.testing.assert_allclose(marked, [np.sin(theta), 0], atol=1e-12)


def test_lobe_map_of_transmission():
    glass = aureole.load_dict({"type": "roughdielectric", "alpha": 0.2})
    image = plot.lobe_map(glass, 30, side="transmission", resolution=64, cosine=False).images[0].get_array()
    x = (np.arange(64) + 0.5) / 32 - 1
    column = int(np.nanargmax(np.nanmax(np.asarray(image), axis=0)))
    assert x[column] == pytest.approx(0.5 / 1.5, abs=0.08)


def test_spectrum():
    nm = np.arange(360, 831.0)
    values = spectrum.illuminant("A", nm)
    given = flat_axes()
    ax = plot.spectrum(nm, values, label="A", ax=given, unit="W/nm")
    assert ax is given
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), np.stack([nm, values], -1))
    colours = ax.images[0].get_array()[0]
    assert ax.images[0].get_extent()[:2] == [380, 780]
    at = dict(zip(np.arange(380, 781), np.asarray(colours)))
    assert np.argmax(at[460]) == 2 and np.argmax(at[530]) == 1 and np.argmax(at[640]) == 0
    assert ax.get_xlabel() == "wavelength [nm]" and "W/nm" in ax.get_ylabel()


def test_spectra_on_one_axes():
    nm = np.arange(400, 701.0)
    ax = plot.spectrum(nm, spectrum.illuminant("A", nm), fill=False)
    plot.spectrum(nm, spectrum.illuminant("D65", nm) * 2, fill=False, ax=ax)
    assert len(ax.lines) == 2 and len(ax.child_axes) == 1
    assert ax.get_ylim()[1] >= 2 * spectrum.illuminant("D65", nm).max()


def test_phase_function_of_spheres():
    given = polar_axes()
    ax = plot.phase_function(x=5, m=1.33, theta=np.linspace(0, 180, 91), ax=given)
    assert ax is given
    angle, p = curves(ax, 182)[0].T
    np.testing.assert_allclose(p, optics.mie_phase_function(5, 1.33, np.cos(angle)).reshape(-1), rtol=1e-9)
    np.testing.assert_allclose(p, p[::-1])


def test_phase_function_of_values():
    theta = np.linspace(0, 180, 37)
    p = np.full(37, 1 / (4 * np.pi))
    ax = plot.phase_function(theta, p, polar=False, log=False)
    np.testing.assert_allclose(ax.lines[0].get_xydata(), np.stack([theta, p], -1))
    assert ax.get_yscale() == "linear"
    assert plot.phase_function(theta, p, polar=False).get_yscale() == "log"


def test_phase_function_of_a_plugin():
    phase = aureole.load_dict({"type": "hg", "g": 0.6})
    ax = plot.phase_function(phase=phase, theta=np.linspace(0, 180, 91), polar=False)
    theta, p = ax.lines[0].get_xydata().T
    expected = (1 - 0.36) / (4 * np.pi * (1.36 - 1.2 * np.cos(np.radians(theta))) ** 1.5)
    np.testing.assert_allclose(p, expected, rtol=1e-5)
    with pytest.raises(aureole.Error, match="values: expected one of"):
        plot.phase_function(phase=phase, x=1, m=1.3)
    with pytest.raises(TypeError, match="phase: expected a phase function"):
        plot.phase_function(phase="hg")


def test_efficiency():
    radius = np.geomspace(1e-8, 1e-5, 40)
    given = flat_axes()
    ax = plot.efficiency(1.33 + 0.01j, radius, wavelength=500, medium=1.5, ax=given)
    assert ax is given and ax.get_xlabel() == "radius [um]" and ax.get_xscale() == "log"
    assert [line.get_label() for line in ax.lines] == ["extinction", "scattering", "absorption"]
    extinction, scattering, absorption = (line.get_xydata() for line in ax.lines)
    np.testing.assert_allclose(extinction[:, 0], radius * 1e6)
    np.testing.assert_allclose(scattering[:, 1] + absorption[:, 1], extinction[:, 1], rtol=1e-9)
    np.testing.assert_allclose(extinction[:, 1], optics.mie(2 * np.pi * radius * 1.5 / 500e-9, 1.33 + 0.01j).qext)
    # Small spheres scatter as Rayleigh says, 8/3 x^4 |(m^2 - 1)/(m^2 + 2)|^2, large ones twice what they cover.
    ax = plot.efficiency(1.2, x=[1e-2, 3000.0], quantity="qsca", label="m = 1.2")
    assert ax.get_xlabel() == "size parameter" and ax.get_legend().get_texts()[0].get_text() == "m = 1.2"
    small, large = ax.lines[0].get_ydata()
    assert small == pytest.approx(8 / 3 * 1e-8 * (0.44 / 3.44) ** 2, rel=1e-3)
    assert large == pytest.approx(2, abs=0.05)
    # The axis grows with the curves.
    before = ax.get_ylim()[1]
    plot.efficiency(1.6, x=np.linspace(1, 6, 50), quantity="qsca", ax=ax)
    assert ax.get_ylim()[1] > 4 > before
    with pytest.raises(aureole.Error, match="quantity: expected"):
        plot.efficiency(1.2, quantity="qback")
    with pytest.raises(aureole.Error, match="x: expected either"):
        plot.efficiency(1.2, radius, x=1.0)


def first_minimum(angle, value):
    inner = np.flatnonzero((value[1:-1] < value[:-2]) & (value[1:-1] <= value[2:]))[0] + 1
    return angle[inner]


def test_first_dark_ring_is_airys():
    """Independent places: where openings are sparse, each makes its own Airy pattern."""
    airy = np.degrees(np.arcsin(3.8317059702 / (2 * np.pi * 8e-6 / 550e-9)))
    given = flat_axes()
    ax = plot.corona_profile(radius="8um", area_fraction=0.002, correlation="poisson", wavelength=[450, 550], field=6,
                             samples=3001, ax=given)
    assert ax is given
    assert first_minimum(*curves(ax, 3001)[1].T) == pytest.approx(airy, abs=0.004)
    assert first_minimum(*curves(ax, 3001)[0].T) == pytest.approx(airy * 450 / 550, abs=0.004)
    # The picture in light of 550 nm has it in the same place, in each direction.
    picture = plot.corona(radius="8um", area_fraction=0.002, correlation="poisson", lamp=550, lamp_diameter=0, field=6,
                          resolution=401)
    image = np.asarray(picture.images[0].get_array())
    assert picture.images[0].get_extent() == [-6, 6, -6, 6]
    at = (np.arange(401) - 200) * 12 / 401
    for line in (image[200, 200:, 1], image[200:, 200, 1], image[200, 200::-1, 1]):
        assert first_minimum(at[200:], line) == pytest.approx(airy, abs=12 / 401)


def test_corona_radii():
    """A radius in metres, and the picture's own width."""
    a = plot.corona_profile(radius="8um", area_fraction=0.3)
    b = plot.corona_profile(radius=8e-6, area_fraction=0.3)
    np.testing.assert_allclose(a.lines[0].get_xydata(), b.lines[0].get_xydata(), rtol=1e-6)


def test_corona_is_blue_inside_and_red_outside():
    """Red light of each ring is diffracted more."""
    given = flat_axes()
    ax = plot.corona(radius="8um", area_fraction=0.2, correlation="poisson", lamp_diameter=0, field=6, resolution=201,
                     ax=given)
    assert ax is given
    row = np.asarray(ax.images[0].get_array())[100, 100:]
    at = np.arange(101) * 12 / 201
    inside, outside = row[np.searchsorted(at, 1.9)], row[np.searchsorted(at, 2.35)]
    assert outside[0] / outside[2] > 1.3 * inside[0] / max(inside[2], 1e-3) or outside[2] > outside[0]
    dark_blue = at[np.argmin(row[: np.searchsorted(at, 3), 2])]
    dark_red = at[np.argmin(row[: np.searchsorted(at, 3.4), 0])]
    assert 1.5 < dark_blue < dark_red < 3.2


def test_a_lamp_that_is_no_point_blurs_the_rings():
    from aureole import _corona

    layer = _corona.layer(None, "8um", 0.2, "poisson", None)[0]
    nm = np.arange(400, 701, 20.0)
    sharp = _corona.picture(layer, "D65", 0.0, 5.0, 101, nm)
    soft = _corona.picture(layer, "D65", 1.0, 5.0, 101, nm)
    # The light is spread, not changed: means over many rings agree.
    middle = (slice(20, 81),) * 2
    assert soft[middle].mean() == pytest.approx(sharp[middle].mean(), rel=0.02)
    # Against the mean over the points of the lamp, in a dark ring too.
    pixel = 10 / 101
    offset = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 41)] * 2), -1).reshape(-1, 2)
    offset = offset[np.hypot(*offset.T) <= 0.5]
    colours, to_rgb = _corona.lamp_colours("D65", nm)
    for column, row in ((50, 50), (74, 50), (70, 45), (50, 16)):
        x, y = (column - 50) * pixel, (50 - row) * pixel
        direct = (_corona.radiance(layer, x + offset[:, 0], y + offset[:, 1], colours) @ to_rgb).mean(0)
        np.testing.assert_allclose(soft[row, column], direct, rtol=0.03, atol=0.01 * direct.max())
    assert soft[50, 74, 1] > 1.5 * sharp[50, 74, 1]


def test_lamps():
    for lamp in ("A", 589, ([400, 500, 600, 700], [0, 1, 1, 0])):
        image = np.asarray(plot.corona(radius="5um", area_fraction=0.4, lamp=lamp, resolution=16).images[0].get_array())
        assert image.max() > 0.3
    yellow = image = np.asarray(plot.corona(radius="5um", area_fraction=0.4, lamp=589,
                                            resolution=16).images[0].get_array())
    lit = yellow.max(axis=-1) > 0.1
    assert np.all(image[lit][:, 2] <= image[lit][:, 0])


@pytest.mark.parametrize("function, x, label", [(plot.pair_correlation, "distance r [um]", "g(r)"),
                                               (plot.structure_factor, "wave number q [um]", "S(q)")])
def test_bands(function, x, label):
    q, s = np.linspace(0.1, 5, 30), np.linspace(0, 1, 30)
    given = flat_axes()
    ax = function(q, s, 0.1 + 0 * q, unit="um", label="data", ax=given)
    assert ax is given and ax.get_xlabel() == x and ax.get_ylabel() == label
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), np.stack([q, s], -1))
    band = ax.collections[0].get_paths()[0].vertices
    assert band[:, 1].min() == pytest.approx(-0.1) and band[:, 1].max() == pytest.approx(1.1)
    function(q, s, ax=ax)
    assert len(ax.collections) == 1 and len(ax.lines) == 3  # and the line of 1, once


def test_report():
    report = aureole.check(aureole.load_dict({"type": "roughconductor", "alpha": 0.3}), samples=20_000)
    axes = report.plot()
    assert len(axes) == 3
    above = report.angles <= 90
    np.testing.assert_allclose(axes[0].lines[0].get_xydata(),
                               np.stack([report.angles[above], report.albedo[above, 0]], -1))
    bound = [ln for ln in axes[0].lines if ln.get_linestyle() == "--"][0]
    assert list(bound.get_ydata()) == [1, 1]
    worst = min(report.histograms, key=lambda h: h.p_value)
    points = axes[1].collections[1].get_offsets()
    assert points[:, 0].sum() == pytest.approx(worst.expected.sum(), rel=0.05)
    assert f"p = {worst.p_value:.2g}" in axes[1].get_title()
    pairs = axes[2].collections[0].get_offsets()
    np.testing.assert_allclose(pairs[:, 0], pairs[:, 1], rtol=3e-3)
    given = plt.subplots(1, 3)[1]
    assert all(a is b for a, b in zip(report.plot(given), given))
    with pytest.raises(aureole.Error, match="axes: expected three"):
        report.plot(given[:2])


def test_report_of_a_mirror():
    aureole.check(aureole.load_dict({"type": "conductor"}), samples=1000).plot()


def diffuse():
    return aureole.load_dict({"type": "diffuse"})


@pytest.mark.parametrize("call, error, message", [
    (lambda: plot.lobe_polar(3, 30), TypeError, "bsdf"),
    (lambda: plot.lobe_polar(diffuse(), 200), aureole.Error, "theta_i"),
    (lambda: plot.lobe_polar(diffuse(), np.nan), aureole.Error, "theta_i"),
    (lambda: plot.lobe_polar(diffuse(), 30, 1e6), aureole.Error, "wavelength"),
    (lambda: plot.lobe_polar(diffuse(), 30, []), (aureole.Error, TypeError), "wavelength"),
    (lambda: plot.lobe_polar(diffuse(), 30, samples=1), aureole.Error, "samples"),
    (lambda: plot.lobe_polar(diffuse(), 30, log="yes"), TypeError, "log"),
    (lambda: plot.lobe_polar(diffuse(), 30, ax=flat_axes()), aureole.Error, "ax: expected polar"),
    (lambda: plot.lobe_polar(diffuse(), 30, ax=3), TypeError, "ax"),
    (lambda: plot.lobe_map(diffuse(), 30, side="both"), aureole.Error, "side"),
    (lambda: plot.lobe_map(diffuse(), 30, resolution=100000), aureole.Error, "resolution"),
    (lambda: plot.lobe_map(diffuse(), 30, ax=polar_axes()), aureole.Error, "ax: expected rectilinear"),
    (lambda: plot.spectrum([500, 400], [1, 2]), aureole.Error, "wavelength"),
    (lambda: plot.spectrum([400, 500], [1, 2, 3]), aureole.Error, "values"),
    (lambda: plot.spectrum([400, 500], [1, np.inf]), aureole.Error, "values"),
    (lambda: plot.phase_function(), aureole.Error, "theta"),
    (lambda: plot.phase_function(x=3), aureole.Error, "m: expected"),
    (lambda: plot.phase_function([0, 90], [1, -1]), aureole.Error, "values"),
    (lambda: plot.phase_function([0, 270], [1, 1]), aureole.Error, "theta"),
    (lambda: plot.corona(), aureole.Error, "radius"),
    (lambda: plot.corona(radius="5um"), aureole.Error, "area_fraction"),
    (lambda: plot.corona(radius=5, area_fraction=0.3), aureole.Error, "radius.*m "),
    (lambda: plot.corona(radius="5um", area_fraction=2), aureole.Error, "area_fraction"),
    (lambda: plot.corona(diffuse(), radius="5um"), aureole.Error, "radius"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, correlation="nothing"), aureole.Error, "nothing"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, lamp="sun"), aureole.Error, "illuminant"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, lamp=100), aureole.Error, "lamp"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, lamp=object()), TypeError, "lamp"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, lamp_diameter=-1), aureole.Error, "lamp_diameter"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, field=100), aureole.Error, "field"),
    (lambda: plot.corona(radius="5um", area_fraction=0.3, wavelengths=[500, 400]), aureole.Error, "wavelengths"),
    (lambda: plot.pair_correlation([1, 2], [1]), aureole.Error, "g: expected"),
    (lambda: plot.structure_factor([1, 2], [1, 1], [1, 2, 3]), aureole.Error, "error"),
    (lambda: plot.structure_factor([1, 2], [1, 1], -1), aureole.Error, "error"),
])
def test_wrong_arguments(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_without_matplotlib():
    code = ("import sys; sys.modules['matplotlib'] = None; import aureole\n"
            "try: aureole.plot.spectrum([400, 500], [1, 1])\n"
            "except ImportError as e: print(e)")
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install aureole[plot]" in found.stdout
