# SPDX-License-Identifier: Apache-2.0
"""Photometry, luminaires, illumination, lenses, cameras and light fields: Python's results are the program's, and closed forms hold."""
import csv
import io
import json
import math
import os
import subprocess

import numpy as np
import pytest

import aureole
from aureole import optics

#: A disc of 1000 cd/m^2 and radius 1 at a height of 2 over a plane of receivers.
DISC = """<scene version="3.0.0"><integrator type="path"/>
  <sensor type="powermap"><transform name="to_world"><scale value="0.01"/></transform><string name="measure" value="irradiance"/>
    <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="2"/><string name="quantity" value="{quantity}"/></film>
    <sampler type="sobol"><integer name="sample_count" value="256"/></sampler></sensor>
  <shape type="disk"><transform name="to_world"><rotate x="1" angle="180"/><translate z="2"/></transform>
    <emitter type="area"><string name="amount" value="1000 cd/m^2"/></emitter></shape></scene>"""
LAMP = '<scene version="3.0.0"><emitter type="spot"><string name="amount" value="500 lm"/><transform name="to_world"><lookat origin="0,0,0" target="0,0,-1" up="0,1,0"/></transform></emitter></scene>'
#: A uniform sky before a camera of spectral bins.
SKY = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><float name="shutter_close" value="0.01"/>
  <film type="specfilm"><integer name="width" value="24"/><integer name="height" value="16"/><integer name="bins" value="47"/><rfilter type="box"/></film>
  <sampler type="sobol"><integer name="sample_count" value="16"/></sampler></sensor>
  <emitter type="constant"><string name="amount" value="200 cd/m^2"/></emitter></scene>"""
FIELD = """<scene version="3.0.0"><integrator type="path"/><sensor type="lightfield"><integer name="views_x" value="4"/><float name="aperture_width" value="0.4"/>
  <float name="plane_distance" value="4"/><float name="field_width" value="3"/><film type="hdrfilm"><integer name="width" value="96"/><integer name="height" value="64"/>
  <rfilter type="box"/></film><sampler type="sobol"><integer name="sample_count" value="64"/></sampler></sensor>
  <shape type="sphere"><point name="center" x="0.3" y="0.1" z="5"/><float name="radius" value="0.4"/><emitter type="area"><rgb name="radiance" value="1, 0.5, 0.2"/></emitter></shape></scene>"""
DOUBLET = "name a doublet\n61.47 6 bk7 25\n-44.64 2.5 sf5 25\n-129.94 95.9 air 24 stop\n"


@pytest.fixture
def folder(tmp_path):
    for name, text in (("disc.xml", DISC.format(quantity="illuminance")), ("lamp.xml", LAMP), ("sky.xml", SKY), ("field.xml", FIELD), ("a.lens", DOUBLET)):
        (tmp_path / name).write_text(text)
    return tmp_path


def program(folder, *words):
    done = subprocess.run([os.environ["AUREOLE_BINARY"], *map(str, words)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def rows_of(table):
    return list(csv.reader(io.StringIO(table.to_csv())))


def plotted(result, **options):
    pytest.importorskip("matplotlib").use("Agg")
    from matplotlib import pyplot

    result.plot(**options)
    pyplot.close("all")


def test_photometry(folder):
    found = aureole.photometry(folder / "disc.xml", regions=[(0, 0, 2, 2), (2, 0, 2, 2)], progress=False)
    assert found.quantity == "illuminance" and found.unit == "lx" and found.values.shape == (2, 4)
    # E = pi L r^2/(r^2 + d^2)
    assert found.values.mean() == pytest.approx(628.3185, rel=2e-3)
    assert found.michelson_contrast == pytest.approx(0, abs=2e-3)
    printed = program(folder, "photometry", "disc.xml", "-o", "a.png", "--region", "0,0,2,2", "--region", "2,0,2,2")
    assert f"{found.regions[0].mean:10.5g}" in printed
    read = aureole.photometry(folder / "a.exr")
    np.testing.assert_allclose(read.values, found.values, rtol=1e-6)
    scene = aureole.load_file(folder / "disc.xml")
    np.testing.assert_array_equal(aureole.photometry(scene, progress=False).values, found.values)
    assert rows_of(found)[0][:5] == ["x", "y", "width", "height", "mean"] and len(rows_of(found)) == 3
    assert "illuminance" in found._repr_html_() and found.false_color(isolines=[628]).shape[2] == 3
    plotted(found)
    with pytest.raises(aureole.Error, match="glare: needs the camera"):
        aureole.photometry(folder / "a.exr", glare=True)
    with pytest.raises(aureole.Error, match="daylight: the scene has no sky"):
        aureole.photometry(scene, daylight=True, progress=False)
    with pytest.raises(aureole.Error, match="no channel has a photometric unit"):
        aureole.photometry(aureole.Image(np.ones((2, 2, 3))))
    with pytest.raises(aureole.Error, match="regions: expected x, y, width and height"):
        aureole.photometry(scene, regions=[(0, 0, 1)], progress=False)


def test_power_through_cells(folder):
    (folder / "flux.xml").write_text(DISC.format(quantity="luminous_flux"))
    found = aureole.photometry(folder / "flux.xml", progress=False)
    assert found.unit == "lm"
    assert found.regions[0].total == pytest.approx(628.3185 * 0.02**2, rel=2e-3)


def test_means_on_a_shape(folder):
    """Cells of a ball count by their areas: a quarter of the illuminance of parallel light in the mean."""
    scene = aureole.load_string("""<scene version="3.0.0"><integrator type="direct"/><shape type="sphere"><bsdf type="diffuse"/><sensor type="powermap">
      <string name="measure" value="irradiance"/><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/>
      <string name="quantity" value="illuminance"/></film></sensor></shape>
      <emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/><string name="amount" value="2 klx"/></emitter></scene>""")
    found = aureole.photometry(scene, 1024, progress=False)
    assert found.regions[0].mean == pytest.approx(500, rel=2e-3)
    assert found.values.mean() == pytest.approx(2000 * (1 + math.sqrt(3) + 1) / 12, rel=2e-3)
    assert aureole.photometry(found.image, scene=scene).regions[0].mean == found.regions[0].mean
    assert aureole.photometry(found.image).regions[0].mean == pytest.approx(found.values.mean())


def test_glare_and_daylight(folder):
    scene = """<scene version="3.0.0"><integrator type="path"/><sensor type="{sensor}"><film type="hdrfilm"><integer name="width" value="64"/>
      <integer name="height" value="64"/><string name="quantity" value="{quantity}"/><rfilter type="box"/></film>
      <transform name="to_world">{place}</transform>{more}</sensor>{lamps}</scene>"""
    lamps = """<emitter type="constant"><string name="amount" value="50 cd/m^2"/></emitter><shape type="disk"><transform name="to_world"><scale value="0.0565"/>
      <rotate y="1" angle="180"/><translate x="0.2" y="0.3" z="1"/></transform><emitter type="area"><string name="amount" value="10000 cd/m^2"/></emitter></shape>"""
    (folder / "glare.xml").write_text(scene.format(sensor="perspective", quantity="luminance", lamps=lamps, more='<float name="fov" value="80"/>',
                                                   place='<lookat origin="0,0,0" target="0,0,1" up="0,1,0"/>'))
    with pytest.warns(UserWarning, match="the background is that of the picture"):
        found = aureole.photometry(folder / "glare.xml", 16, glare=True, up=(0, 1, 0), progress=False)
    g = found.glare
    assert g.background == pytest.approx(50, rel=1e-2) and len(g.luminance) == 1
    # The source by its parts: CIE 117's formula from what was found.
    assert g.rating == pytest.approx(optics.unified_glare_rating(g.background, g.luminance, g.source_solid_angle, g.position_index), abs=1e-6)
    exact = optics.disc_solid_angle([0.2, 0.3, 1], [0, 0, 1], 0.0565)
    assert (g.luminance * g.source_solid_angle)[0] == pytest.approx(1e4 * exact.solid_angle, rel=0.1)
    (folder / "sky.day.xml").write_text(scene.format(sensor="powermap", quantity="illuminance", more='<string name="measure" value="irradiance"/>', place="<scale value='1'/>",
                                                     lamps='<emitter type="ciesky"><string name="amount" value="10000 lx"/></emitter>'))
    day = aureole.photometry(folder / "sky.day.xml", 4, daylight=True, progress=False)
    assert day.unit == "%" and day.values.mean() == pytest.approx(100, rel=0.02)
    (folder / "sphere.day.xml").write_text((folder / "sky.day.xml").read_text().replace('<string name="measure" value="irradiance"/>', ""))
    sphere = aureole.load_file(folder / "sphere.day.xml")
    image = aureole.render(sphere, 1, progress=False)
    for target, given in ((sphere, None), (image, sphere)):
        with pytest.raises(aureole.Error, match="daylight: needs the illuminance on a surface, not the spherical illuminance"):
            aureole.photometry(target, scene=given, daylight=True, progress=False)
    for wrong, message in (({"up": (0, 0, 1)}, "up: is for glare and daylight"), ({"threshold": 500.0}, "threshold: is for glare"),
                           ({"threads": 2}, "threads: is for a scene")):
        with pytest.raises(aureole.Error, match=message):
            aureole.photometry(day.image, progress=False, **wrong)


def test_goniophotometer(folder):
    found = aureole.goniophotometer(folder / "lamp.xml", 64, c_step=90, gamma_step=5, symmetry="rotational", progress=False)
    assert found.type == "C" and found.candela.shape == (1, 37) and found.flux == pytest.approx(500, rel=0.02)
    assert found.downward_flux == pytest.approx(found.flux) and found.peak_direction[1] <= 15
    program(folder, "goniophotometer", "lamp.xml", "--spp", 64, "--c-step", 90, "--gamma-step", 5, "--symmetry", "rotational", "-o", "theirs.ies", "-o", "theirs.ldt")
    found.save(folder / "ours.ies"), found.save(folder / "ours.ldt")
    for ending in ("ies", "ldt"):
        # Lines end with CR LF, as the formats want.
        assert (folder / f"ours.{ending}").read_bytes() == (folder / f"theirs.{ending}").read_bytes() == found.text(ending).encode()
    back = aureole.goniophotometer(folder / "ours.ldt")
    np.testing.assert_allclose(back.candela, found.candela, atol=1)
    assert len(rows_of(found)) == 38 and "500" in found._repr_html_() or "lm" in found._repr_html_()
    plotted(found), plotted(back)
    (folder / "sun.xml").write_text('<scene version="3.0.0"><emitter type="constant"/></scene>')
    with pytest.raises(aureole.Error, match="light from infinity"):
        aureole.goniophotometer(folder / "sun.xml", progress=False)
    with pytest.raises(aureole.Error, match="c_step 70: must divide 360"):
        aureole.goniophotometer(folder / "lamp.xml", c_step=70, progress=False)
    with pytest.raises(aureole.Error, match='ends with ".ies" or ".ldt"'):
        found.save(folder / "a.txt")
    # Options of a measurement are errors beside a file; those that replace what the file states are applied.
    for wrong in ({"spp": 256}, {"c_step": 30}, {"symmetry": "c0"}, {"down": (0, 0, 1)}, {"along": (1, 0, 0)}, {"seed": 3}, {"integrator": "path"}):
        with pytest.raises(aureole.Error, match="is for a scene"):
            aureole.goniophotometer(folder / "ours.ldt", **wrong)
    with pytest.raises(aureole.Error, match="lamp_set: is for an EULUMDAT file"):
        aureole.goniophotometer(folder / "lamp.xml", 4, lamp_set=1, progress=False)
    changed = aureole.goniophotometer(folder / "ours.ldt", flux=250, opening=(0.5, 0.2, 0.1), name="half", maker="me")
    assert changed.flux == pytest.approx(250) and changed.opening == (0.5, 0.2, 0.1)
    assert changed.keywords["LUMINAIRE"] == changed.keywords["LUMCAT"] == "half" and changed.keywords["MANUFAC"] == "me"
    changed.save(folder / "changed.ies")
    assert aureole.goniophotometer(folder / "changed.ies").opening == pytest.approx((0.5, 0.2, 0.1))
    assert aureole.goniophotometer(folder / "changed.ies", opening=(0, 0, 0)).opening == (0, 0, 0)  # a point is an opening, too
    for argument in ("name", "maker"):
        with pytest.raises(aureole.Error, match=f"{argument}: has more than one line"):
            aureole.goniophotometer(folder / "ours.ldt", **{argument: "a\nTILT=NONE"})


def test_ugr(folder):
    """The program's table; luminaires that are measured, read, or given as results."""
    cosine = " ".join(f"{360 * math.cos(math.radians(1.25 * i)):.5g}" for i in range(72)) + " 0"
    gamma = " ".join(str(1.25 * i) for i in range(73))
    (folder / "panel.ies").write_text(f"IESNA:LM-63-2002\nTILT=NONE\n1 4000 1 73 1 1 2 0.6 0.6 0\n1 1 36\n{gamma}\n0\n{cosine}\n")
    found = aureole.ugr(folder / "panel.ies")
    program(folder, "ugr", "panel.ies", "--csv", "theirs.csv")
    theirs = np.loadtxt(folder / "theirs.csv", delimiter=",", skiprows=1)
    assert rows_of(found)[0] == (folder / "theirs.csv").read_text().splitlines()[0].split(",")
    np.testing.assert_allclose([[float(v) for v in row] for row in rows_of(found)[1:]], theirs, atol=2e-3)
    assert found.flux == 4000 and found.is_of_lamps and found.correction == pytest.approx(8 * math.log10(4))
    assert found.rooms[10].tolist() == [4, 8] and found.reflectances[4].tolist() == [0.3, 0.3, 0.2] and found.background.shape == (2, 19, 5)
    assert [v.spacing for v in found.variations] == [1, 1.5, 2] and all(v.crosswise[0] < v.crosswise[1] for v in found.variations)
    less = aureole.ugr(folder / "panel.ies", uncorrected=True)
    np.testing.assert_allclose(less.endwise, found.endwise - found.correction, atol=1e-9)
    np.testing.assert_allclose(less.background, found.background / 4, rtol=1e-9)
    assert less.flux == 1000 and less.correction == 0
    # Of even light on each surface, and of the radiosity of patches: backgrounds differ by some percent, ratings by some tenths.
    patches = aureole.ugr(folder / "panel.ies", background="patches")
    assert 0.01 < np.abs(patches.background / found.background - 1).max() < 0.2
    np.testing.assert_allclose(patches.crosswise - found.crosswise, -8 * np.log10(patches.background[0] / found.background[0]), atol=1e-9)
    # A result of goniophotometer, by its text of six digits.
    data = aureole.goniophotometer(folder / "panel.ies")
    np.testing.assert_allclose(aureole.ugr(data).crosswise, found.crosswise, atol=1e-4)
    assert "4000 lm of the lamps" in found._repr_html_() and found._repr_html_().count("<tr>") == 20
    plotted(found), plotted(found, reflectances=3)
    # Wrong arguments are errors before a scene is measured: this one is missing.
    with pytest.raises(aureole.Error, match="opening: is needed for a scene"):
        aureole.ugr(folder / "missing.xml", progress=False)
    with pytest.raises(aureole.Error, match="^spacing 0.3: .* whole number"):
        aureole.ugr(folder / "missing.xml", opening=(1, 1, 0), spacing=0.3, progress=False)
    with pytest.raises(aureole.Error, match="^opening 0 0 0: has no area"):
        aureole.ugr(folder / "missing.xml", opening=(0, 0, 0), progress=False)
    with pytest.raises(aureole.Error, match=r"panel\.ies: the luminaire has no luminous area, .*: state it by opening"):
        aureole.ugr(folder / "panel.ies", opening=(0, 0, 0))
    measured = aureole.ugr(folder / "lamp.xml", spp=4, c_step=90, gamma_step=5, opening=(0.1, 0.1, 0), progress=False)
    assert not measured.is_of_lamps and measured.flux == pytest.approx(500, rel=0.02)
    assert np.isneginf(measured.crosswise).all()  # a beam of 20 degrees dazzles nobody
    with pytest.raises(aureole.Error, match="opening: is for a file or a scene"):
        aureole.ugr(data, opening=(1, 1, 0))
    with pytest.raises(aureole.Error, match="whole number"):
        aureole.ugr(data, spacing=0.3)
    with pytest.raises(aureole.Error, match="watts: is for the file of a luminaire"):
        aureole.ugr(folder / "panel.ies", watts=30)
    with pytest.raises(aureole.Error, match='background: expected "uniform" or "patches"'):
        aureole.ugr(data, background="traced")


