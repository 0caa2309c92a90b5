# SPDX-License-Identifier: Apache-2.0
"""`aureole.denoise`: groups of channels and weights with a stand-in for the network; the network itself where `pyoidn` is installed."""
import os
import subprocess
import sys
import types

import numpy as np
import pytest

import aureole
from aureole import _denoise


def stand_in(answer, calls):
    module = types.ModuleType("pyoidn")

    def denoise(color, albedo=None, normal=None, *, hdr, clean_aux, quality):
        calls.append((color, albedo, normal, hdr, clean_aux, quality))
        return answer(color)

    module.denoise = denoise
    return module


@pytest.fixture
def network(monkeypatch):
    """Makes `pyoidn` a module whose network answers by a function; returns the list of its calls."""

    def install(answer):
        calls = []
        monkeypatch.setitem(sys.modules, "pyoidn", stand_in(answer, calls))
        return calls

    return install


def test_channels_are_treated_in_groups(network):
    calls = network(lambda color: color * 0 + np.float32(7))
    bins = [f"S0.{nm},0nm" for nm in (400, 450, 500, 550, 600)]
    image = aureole.Image(np.random.default_rng(1).uniform(0, 1, (5, 4, 7)), [*bins, "A", "depth.T"])
    found = aureole.denoise(image)
    assert len(calls) == 2 and calls[0][3] is True and calls[0][4] is False
    np.testing.assert_array_equal(calls[0][0], image.array[..., :3])
    np.testing.assert_array_equal(calls[1][0], image.array[..., 2:5])  # the last bins with a neighbour
    assert np.all(found[bins] == 7)
    np.testing.assert_array_equal(found["A"], image["A"])
    np.testing.assert_array_equal(found[[f"noisy.{b}" for b in bins]], image[bins])
    grey = aureole.denoise(aureole.Image(np.ones((3, 3))))
    assert grey.channels == ["Y", "noisy.Y"]


def test_clean_pixels_stay_and_bias_is_not_taken(network):
    """The left half has no noise and a network that is wrong there; the right half has noise and a network that is right."""
    rng = np.random.default_rng(2)
    truth = np.ones((40, 60, 3), np.float32)
    noise = np.where(np.arange(60)[:, None] < 30, 1e-4, 0.3).astype(np.float32)
    noisy = (truth + noise * rng.normal(size=truth.shape)).astype(np.float32)
    wrong = np.where(np.arange(60)[:, None] < 30, 1.1, 1.0).astype(np.float32) * truth
    network(lambda color: wrong)
    names = ["R", "G", "B"]
    image = aureole.Image(np.concatenate([noisy, np.broadcast_to(noise**2, truth.shape)], -1), [*names, *(f"variance.{n}" for n in names)])
    found = aureole.denoise(image)
    left, right = found.array[:, :26, :3], found.array[:, 34:, :3]
    assert np.abs(left - 1).max() < 1e-3  # the network's error of 0.1 is not taken
    assert np.sqrt(np.mean((right - 1) ** 2)) < 0.1  # of 0.3
    as_it_is = aureole.denoise(image, keep_clean=False)
    np.testing.assert_array_equal(as_it_is.array[..., :3], wrong)


def test_means_over_windows():
    values = np.random.default_rng(3).normal(size=(9, 12)) ** 2
    found = _denoise._window_mean(values)
    padded = np.pad(values, 3, mode="symmetric")
    expected = [[padded[y:y + 7, x:x + 7].mean() for x in range(12)] for y in range(9)]
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def test_features_of_the_first_surfaces():
    albedo, normal = _denoise.features(aureole.load_string(SCENE), 16)
    assert albedo.shape == normal.shape == (16, 24, 3)
    np.testing.assert_allclose(albedo[8, 12], [0.5, 0.5, 0.5], atol=0.01)
    np.testing.assert_allclose(np.linalg.norm(normal[8, 12]), 1, atol=0.02)


SCENE = """<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler></sensor>
  <shape type="sphere"><float name="radius" value="0.8"/><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="-1"/></transform><bsdf type="diffuse"/></shape>
  <shape type="sphere"><point name="center" x="2" y="2" z="2"/><float name="radius" value="0.3"/><emitter type="area"><rgb name="radiance" value="40, 40, 40"/></emitter></shape>
  <emitter type="constant"><rgb name="radiance" value="0.3, 0.3, 0.4"/></emitter>
</scene>"""


