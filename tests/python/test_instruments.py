# SPDX-License-Identifier: Apache-2.0
"""Instruments that the command line has, too: their figures are the program's; tables, HTML, plots; errors in Python's words."""
import csv
import inspect
import io
import json
import os
import re
import subprocess

import numpy as np
import pytest

import aureole
from aureole import _aureole

SCENE = """<scene version="3.0.0">
  <bsdf type="roughdielectric" id="frosted"><float name="alpha" value="0.2"/></bsdf>
  <medium type="homogeneous" id="fog"><rgb name="albedo" value="0.9, 0.8, 0.7"/><float name="sigma_t" value="3"/>
    <phase type="hg"><float name="g" value="0.4"/></phase></medium>
</scene>"""
PLANE = """<scene version="3.0.0">
  <shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="-1"/></transform><bsdf type="diffuse" id="mat-itu_concrete"/></shape>
</scene>"""
#: Commands whose results Python has by a function, or by a package; others write files or print pages.
FUNCTIONS = {"color": "color", "compare": "compare", "convert": "convert", "convert-bsdf": "convert_bsdf", "denoise": "denoise",
             "droplet-size": "droplet_size", "expose": "expose", "goniometer": "goniometer", "goniophotometer": "goniophotometer",
             "illumination": "illumination", "info": "info", "layer": "layer", "lens": "lens", "lightfield": "lightfield",
             "medium": "medium", "microstructure": "microstructure", "photometry": "photometry", "powermap": "powermap",
             "render": "render", "rings": "rings", "spectrophotometer": "spectrophotometer", "spectroradiometer": "spectroradiometer",
             "ugr": "ugr"}
PACKAGES = {"cache": "aureole.cache", "pigment": "aureole.pigment", "cluster": "aureole.cluster"}
COMMAND_LINE_ONLY = {"bake", "docs", "gallery", "list", "merge"}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.xml").write_text(SCENE)
    (tmp_path / "plane.xml").write_text(PLANE)
    return tmp_path