def test_illumination(folder):
    # A cube of 4 m with walls of reflectance 0.5 and 10 klm in its middle: local and further light are equal, 104.1667 lx over the walls.
    (folder / "cube.xml").write_text("""<scene version="3.0.0"><sensor type="powermap"><transform name="to_world"><scale value="2"/><translate z="-1.999"/></transform>
      <string name="measure" value="irradiance"/><film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/>
      <string name="quantity" value="illuminance"/></film><sampler type="sobol"><integer name="sample_count" value="256"/></sampler></sensor>
      <shape type="cube"><boolean name="flip_normals" value="true"/><transform name="to_world"><scale value="2"/></transform>
      <bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf></shape>
      <emitter type="point"><string name="amount" value="10 klm"/></emitter></scene>""")
    found = aureole.illumination(folder / "cube.xml", runs=4, progress=False)
    # By symmetry, the mean over one wall is that over all six.
    # The receivers lie 1 mm before the wall, which is 0.06 %. Errors are below 0.3 %, and the means within three of them.
    assert found.local_error[0] < 0.003 * 104 and found.repeated_error[0] < 0.003 * 104
    assert found.local[0] == pytest.approx(104.1667, abs=3 * found.local_error[0] + 0.1)
    assert found.repeated[0] == pytest.approx(104.1667, abs=3 * found.repeated_error[0] + 0.1)
    assert found.share.mean() == pytest.approx(0.5, abs=0.02)
    printed = program(folder, "illumination", "cube.xml", "--runs", 4)
    assert f"{found.local[0]:.6g}" in printed and f"{found.total[0]:.6g}" in printed
    assert rows_of(found)[0][4:6] == ["local", "local_error"] and "illuminance, lx" in found._repr_html_()
    plotted(found)
    with pytest.raises(aureole.Error, match="regions? 0,0,9,9: leaves the picture"):
        aureole.illumination(folder / "cube.xml", 1, runs=2, regions=[(0, 0, 9, 9)], progress=False)