def test_features_are_filtered_before_they_guide(network):
    calls = network(lambda color: color)
    scene = aureole.load_string(SCENE)
    image = aureole.render(scene, 1, progress=False)
    aureole.denoise(image, scene=scene, feature_samples=1)
    assert [call[3] for call in calls] == [False, False, True]  # albedo, normal, picture
    color, albedo, normal, _, clean, _ = calls[2]
    np.testing.assert_array_equal(albedo, calls[0][0])
    np.testing.assert_allclose(normal, 2 * calls[1][0] - 1, atol=1e-6)
    assert clean and albedo.max() <= 1


def test_a_render_is_denoised_by_itself(network, tmp_path):
    """Features, variance and a film without overlapping pixels come with the picture, and the EXR keeps both."""
    calls = network(lambda color: color)
    scene = aureole.load_string(SCENE)
    image = aureole.render(scene, 64, progress=False, denoise=True)
    assert [call[3] for call in calls] == [False, False, True]  # albedo, normal, picture
    assert image.channels == ["R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "noisy.R", "noisy.G", "noisy.B"]
    np.testing.assert_allclose(image["albedo.G"][8, 12], 0.5, atol=0.01)
    # The noisy picture is that of 4 replicates of 16 samples with a box filter.
    boxed = aureole.load_string(SCENE.replace('hdrfilm">', 'hdrfilm"><rfilter type="box"/>'))
    noisy = aureole.render(boxed, 16, replicates=4, progress=False)
    np.testing.assert_array_equal(image[["noisy.R", "noisy.G", "noisy.B"]], noisy[["R", "G", "B"]])
    np.testing.assert_array_equal(calls[2][0], noisy[["R", "G", "B"]])
    assert image.complete and "box" not in scene.xml()  # the scene has its own filter still
    image.save(tmp_path / "a.exr")
    again = aureole.read_image(tmp_path / "a.exr")
    assert sorted(again.channels) == sorted(image.channels)
    described = aureole.info(tmp_path / "a.exr").text
    assert "edited       denoised by Open Image Denoise, quality high" in described
    assert "4 replicates, whose variances are not stored" in described
    with pytest.raises(aureole.Error, match='is denoised already: it has the layer "noisy"'):
        aureole.denoise(again)


def test_layers_of_a_picture_guide(network):
    calls = network(lambda color: color)
    names = ["R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"]
    pixels = np.random.default_rng(4).uniform(0, 1, (6, 5, 9)).astype(np.float32)
    aureole.denoise(aureole.Image(pixels, names))
    assert len(calls) == 3 and calls[2][4] is True
    np.testing.assert_array_equal(calls[2][1], pixels[..., 3:6])
    np.testing.assert_allclose(calls[2][2], pixels[..., 6:], atol=1e-6)


def test_the_header_stays(network, tmp_path):
    network(lambda color: color)
    aureole.render(aureole.load_string(SCENE), 4, seed=77, progress=False).save(tmp_path / "a.exr")
    aureole.denoise(aureole.read_image(tmp_path / "a.exr")).save(tmp_path / "b.exr")
    before, after = (aureole.info(tmp_path / name).text for name in ("a.exr", "b.exr"))
    assert "77" in before and "77" in after


def test_denoise_argument(network, monkeypatch):
    network(lambda color: color)
    scene = aureole.load_string(SCENE)
    image = aureole.render(scene, 1, progress=False)
    with pytest.raises(aureole.Error, match="start: a picture that is denoised can't be continued"):
        aureole.render(scene, 2, start=image, denoise=True, progress=False)
    with pytest.raises(TypeError, match="denoise: expected"):
        aureole.render(scene, 2, denoise="yes", progress=False)
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(aureole.Error, match="pip install pyoidn"):  # before anything is rendered
        aureole.render(scene, 10**9, denoise=True, progress=False)


def program_environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PATH": os.path.dirname(sys.executable) + os.pathsep + os.environ["PATH"]}


def test_the_command_refuses_before_it_renders(tmp_path):
    (tmp_path / "scene.xml").write_text(SCENE)
    (tmp_path / "no").mkdir()
    (tmp_path / "no" / "pyoidn.py").write_text("raise ImportError('not here')")
    environment = program_environment()
    environment["PYTHONPATH"] = os.pathsep.join([str(tmp_path / "no"), environment["PYTHONPATH"]])
    for words, said in ((["-o", "a.exr", "--spp", "100000000"], "pip install 'aureole[denoise]'"), (["-o", "a.hdr"], "the output is an .exr"),
                        (["--pixel", "1,1"], "either --denoise or --pixel"), (["--samples", "0:16"], "merge the parts")):
        done = subprocess.run([os.environ["AUREOLE_BINARY"], "render", "scene.xml", "--denoise", *words], cwd=tmp_path, capture_output=True, text=True,
                              env=environment, timeout=120)
        assert done.returncode == 2 and said in done.stderr, done.stderr
    assert not (tmp_path / "a.exr").exists()


def test_bad_input(network):
    network(lambda color: color)
    image = aureole.Image(np.ones((3, 4, 3)))
    with pytest.raises(TypeError, match="image: expected an Image"):
        aureole.denoise(3)
    with pytest.raises(aureole.Error, match="quality: expected"):
        aureole.denoise(image, quality="best")
    with pytest.raises(aureole.Error, match=r"albedo: expected the shape \(3, 4, 3\)"):
        aureole.denoise(image, albedo=np.ones((4, 3, 3)))
    with pytest.raises(aureole.Error, match="with an albedo only"):
        aureole.denoise(image, normal=np.ones((3, 4, 3)))
    with pytest.raises(aureole.Error, match="expected channels R, G and B"):
        aureole.denoise(aureole.Image(np.ones((3, 4, 1)), ["depth"]))


def test_a_missing_package_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(aureole.Error, match="denoising needs Open Image Denoise: pip install pyoidn"):
        aureole.denoise(aureole.Image(np.ones((3, 4, 3))))


def test_the_network_and_the_command(tmp_path):
    pytest.importorskip("pyoidn", reason="the network needs Open Image Denoise: pip install pyoidn")
    (tmp_path / "scene.xml").write_text(SCENE)
    environment = program_environment()
    done = subprocess.run([os.environ["AUREOLE_BINARY"], "denoise", "scene.xml", "--spp", "16", "--replicates", "2", "-q", "-o", "a.exr"], cwd=tmp_path, capture_output=True,
                          text=True, env=environment)
    assert done.returncode == 0, done.stderr
    found, truth = aureole.read_image(tmp_path / "a.exr"), aureole.render(aureole.load_string(SCENE.replace("hdrfilm\">", "hdrfilm\"><rfilter type=\"box\"/>")), 4096, progress=False)
    error = lambda names: np.sqrt(np.mean((found[names] - truth[["R", "G", "B"]]) ** 2))
    assert error(["R", "G", "B"]) < 0.6 * error(["noisy.R", "noisy.G", "noisy.B"])
    assert (tmp_path / "a.png").exists()
    # `render --denoise` gives a picture whose bits are those of `aureole.render(..., denoise=True)`.
    done = subprocess.run([os.environ["AUREOLE_BINARY"], "render", "scene.xml", "--denoise", "--spp", "64", "-o", "b.exr", "--tonemap", "asinh:4:0"], cwd=tmp_path,
                          capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert "divided among 4 replicates" in done.stderr and "filter is \"box\"" in done.stderr
    by_command, here = aureole.read_image(tmp_path / "b.exr"), aureole.render(aureole.load_string(SCENE), 64, progress=False, denoise=True)
    for name in here.channels:
        np.testing.assert_array_equal(by_command[name], here[name])
    found = by_command
    assert error(["R", "G", "B"]) < 0.75 * error(["noisy.R", "noisy.G", "noisy.B"])
    assert not (tmp_path / "b.state").exists()
    aureole.convert(tmp_path / "b.exr", tmp_path / "c.png", tonemap="asinh:4:0")
    assert (tmp_path / "b.png").read_bytes() == (tmp_path / "c.png").read_bytes()
