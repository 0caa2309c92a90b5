# SPDX-License-Identifier: Apache-2.0
"""Instruments of the laboratory in Python: their figures are the program's; fits, plots, files; appearance and rendering of colours."""
import json
import math
import os
import subprocess

import numpy as np
import pytest

import aureole

SCENE = """<scene version="3.0.0">
  <bsdf type="diffuse" id="grey"><float name="reflectance" value="0.3"/></bsdf>
  <bsdf type="roughconductor" id="metal"><string name="material" value="none"/><string name="distribution" value="ggx"/>
    <float name="alpha" value="0.3"/></bsdf>
  <bsdf type="thindielectric" id="pane"/>
  <bsdf type="plastic" id="black"><float name="diffuse_reflectance" value="0"/><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>
  <shape type="cube" id="slab"><transform name="to_world"><scale x="0.1" y="0.1" z="0.01"/></transform><bsdf type="null"/>
    <medium type="homogeneous" name="interior"><float name="sigma_t" value="1000"/><float name="albedo" value="0.99"/></medium></shape>
</scene>"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("laboratory") / "m.xml"
    path.write_text(SCENE)
    return path


def program(scene, *words):
    done = subprocess.run([os.environ["AUREOLE_BINARY"], *map(str, words)], cwd=scene.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def figures(scene, *words):
    program(scene, *words, "--json", "out.json")
    return json.loads((scene.parent / "out.json").read_text())


def test_spectrophotometer_reads_as_the_program_does(scene):
    found = aureole.spectrophotometer(f"{scene}#grey", "di:8", theory=True, paths=4096, noise=0.001, standard_error=0.003, seed=3)
    theirs = figures(scene, "spectrophotometer", "m.xml#grey", "--geometry", "di:8", "--theory", "--paths", 4096, "--noise", 0.001,
                     "--standard-error", 0.003, "--seed", 3)
    assert found.values.tolist() == theirs["values"] and found.wavelength.tolist() == theirs["wavelengths_nm"]
    np.testing.assert_allclose(found.uncertainty, theirs["standard_uncertainty"], rtol=1e-12)
    assert set(found.causes) == {"tracing", "detector", "standard", "wavelength"} and found.edge_loss is None
    np.testing.assert_allclose(found.values, 0.3, atol=0.003)
    assert "reflectance factor at di:8" in found._repr_html_() and found.to_csv().startswith("wavelength_nm,value,uncertainty,u_tracing")
    for name in ("r.csv", "r.cxf", "r.cgats"):
        found.save(scene.parent / name)
        (colour,) = aureole.color(scene.parent / name, observer=10)
        assert colour.xyz[1] == pytest.approx(30, abs=0.2)
    with pytest.raises(aureole.Error, match="the ending says what is written"):
        found.save(scene.parent / "r.doc")
    assert aureole.color(found)[0].xyz[1] == pytest.approx(30, abs=0.2)


def test_spectrophotometer_measures_bsdfs_gloss_and_haze(scene):
    bsdf = aureole.load_dict({"type": "diffuse", "reflectance": 0.5})
    found = aureole.spectrophotometer(bsdf, range=(550, 550), paths=4096)
    assert found.values[0] == pytest.approx(0.5, abs=0.003)
    gloss = aureole.spectrophotometer(f"{scene}#black", gloss=[20, 60], step=20, paths=8192)

    def fresnel(n, degrees):
        c = math.cos(math.radians(degrees))
        t = math.sqrt(1 - (1 - c * c) / n**2)
        return 0.5 * (((c - n * t) / (c + n * t)) ** 2 + ((t - n * c) / (t + n * c)) ** 2)

    for angle in (20.0, 60.0):
        assert gloss.gloss[angle][0] == pytest.approx(100 * fresnel(1.5, angle) / fresnel(1.567, angle), rel=0.01)
    assert "gloss at 20 degrees" in gloss._repr_html_()
    haze = aureole.spectrophotometer(f"{scene}#pane", haze=2.5, step=20, paths=4096)
    total, error = haze.total_transmittance
    assert haze.haze[0] == pytest.approx(0, abs=1e-3) and total == pytest.approx(0.922, abs=4.5 * error) and error < 0.05
    # A beam that is stated is that of haze, also where it is the usual one of reflectance: its own width passes by the port.
    wide = aureole.spectrophotometer(f"{scene}#pane", haze=2.5, range=(550, 550), paths=4096, theory=True, lamp_angle=3.5)
    assert wide.haze[0] > 0.2
    haze = aureole.spectrophotometer(f"{scene}#pane", haze=2.5, step=20, paths=4096, theory=True)
    assert haze.haze[0] == pytest.approx(0, abs=1e-3) and haze.total_transmittance[0] == pytest.approx(0.922, abs=0.003)
    # A slab has an edge, whose loss is predicted.
    with pytest.warns(UserWarning, match="edge loss: diffusion predicts"):
        slab = aureole.spectrophotometer(f"{scene}#slab", "de:8", theory=True, range=(550, 550), paths=4096, port="6mm", aperture="3mm",
                                         sample_size="150mm")
    assert 0.05 < slab.edge_loss[0] < 0.6


def test_wrong_options_of_instruments(scene):
    for target, options, message in (
        ("grey", {"geometry": "45:0"}, "there are 45a:0"), ("gray", {}, "did you mean"), ("grey", {"port": "200mm", "geometry": "di:8"}, "does not fit"),
        ("grey", {"aperture": "8 apples"}, "aperture: expected a length"), ("grey", {"method": "guess"}, "method: expected"),
        ("grey", {"sample_size": "3mm"}, "is smaller than the spot"), ("grey", {"range": (700, 400)}, "range: two wavelengths"),
        ("grey", {"thickness": "1mm"}, "has no medium inside"), ("grey", {"paths": 0}, "paths: expected at least 1")):
        with pytest.raises(aureole.Error, match=message):
            aureole.spectrophotometer(f"{scene}#{target}", **options)
    with pytest.raises(aureole.Error, match="name a material of the scene"):
        aureole.spectrophotometer(scene)
    with pytest.raises(TypeError, match="bsdf: expected"):
        aureole.spectrophotometer(3)


def test_goniometer_measures_fits_and_plots(scene):
    found = aureole.goniometer(f"{scene}#metal", directions=150, range=(500, 600), step=50, paths=256, noise=0.01, seed=2)
    program(scene, "goniometer", "m.xml#metal", "--directions", 150, "--range", "500,600", "--step", 50, "--paths", 256, "--noise", 0.01, "--seed", 2,
            "-o", "t.csv")
    again = aureole.goniometer(scene.parent / "t.csv")
    assert again.f.shape == found.f.shape == (len(found.theta_i), 3)
    np.testing.assert_allclose(again.f, np.maximum(found.f, 0), rtol=1e-5)
    found.to_csv(scene.parent / "mine.csv")
    np.testing.assert_allclose(aureole.goniometer(scene.parent / "mine.csv").f, np.maximum(found.f, 0), rtol=1e-6)
    fits = found.fit(["lambert", "beckmann", "ggx"])
    assert fits[0].model == "ggx" and [f.model for f in fits][-1] == "lambert"
    value, low, high = fits[0].parameters["alpha"]
    assert low < 0.3 < high and abs(value - 0.3) < 0.01
    assert "roughconductor" in fits[0].bsdf and "alpha" in fits[0]._repr_html_()
    assert set(found.models()) >= {"lambert", "ward", "principled"}
    with pytest.raises(aureole.Error, match="did you mean"):
        found.fit(["gxg"])
    plt = pytest.importorskip("matplotlib.pyplot")
    for options in ({}, {"log": True}, {"kind": "polar"}, {"kind": "3d", "incidence": 45}, {"kind": "map", "log": True}):
        axes = found.plot(**options)
        assert axes.name == {"polar": "polar", "3d": "3d"}.get(options.get("kind"), "rectilinear")
        axes.figure.canvas.draw()
        plt.close(axes.figure)
    with pytest.raises(aureole.Error, match="were not measured; there are 0, 15"):
        found.plot(incidence=44)
    with pytest.raises(aureole.Error, match="kind: expected"):
        found.plot(kind="cube")


def test_goniometer_report_of_light_and_cones(scene):
    found = aureole.goniometer_report(f"{scene}#grey", range=(550, 550), paths=8192, incident_light=[(0, 1), (90, 0.2)], cones=[(30, 5, 0, 8)])
    assert found.rho_hh[0] == pytest.approx(0.3, abs=0.003) and found.of_light[0] == pytest.approx(0.3, abs=0.003)
    np.testing.assert_allclose(found.rho_dh[:, 0], 0.3, atol=0.005)
    assert found.cones[0][4][0] == pytest.approx(0.3 * math.sin(math.radians(8)) ** 2, rel=0.01)
    assert found.is_isotropic and "rho_hh" in found._repr_html_()
    with pytest.raises(aureole.Error, match="cones: expected rows of four numbers"):
        aureole.goniometer_report(f"{scene}#grey", cones=[(1, 2)])


def test_lateral_spread_of_a_slab(scene):
    found = aureole.lateral_spread(f"{scene}#slab", [2e-3, 4e-3], sample_size="100mm", aperture="1mm", paths=32768)
    assert found.values.shape == (2, 1) and found.values[0, 0] > 2 * found.values[1, 0] > 0
    np.testing.assert_allclose(found.predicted / found.values, 1, atol=0.4)
    assert "diffusion(550nm)" in found.to_csv()
    with pytest.raises(aureole.Error, match="is no slab"):
        aureole.lateral_spread(f"{scene}#grey", [1e-3])


def test_spectroradiometer_reads_a_lamp(scene):
    with pytest.warns(UserWarning, match="is known from 380 to 780 nm"):
        found = aureole.spectroradiometer("FL11", seed=4)
    theirs = figures(scene, "spectroradiometer", "FL11", "--seed", 4)
    assert found.values.tolist() == theirs["values"] and list(found.xy) == theirs["xy"]
    assert found.xy[0] == pytest.approx(found.true_xy[0], abs=2e-3) and "x 0." in found._repr_html_()
    with pytest.raises(aureole.Error):
        aureole.spectroradiometer("no lamp")


def test_convert_bsdf_writes_all_formats(scene):
    for name, options in (("a.bsdf", {}), ("a.xml", {"basis": "quarter", "samples": 64}), ("tree.xml", {"format": "tensor_tree", "resolution": 16}),
                          ("a.csv", {"angles": 4}), ("a.txt", {"format": "zemax"})):
        found = aureole.convert_bsdf(f"{scene}#metal", scene.parent / name, step=200, **options)
        assert (scene.parent / name).stat().st_size == found.bytes > 1000
        assert found.is_isotropic and found.type == "roughconductor" and np.all(found.reflected < 1.01)
    again = aureole.load_dict({"type": "measured", "filename": str(scene.parent / "a.bsdf")})
    mine = aureole.load_dict({"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": 0.3})
    up, out = [0.3, 0, math.sqrt(1 - 0.09)], [-0.2, 0.1, math.sqrt(1 - 0.05)]
    assert again.eval(up, out, 550)[()] == pytest.approx(mine.eval(up, out, 550)[()], rel=0.1)
    aureole.convert_bsdf(mine, scene.parent / "own.bsdf")
    with pytest.raises(aureole.Error, match="a power of two"):
        aureole.convert_bsdf(mine, scene.parent / "own.xml", format="tensor_tree", resolution=20)
    with pytest.raises(aureole.Error, match="the ending says what is written"):
        aureole.convert_bsdf(mine, scene.parent / "own.doc")


def test_color_is_the_programs(scene):
    found = aureole.color("#ff0000", "lab(50, 20, -10)", standard="lab(50, 0, 0)")
    theirs = figures(scene, "color", "#ff0000", "lab(50, 20, -10)", "--standard", "lab(50, 0, 0)")["colours"]
    for mine, other in zip(found, theirs):
        np.testing.assert_allclose(mine.xyz, other["xyz"], rtol=1e-12)
        np.testing.assert_allclose(mine.luv, other["luv"], rtol=1e-12)
        assert mine.difference["ciede2000"] == other["difference"]["ciede2000"]
    assert found[0].dominant_wavelength == pytest.approx(611.4, abs=0.5) and found[1].dominant_wavelength < 0
    assert found.columns()["name"] == ["#ff0000", "lab(50, 20, -10)"] and "screen" in found.to_csv() and "<td>" in found._repr_html_()
    with pytest.raises(aureole.Error, match="is no colour"):
        aureole.color("no_colour")
    with pytest.raises(aureole.Error, match="observer: expected 2 or 10"):
        aureole.color("#ffffff", observer=3)


def test_appearance_and_rendering_through_colour_science():
    pytest.importorskip("colour")
    # The worked example of CIECAM02's successors: XYZ (19.01, 20, 21.78) under D65, L_A 318.31, Y_b 20 (Li and others 2017).
    found = aureole.cam16((19.01, 20.0, 21.78), (95.05, 100.0, 108.88), adapting_luminance=318.31)
    assert (found.lightness, found.chroma, found.hue) == pytest.approx((41.7312, 0.1034, 217.068), rel=1e-3)
    assert (found.brightness, found.colourfulness, found.saturation) == pytest.approx((195.372, 0.1074, 2.345), rel=1e-3)
    assert found.difference(found) == 0
    red, = aureole.color("#c03020")
    assert red.cam16().colourfulness > 40 and 0 < red.cam16(surround="dark").lightness < 100
    # CIE 13.3: F2 has an R_a of 64, F11 of 83; an incandescent lamp has 100.
    for name, cri, rf in (("FL2", 64.2, 70.1), ("FL11", 82.8, None), ("A", 100, 100)):
        r = aureole.color_rendering(name)
        assert r.cri == pytest.approx(cri, abs=0.7)
        if rf is not None:
            assert r.fidelity == pytest.approx(rf, abs=0.5)
        assert len(r.special) >= 8 and r.hue_fidelity.shape == (16,)
    assert r.cct == pytest.approx(2856, abs=5)
    read = aureole.color_rendering(aureole.spectroradiometer("FL2", range=(350, 850), electrons=0))
    assert read.cri == pytest.approx(64.2, abs=1.5)
    with pytest.raises(aureole.Error, match="expected wavelengths from 380 to 780"):
        aureole.color_rendering(([400.0, 700.0], [1.0, 1.0]))


def test_a_missing_colour_science_is_told(monkeypatch):
    import builtins

    real = builtins.__import__

    def without(name, *more, **options):
        if name == "colour":
            raise ImportError(name)
        return real(name, *more, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match="pip install aureole"):
        aureole.cam16((20, 20, 20), (95, 100, 109))