def test_lens(folder):
    found = aureole.lens(folder / "a.lens", fields=[0, 1], wavelengths=[486.1327, 587.5618, 656.2725], rays=40)
    printed = program(folder, "lens", "a.lens", "--fields", "0,1", "--rays", 40)
    assert f"focal length {found.focal_length:.4f} mm" in printed and f"{found.rms_radius[1, 0]:12.2f}" in printed
    assert found.rms_radius.shape == (2, 3) and len(found.spots[1]) == 3
    # The root mean square of the points about their mean is the stated radius.
    spot = found.spots[0][1]
    np.testing.assert_allclose(spot.mean(axis=0), 0, atol=1e-9)
    assert np.sqrt(np.mean(np.sum(spot**2, axis=1))) == pytest.approx(found.rms_radius[0, 1], rel=1e-12)
    assert found.airy_radius == pytest.approx(1.21967 * 0.5875618 * found.f_number, rel=1e-5)
    assert found.height[1, 1] == pytest.approx(-math.tan(math.radians(1)) * found.focal_length, rel=0.01) or \
        found.height[1, 1] == pytest.approx(math.tan(math.radians(1)) * found.focal_length, rel=0.01)
    assert len(rows_of(found)) == 7 and "a doublet" in found._repr_html_()
    plotted(found)
    with pytest.raises(aureole.Error, match="f_number 0.1: wide open the lens has"):
        aureole.lens(folder / "a.lens", f_number=0.1)
    with pytest.raises(aureole.Error, match="a.lens"):
        (folder / "a.lens").write_text("nothing")
        aureole.lens(folder / "a.lens")