def program(folder, *words):
    done = subprocess.run([os.environ["AUREOLE_BINARY"], *map(str, words)], cwd=folder, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def rows_of(table):
    return list(csv.reader(io.StringIO(table.to_csv())))


def test_every_command_is_decided():
    names = {name.split()[0] for name in _aureole.command_names()}
    assert names == set(FUNCTIONS) | set(PACKAGES) | COMMAND_LINE_ONLY
    for function in FUNCTIONS.values():
        assert callable(getattr(aureole, function)) and function in aureole.__all__


def test_every_result_can_be_seen_and_kept():
    """Results of commands have plots, tables for files and HTML; pictures are seen as PNG and saved as pictures."""
    seen = 0
    for function in FUNCTIONS.values():
        for name in re.findall(r"\w+", str(inspect.signature(getattr(aureole, function)).return_annotation)):
            result = getattr(aureole, name, None)
            if not inspect.isclass(result):
                continue
            methods = ("plot", "save", "_repr_png_") if result is aureole.Image else ("plot", "to_csv", "_repr_html_")
            assert [m for m in methods if not callable(getattr(result, m, None))] == [], name
            seen += 1
    assert seen >= len(FUNCTIONS) - 1  # convert writes a file


def test_layer(folder):
    found = aureole.layer(folder / "scene.xml#frosted", angle=30, samples=4096, step=100)
    program(folder, "layer", "scene.xml#frosted", "--angle", 30, "--samples", 4096, "--step", 100, "--json", "layer.json")
    theirs = json.loads((folder / "layer.json").read_text())
    assert found.wavelength.tolist() == [row["nm"] for row in theirs["wavelengths"]]
    assert found.total_transmission.tolist() == [row["total_transmission"] for row in theirs["wavelengths"]]
    assert found.haze == theirs["cie"]["haze"]
    assert found.xyz["total_transmission"][1] == theirs["cie"]["total_transmission"]["Y"]
    np.testing.assert_allclose(found.total_transmission + found.total_reflection + found.lost, 1)
    bsdf = aureole.load_dict({"type": "roughdielectric", "alpha": 0.2})
    np.testing.assert_allclose(aureole.layer(bsdf, angle="30deg", samples=4096, step=100).total_transmission, found.total_transmission, atol=1e-6)
    rows = rows_of(found)
    assert rows[0][:2] == ["wavelength_nm", "direct_transmission"] and len(rows) == len(found.wavelength) + 1
    assert float(rows[1][4]) == found.total_transmission[0]
    assert "<th>haze" not in found._repr_html_() and "<td>" in found._repr_html_() and "haze" in found._repr_html_()
    found.to_csv(folder / "layer.csv")
    assert (folder / "layer.csv").read_text() == found.to_csv()


def test_medium(folder):
    found = aureole.medium(folder / "scene.xml#fog", length="20cm", step=50)
    program(folder, "medium", "scene.xml#fog", "--length", "20cm", "--step", 50, "--json", "medium.json")
    theirs = json.loads((folder / "medium.json").read_text())
    for name, key in (("absorption", "sigma_a"), ("scattering", "sigma_s"), ("extinction", "sigma_t"), ("albedo", "albedo"), ("transmittance", "transmittance")):
        assert getattr(found, name).tolist() == pytest.approx([row[key] for row in theirs["wavelengths"]], rel=1e-12)
    assert found.xyz_unscattered.tolist() == theirs["xyz_unscattered"]
    np.testing.assert_allclose(found.transmittance, np.exp(-3 * 0.2), rtol=1e-5)
    cosines = np.cos(found.angles)
    np.testing.assert_allclose(found.phase[1], (1 - 0.16) / (4 * np.pi * (1.16 - 0.8 * cosines) ** 1.5), rtol=1e-4)
    here = aureole.load_dict({"type": "homogeneous", "sigma_t": 2.0, "albedo": 0.5}, family="medium")
    np.testing.assert_allclose(aureole.medium(here, length=0.5).transmittance, np.exp(-1), rtol=1e-5)
    with pytest.raises(aureole.Error, match='length: expected a length with its unit, such as "1cm", got \'20\''):
        aureole.medium(here, length="20")
    with pytest.raises(aureole.Error, match='no medium has the id "mist"'):
        aureole.medium(folder / "scene.xml#mist")
    with pytest.raises(TypeError, match="target: expected a Medium"):
        aureole.medium(3)


def test_compare(small_scene, folder):
    scene = aureole.load_dict(small_scene)
    a, b = (aureole.render(scene, 16, seed=seed, replicates=8, progress=False) for seed in (1, 2))
    found = aureole.compare(a, b)
    assert found and found.is_same and found.layers[0].verdict == "the same within noise"
    assert found.layers[0].rmse == pytest.approx(np.sqrt(np.mean((a.array.astype(float) - b.array) ** 2)), rel=1e-6)
    assert found.z_map.array.shape == (16, 24, 1)
    scene["sky.radiance"] = 1.5
    other = aureole.compare(aureole.render(scene, 16, seed=3, replicates=8, progress=False), b)
    assert not other and other.layers[0].verdict == "DIFFERENT"
    a.save(folder / "a.exr"), b.save(folder / "b.exr")
    files = aureole.compare(folder / "a.exr", str(folder / "b.exr"))
    printed = program(folder, "compare", "a.exr", "b.exr")
    assert f"RMSE       {files.layers[0].rmse:.6g}" in printed and files.layers[0].verdict in printed
    assert files.layers[0].z_mean_square == pytest.approx(found.layers[0].z_mean_square, rel=0.05)
    same = aureole.compare(a, a)
    assert same.layers[0].verdict == "identical" and "identical" in same.to_csv()
    with pytest.raises(aureole.Error, match="neither picture has variances"):
        aureole.compare(aureole.Image(np.ones((2, 2, 3))), aureole.Image(np.zeros((2, 2, 3)))).plot()
    with pytest.raises(aureole.Error):
        aureole.compare(a, aureole.Image(np.ones((2, 2, 3))))


def test_info(folder, small_scene, repository):
    aureole.render(aureole.load_dict(small_scene), progress=False).save(folder / "a.exr")
    found = aureole.info(folder / "a.exr")
    assert found.kind == "picture" and found["size"] == "24 x 16 pixels, 4 channels" or found["size"].startswith("24 x 16")
    assert str(found).replace(str(folder) + "/", "") == program(folder, "info", "a.exr")
    assert "integrator path" in found["rendered by"] and "red" in found["channels"]
    scene = repository / "tests/references/scenes"
    file = sorted(scene.glob("*.xml"))[0]
    assert aureole.info(file).kind == "scene" and aureole.info(file)["integrator"]
    assert "<th>size</th>" in found._repr_html_()
    rows = rows_of(found)
    assert rows[0] == ["label", "text"] and len(rows) == len(found.rows) + 1 and ["size", found.rows[1][1]] in rows
    with pytest.raises(KeyError, match="there are picture, size"):
        found["nothing"]
    (folder / "nothing.txt").write_text("hello")
    with pytest.raises(aureole.Error, match="is neither a scene file"):
        aureole.info(folder / "nothing.txt")
    with pytest.raises(aureole.Error, match="is not a scene file"):
        aureole.info(folder / "a.exr", {"n": 3})


def test_plots_of_info(folder, small_scene):
    plt = pytest.importorskip("matplotlib.pyplot")
    scene = aureole.load_dict({name: value for name, value in small_scene.items() if name != "quad"})  # arrays are in no file
    image = aureole.render(scene, progress=False)
    image.save(folder / "a.exr")
    shown = lambda name, **how: aureole.info(folder / name).plot(**how)
    pixels = aureole.read_image(folder / "a.exr").tonemap(1.5)
    axes = shown("a.exr", exposure=1.5)
    assert np.array_equal(axes.images[0].get_array(), pixels) and axes.get_title() == "a.exr"
    assert np.array_equal(image.plot().images[0].get_array(), image.tonemap())

    aureole.Image(np.arange(6, dtype=np.float32).reshape(2, 3, 1), ["depth"]).save(folder / "depth.exr")
    assert np.array_equal(shown("depth.exr").images[0].get_array(), [[0, 1, 2], [3, 4, 5]])

    (folder / "small.xml").write_text(scene.xml())
    assert np.array_equal(shown("small.xml", spp=16).images[0].get_array(), image.tonemap())
    program(folder, "render", "small.xml", "--samples", "0:16", "-o", "part.exr", "-q")
    (state,) = folder.glob("*.state")
    assert np.array_equal(shown(state.name).images[0].get_array(), image.tonemap())

    grid = np.fromfunction(lambda z, y, x: x + 10.0 * y + 100.0 * z, (6, 4, 3), dtype=float)  # a .npy has z, y, x
    np.save(folder / "grid.npy", grid.astype(np.float32))
    for axis, expected in (("z", grid[3]), ("y", grid[:, 2]), ("x", grid[:, :, 1])):
        (drawn,) = shown("grid.npy", axis=axis).images
        assert np.array_equal(drawn.get_array(), expected) and drawn.origin == "lower"

    links = np.full((3, 4, 5), -1, np.int32)
    links[1, 2, 3] = 0
    np.savez(folder / "grid.npz", links=links, density_data=np.array([[7.0]], np.float32), sh_data=np.zeros((1, 3), np.float32),
             radius=np.array([3, 4, 10.0]), center=np.zeros(3))
    (drawn,) = (axes := shown("grid.npz", axis="x")).images  # x is 1 of 3; y across, z up
    assert drawn.get_array().shape == (5, 4) and drawn.get_array()[3, 2] == 7 and drawn.get_array().sum() == 7
    assert axes.get_aspect() == pytest.approx((20 / 5) / (8 / 4))

    (folder / "points.ply").write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                                       "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                                       "0 0 3 255 0 0\n1 0 1 0 255 0\n0 2 2 0 0 255\n5 5 0 0 0 0\n")
    (drawn,) = shown("points.ply").collections
    assert drawn.get_offsets().tolist() == [[5, 5], [1, 0], [0, 2], [0, 0]]  # the largest z last
    np.testing.assert_allclose(drawn.get_facecolors(), [[0, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [1, 0, 0, 1]], atol=1e-6)
    assert len(shown("points.ply", points=2, axis="y").collections[0].get_offsets()) == 2
    with pytest.raises(aureole.Error, match='axis: expected "x", "y" or "z"'):
        shown("grid.npy", axis="w")
    (folder / "a.exr").write_bytes(b"")
    with pytest.raises(aureole.Error, match="a.exr"):
        aureole.FileInfo("picture", [], "", str(folder / "a.exr"), {}).plot()
    plt.close("all")


def corona():
    """A photo of rings by the formula of Airy, at three wavelengths, around a lamp of a few pixels."""
    size, fov, radius = 400, 14.0, 10e-6
    x = (np.arange(size) + 0.5 - size / 2) * 2 * np.tan(np.radians(fov / 2)) / size
    angle = np.arctan(np.hypot(*np.meshgrid(x, x)))
    picture = np.empty((size, size, 3))
    for c, nm in enumerate((620, 550, 460)):
        v = 2 * np.pi / (nm * 1e-9) * radius * np.sin(angle)
        series = np.array([np.trapezoid(np.cos(t - v[..., None] * np.sin(t)), t, axis=-1) for t in [np.linspace(0, np.pi, 65)]])[0] / np.pi
        picture[..., c] = (2 * series / v) ** 2
    picture[angle < np.radians(0.12)] = 50
    return aureole.Image(picture), fov, radius


def test_rings_and_droplet_size(folder):
    image, fov, radius = corona()
    found = aureole.rings(image, fov=fov, radius=radius, lamp_distance=100, pane_distance="10cm", area_fraction=0.01, lamp_diameter="1mm")
    assert found.at == (200, 200)
    image.save(folder / "c.exr")
    printed = program(folder, "rings", "c.exr", "--fov", fov, "--radius", "10um", "--lamp-distance", "100m", "--pane-distance", "10cm", "--area-fraction", "0.01",
                      "--lamp-diameter", "1mm")
    assert f"{found.first_maximum[1, 0]:.3f}" in printed and f"{found.first_maximum[1, 1]:.3f}" in printed
    # The first ring of Airy's formula lies at 5.1356 of k a sin(angle).
    assert found.first_maximum[1, 0] == pytest.approx(np.degrees(np.arcsin(5.1356 * 550e-9 / (2 * np.pi * radius))), rel=0.02)
    assert len(rows_of(found)) == 4
    text = "1.922:min:G,2.576:max:G,3.52:min:G"  # of Airy's formula, 10 um
    size = aureole.droplet_size(angles=text, lamp="550nm", area_fraction=0.01)
    program(folder, "droplet-size", "--angles", text, "--lamp", "550nm", "--area-fraction", "0.01", "-o", "size.json")
    theirs = json.loads((folder / "size.json").read_text())
    assert size.radius.value * 1e6 == pytest.approx(theirs["radius_um"]["value"], rel=1e-12)
    assert size.radius.value == pytest.approx(10e-6, rel=0.02)
    assert size.area_fraction.value == 0.01 and rows_of(size)[1][0] == "radius_m"
    with pytest.raises(aureole.Error, match="give either a photo or angles"):
        aureole.droplet_size()
    with pytest.raises(aureole.Error, match="give either pixel_angle or fov"):
        aureole.droplet_size(image)
    with pytest.raises(aureole.Error, match='pixel_angle: expected an angle'):
        aureole.droplet_size(image, pixel_angle="0.01")
    with pytest.raises(aureole.Error, match="a plot needs a photo"):
        size.plot()


def test_powermap(folder):
    options = dict(plane=(0, 0, 0), size=(4, 2), cell=0.25, frequency="3.5GHz", transmitters=[(0, 0, 2)])
    with pytest.warns(UserWarning) as told:
        maps = aureole.powermap(folder / "plane.xml", 16, power="2W", progress=False, **options)
    assert len(maps) == 1 and maps[0].density.shape == (8, 16) and maps[0].band == "3.5 GHz" and maps[0].power == 2
    assert told
    program(folder, "powermap", "plane.xml", "--spp", 16, "--power", "2W", "--plane", 0, 0, 0, "--size", 4, 2, "--cell", 0.25, "--frequency", "3.5GHz",
            "--transmitter", 0, 0, 2, "-o", "map.exr")
    theirs = aureole.read_image(folder / "map.exr")
    np.testing.assert_allclose(maps[0].density, theirs["density"], rtol=1e-6)
    np.testing.assert_allclose(maps[0].received_dbm, theirs["received_dBm"], rtol=1e-5)
    # Free space: 2 W over the sphere of the distance, times the cosine at the plane or not, as the sensor measures.
    assert maps[0].free_space[4, 8] == pytest.approx(2 / (4 * np.pi * 4.03125), rel=0.05)
    assert len(rows_of(maps[0])) == 8 * 16 + 1 and "3.5 GHz: 2 W" in maps[0]._repr_html_()
    with pytest.raises(aureole.Error, match="plane: give its size too"):
        aureole.powermap(folder / "plane.xml", plane=(0, 0, 0), frequency="3.5GHz")
    with pytest.raises(aureole.Error, match="need the path of a scene"):
        aureole.powermap(aureole.load_string("<scene version='3.0.0'><sensor type='perspective'/></scene>"), plane=(0, 0, 0))
    for bad in ("2 horses", "W", "-3W"):
        with pytest.raises(aureole.Error, match='power: .* is no positive power: write "2", "2W", "500mW" or "33dBm"'):
            aureole.powermap(folder / "plane.xml", 16, power=bad, progress=False, **options)


def test_plots(folder):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    aureole.layer(folder / "scene.xml#frosted", samples=1024, step=100).plot()
    assert aureole.medium(folder / "scene.xml#fog").plot().shape == (2,)
    image, fov, radius = corona()
    aureole.rings(image, fov=fov, radius=radius, lamp_distance=100, pane_distance="10cm", area_fraction=0.01, lamp_diameter="1mm").plot()
    with pytest.warns(UserWarning):
        aureole.powermap(folder / "plane.xml", 16, progress=False, plane=(0, 0, 0), size=(2, 1), cell=0.25, frequency="3.5GHz", transmitters=[(0, 0, 2)])[0].plot(show="dBm")
    matplotlib.pyplot.close("all")


def test_a_missing_unit_is_answered_in_the_words_of_python(tmp_path):
    """All arguments with a unit: the sentence names the argument and shows a value as Python writes it, with no option of the command line."""
    picture = aureole.Image(np.random.default_rng(1).uniform(0, 1, (40, 60, 3)))
    micrograph = tmp_path / "a.png"
    picture.save(micrograph)
    layer, fog = aureole.load_dict({"type": "diffuse"}), aureole.load_dict({"type": "homogeneous", "sigma_t": 1.0})
    rings = {"radius": "5um", "area_fraction": 0.3, "pane_distance": "0.5m", "lamp_distance": "20m", "lamp_diameter": "5cm"}
    calls = {
        **{name: (lambda bad, name=name: aureole.rings(picture, **{**rings, name: bad}))
           for name in ("radius", "correlation_radius", "pane_distance", "lamp_distance", "lamp_diameter")},
        **{name: (lambda bad, name=name: aureole.droplet_size(picture, **{name: bad}))
           for name in ("pixel_angle", "angle_error", "lamp_angle", "inner")},
        "length": lambda bad: aureole.medium(fog, length=bad),
        "angle": lambda bad: aureole.layer(layer, angle=bad),
        "pixel_size": lambda bad: aureole.microstructure(str(micrograph), pixel_size=bad),
    }
    for name, call in calls.items():
        for bad in ("5", "5 furlongs", "um", ""):
            with pytest.raises(aureole.Error) as error:
                call(bad)
            assert re.match(rf'{name}: expected an? (length|angle) with its unit, such as "[0-9.]+(um|mm|cm|m|deg)", got ', str(error.value)), str(error.value)
            assert "--" not in str(error.value) and "<" not in str(error.value)
    for entry in ({"type": "correlated_scatterers", "radius": 5.0, "area_fraction": 0.3}, {"type": "mie", "radius": 5.0}):
        with pytest.raises(aureole.SceneError, match='a physical length needs a unit: write "radius": "5um"'):
            aureole.load_dict(entry)