def test_expose(folder):
    camera = {"gain": 0.5, "read_noise": 5, "efficiency": 0.6, "black_level": 100, "full_well": 60000, "bits": 16, "f_number": 4}
    (folder / "camera.json").write_text(json.dumps(camera))
    found = aureole.expose(folder / "sky.xml", camera=camera, frames=2, progress=False)
    assert found.exposure == 0.01 and found.electrons.shape == (16, 24) and found.frames[0].dtype == np.uint16
    program(folder, "expose", "sky.xml", "--camera", "camera.json", "--frames", 2, "-o", "theirs.dng")
    found.save(folder / "ours.dng", 1)
    assert (folder / "ours.dng").read_bytes() == (folder / "theirs_0002.dng").read_bytes()
    same = aureole.expose(found.image, camera=folder / "camera.json", exposure=0.01, frame=2)
    np.testing.assert_array_equal(same.frames[0], found.frames[1])
    # EMVA 1288: the variance of a pixel over frames is K^2 (electrons + sigma^2) + 1/12.
    many = aureole.expose(found.image, camera=camera, exposure=0.01, frames=200)
    stack = np.stack(many.frames).astype(float)
    expected = 0.25 * (many.electrons.mean() + 25) + 1 / 12
    assert stack.var(axis=0, ddof=1).mean() == pytest.approx(expected, rel=0.03)
    assert stack.mean() == pytest.approx(100 + 0.5 * many.electrons.mean(), rel=1e-3)
    nm = np.linspace(400, 700, 61)
    bells = {name: np.exp(-((nm - at) / 40) ** 2).tolist() for name, at in (("red", 600), ("green", 540), ("blue", 455))}
    coloured = aureole.expose(found.image, exposure=0.01, mosaic="rggb", efficiency={"nm": nm, **bells})
    assert coloured.mosaic.tolist() == [[0, 1], [1, 2]] and coloured.to_xyz.shape == (3, 3) and 0 < coloured.delta_e.mean() < 4
    # White keeps its colour.
    assert (coloured.to_xyz @ [1, 1, 1])[1] == pytest.approx(1, rel=1e-9)
    assert len(rows_of(many)) == 201 and "electrons" in found._repr_html_()
    plotted(found)
    with pytest.raises(aureole.Error, match="exposure: is needed, in seconds"):
        aureole.expose(found.image)
    with pytest.raises(aureole.Error, match='unknown key "gian"'):
        aureole.expose(found.image, exposure=1, gian=3)
    with pytest.raises(aureole.Error, match="efficiency"):
        aureole.expose(found.image, exposure=1, efficiency={"nm": [400, 300], "values": [0.1, 0.2]})
    with pytest.raises(aureole.Error, match="has no spectral channels"):
        aureole.expose(aureole.Image(np.ones((2, 2, 3))), exposure=1)


def test_a_crop_lacks_views(folder):
    (folder / "part.xml").write_text(FIELD.replace('<integer name="height"', '<integer name="crop_width" value="48"/><integer name="height"'))
    with pytest.raises(aureole.Error, match="the film has a crop"):
        aureole.lightfield(folder / "part.xml", progress=False)


def test_light_field(folder):
    found = aureole.lightfield(folder / "field.xml", progress=False)
    assert found.views == (4, 4) and found.size == (24, 16) and found.array.shape == (4, 4, 16, 24, 3)
    np.testing.assert_allclose(found.s, [-0.15, -0.05, 0.05, 0.15])
    np.testing.assert_array_equal(found.array[1, 2], found.image.array[16:32, 48:72])
    near = found.picture(diameter=0.4, focus=5)
    program(folder, "lightfield", "field.xml", "--diameter", 0.4, "--focus", 5, "-o", "near.exr", "--field", "theirs.exr")
    np.testing.assert_allclose(near.array, aureole.read_image(folder / "near.exr").array, atol=1e-6)
    found.save(folder / "ours.exr")
    back = aureole.lightfield(folder / "ours.exr")
    assert back.axes == found.axes
    np.testing.assert_allclose(back.picture((0.1, -0.05)).array, found.picture((0.1, -0.05)).array, atol=1e-6)
    # A camera further right sees the ball further left, beyond the window's plane by less.
    def middle(image):
        return (image.array[..., 0] * np.arange(image.width)).sum() / image.array[..., 0].sum()

    shift = middle(found.picture((0.15, 0))) - middle(found.picture((-0.15, 0)))
    assert shift == pytest.approx(-0.3 * (4 / 5 - 1) / (3 / 24), abs=0.3)
    assert len(rows_of(found)) == 17 and "4 x 4 views" in found._repr_html_()
    plotted(found, focus=5.0)
    with pytest.raises(aureole.Error, match="lies outside of the light field"):
        found.picture((1, 0))
    with pytest.raises(aureole.Error, match="needs the sensor"):
        aureole.lightfield(folder / "sky.xml", progress=False)
    with pytest.raises(aureole.Error, match="is no light field"):
        aureole.lightfield(aureole.Image(np.ones((4, 4, 3))))


def test_header_says_the_unit(folder):
    image = aureole.render(aureole.load_file(folder / "disc.xml"), progress=False)
    assert image.meanings == {"Y": "illuminance, lx"}
    image.save(folder / "a.exr")
    read = aureole.read_image(folder / "a.exr")
    assert read.meanings == {"Y": "illuminance, lx"}
    read.save(folder / "b.exr")  # is kept
    assert aureole.read_image(folder / "b.exr").meanings == {"Y": "illuminance, lx"}


def test_animations_and_modulation():
    def scene(pulse):
        return {"type": "scene", "integrator": {"type": "path"},
                "sensor": {"type": "radiancemeter", "shutter_close": 1.0, "to_world": aureole.Transform.look_at([0, 0, 5], [0, 0, 0]),
                           "film": {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance", "component_format": "float32"},
                           "sampler": {"type": "sobol", "sample_count": 4096}},
                "card": {"type": "shapegroup", "sheet": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": 0.0}}},
                "moving": {"type": "instance", "group": {"type": "ref", "id": "card"}, "to_world": {"type": "animation", "frames": [
                    (0.0, aureole.Transform.translate([-2, 0, 1])), (1.0, aureole.Transform.translate([0.5, 0, 1]))]}},
                "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}, **({"modulation": pulse} if pulse else {})}}

    # The card covers the line of sight when its centre is within 1 of it: from t = 0.4 on.
    loaded = aureole.load_dict(scene(None))
    assert aureole.render(loaded, progress=False).array.mean() == pytest.approx(0.4, abs=0.01)
    frames = loaded["moving.to_world"]
    assert [time for time, _ in frames] == [0.0, 1.0] and frames[1][1].matrix[0, 3] == 0.5
    loaded["moving.to_world"] = {"type": "animation", "frames": [(0.0, aureole.Transform.translate([-2, 0, 1])), (1.0, np.eye(4))]}
    assert aureole.render(loaded, progress=False).array.mean() == pytest.approx(0.5, abs=0.01)
    flash = {"type": "timetable", "times": "0, 0.25, 0.25, 1", "values": "1, 1, 0, 0"}
    assert aureole.render(aureole.load_dict(scene(flash)), progress=False).array.mean() == pytest.approx(1, abs=0.02)
    for frames, message in (([], 'expected "frames"'), ([(0.0,)], "expected a pair of a time"), ([("a", np.eye(4))], "expected a time in s"), ([(0.0, [1, 2])], "expected a Transform")):
        wrong = scene(None)
        wrong["moving"]["to_world"]["frames"] = frames
        with pytest.raises(aureole.SceneError, match=message):
            aureole.load_dict(wrong)


def sphere_reference(center, radius, normal, n=4_000_000):
    """Solid angle and projected one by uniform directions of a Fibonacci lattice."""
    i = np.arange(n) + 0.5
    z, phi = 1 - 2 * i / n, np.pi * (1 + 5**0.5) * i
    d = np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=-1)
    along = d @ np.asarray(center, float)
    hit = (along > 0) & (np.dot(center, center) - along**2 < radius**2)
    cosine = np.maximum(d @ (np.asarray(normal, float) / np.linalg.norm(normal)), 0)
    return 4 * np.pi * hit.mean(), 4 * np.pi * (hit * cosine).mean()


def disc_reference(center, axis, radius, normal, n=2000):
    """By midpoints of rings: cos/r^2 over the area."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    e = np.cross(axis, [0.3, 0.5, 0.8])
    e /= np.linalg.norm(e)
    f = np.cross(axis, e)
    r, phi = np.meshgrid((np.arange(n) + 0.5) / n * radius, (np.arange(n) + 0.5) / n * 2 * np.pi)
    p = np.asarray(center) + (r * np.cos(phi))[..., None] * e + (r * np.sin(phi))[..., None] * f
    square = (p**2).sum(-1)
    part = np.abs(p @ axis) / square**1.5 * r * radius / n * 2 * np.pi / n
    cosine = np.maximum(p @ (np.asarray(normal, float) / np.linalg.norm(normal)), 0) / np.sqrt(square)
    return part.sum(), (part * cosine).sum()


def test_solid_angles():
    for center, radius, normal in (([0, 0, 2], 1, [0, 0, 1]), ([0.5, 1, 0.3], 0.7, [0.2, 0.1, 1]), ([1, 0, -0.2], 0.6, [0, 0, 1]), ([1, 0, 0.4], 0.6, [0.1, 0, 1])):
        found, expected = optics.sphere_solid_angle(center, radius, normal=normal), sphere_reference(center, radius, normal)
        assert found.solid_angle == pytest.approx(expected[0], rel=1e-3) and found.projected == pytest.approx(expected[1], rel=2e-3, abs=1e-5)
    for center, axis, radius, normal in (([0, 0, 2], [0, 0, 1], 1, [0, 0, 1]), ([1.4, 0.2, 0.8], [0.1, 0.4, 1], 0.9, [0, 0.2, 1]), ([0.4, 0, 0.5], [0, 0, -2], 1.2, [1, 0, 0.1]),
                                         ([1, 0, 0.5], [0, 0, 1], 1, [0, 0, 1]), ([2, 0, 0.1], [1, 0, 0.3], 0.8, [0, 0, 1])):
        found, expected = optics.disc_solid_angle(center, axis, radius, normal=normal), disc_reference(center, axis, radius, normal)
        assert found.solid_angle == pytest.approx(expected[0], rel=1e-4) and found.projected == pytest.approx(expected[1], rel=1e-4)
    assert 1000 * optics.disc_solid_angle([0, 0, 2], [0, 0, 1], 1, normal=[0, 0, 1]).projected == pytest.approx(628.3185, abs=1e-4)
    # A cube's face from its middle is a sixth of all directions; from outside, the cube's six faces sum to twice its outline.
    face = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1.0]])
    assert optics.polygon_solid_angle(face).solid_angle == pytest.approx(4 * np.pi / 6, rel=1e-12)
    roof = np.array([[-2, -2, 3], [2, -2, 3], [2, 2, 3], [-2, 2, 3.0]])
    assert optics.polygon_solid_angle(roof, normal=[0, 0, 1]).projected / np.pi == pytest.approx(0.357685, abs=1e-6)
    # A wall that the horizon cuts: only its upper half counts.
    wall, half = np.array([[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1.0]]), np.array([[1, -1, 0], [1, 1, 0], [1, 1, 1], [1, -1, 1.0]])
    assert optics.polygon_solid_angle(wall, normal=[0, 0, 1]).projected == pytest.approx(optics.polygon_solid_angle(half, normal=[0, 0, 1]).projected, rel=1e-12)
    # A polygon of many corners is a disc, and a concave one the difference of two convex ones.
    t = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    ring = np.stack([0.7 * np.cos(t) + 0.4, 0.7 * np.sin(t), 0 * t + 1], -1)
    many, disc = optics.polygon_solid_angle(ring, normal=[0.3, 0, 1]), optics.disc_solid_angle([0.4, 0, 1], [0, 0, 1], 0.7, normal=[0.3, 0, 1])
    assert many.solid_angle == pytest.approx(disc.solid_angle, rel=1e-5) and many.projected == pytest.approx(disc.projected, rel=1e-5)
    points = np.array([[0, 0, 0], [0.1, 0.2, 0.3], [5, 5, 5.0]])
    assert optics.sphere_solid_angle([0, 0, 2], 1, points).solid_angle.shape == (3,)


def test_solid_angle_of_any_shape():
    for shape, expected in (({"type": "sphere", "center": [0.5, 1, 0.3], "radius": 0.7}, optics.sphere_solid_angle([0.5, 1, 0.3], 0.7, normal=[0.2, 0.1, 1])),
                            ({"type": "disk", "to_world": aureole.Transform.translate([0.2, 0.1, 1.5])}, optics.disc_solid_angle([0.2, 0.1, 1.5], [0, 0, 1], 1, normal=[0.2, 0.1, 1])),
                            ({"type": "mesh", "vertices": [[-2, -2, 3], [2, -2, 3], [2, 2, 3], [-2, 2, 3]], "faces": [[0, 1, 2], [0, 2, 3]]},
                             optics.polygon_solid_angle([[-2, -2, 3], [2, -2, 3], [2, 2, 3], [-2, 2, 3]], normal=[0.2, 0.1, 1]))):
        found = optics.solid_angle(shape, normal=[0.2, 0.1, 1], samples=2**18)
        assert found.solid_angle == pytest.approx(expected.solid_angle, abs=4 * found.error + 1e-5) and found.error < 2e-3 * expected.solid_angle
        assert found.projected == pytest.approx(expected.projected, abs=4 * found.projected_error + 1e-5)
    with pytest.raises(TypeError, match="shape: expected a dict or a Scene"):
        optics.solid_angle(3)
    with pytest.raises(aureole.Error, match="normal: expected vectors that are not zero"):
        optics.sphere_solid_angle([0, 0, 2], 1, normal=[0, 0, 0])


def test_conversions():
    # One watt at 555.016 nm: hc/lambda by its value, 3.579e-19 J.
    assert optics.photon_energy(555) == pytest.approx(3.5792e-19, rel=1e-4) and optics.photons(1, 555) == pytest.approx(2.794e18, rel=1e-3)
    assert optics.irradiance_of_intensity(100, 2, 0.5) == 12.5 and optics.irradiance_of_intensity(100, 2, -0.5) == 0
    assert optics.exitance_of_radiance(1) == pytest.approx(math.pi) and optics.radiance_of_exitance(math.pi) == pytest.approx(1)
    # A small disc from afar: both ways to the irradiance agree.
    far = 100.0
    seen = optics.disc_solid_angle([0, 0, far], [0, 0, 1], 0.1, normal=[0, 0, 1]).projected
    by_intensity = optics.irradiance_of_intensity(optics.intensity_of_radiance(7, math.pi * 0.01), far)
    assert optics.irradiance_of_radiance(7, seen) == pytest.approx(by_intensity, rel=2e-6)
    assert optics.radiance_of_intensity(optics.intensity_of_radiance(7, 0.2, 0.3), 0.2, 0.3) == pytest.approx(7)
    assert optics.flux_of_intensity(1) == pytest.approx(4 * math.pi) and optics.radiance_of_irradiance(math.pi, 0.5) == pytest.approx(0.5)
    assert optics.etendue(2, 0.1, 1.5) == pytest.approx(0.45)
    assert optics.mesopic_luminance(0.1, 2).luminance == pytest.approx(0.13096, abs=5e-6)
    assert optics.unified_glare_rating(50, 1e4, 0.01) == pytest.approx(29.5918, abs=5e-5)
