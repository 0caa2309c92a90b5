# SPDX-License-Identifier: Apache-2.0
"""Rendering and pictures."""
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import aureole


@pytest.fixture
def scene(small_scene):
    return aureole.load_dict(small_scene)


def test_a_picture(scene, tmp_path):
    image = aureole.render(scene, progress=False)
    assert image.shape == (16, 24, 3) and image.channels == ["R", "G", "B"] and image.samples == 16 and image.complete
    assert image.variance is None and image.wavelengths is None and image.invalid_samples == []
    array = image.array
    assert array.dtype == np.float32 and not array.flags.owndata and not array.flags.writeable
    assert np.shares_memory(array, image.array) and np.shares_memory(np.asarray(image), array), "no copies"
    assert np.array_equal(image["G"], array[..., 1]) and np.array_equal(image[["B", "R"]], array[..., [2, 0]])
    np.testing.assert_allclose(image.rgb, array, atol=1e-3 * array.max())  # the film is of half precision
    del image
    assert np.isfinite(array).all()  # the view keeps the memory


def test_saving_and_reading(scene, tmp_path):
    image = aureole.render(scene, progress=False)
    for name in ("a.exr", "a.png", "a.hdr", "a.pfm"):
        image.save(tmp_path / name)
        again = aureole.read_image(str(tmp_path / name))
        assert again.shape == image.shape
    np.testing.assert_allclose(aureole.read_image(tmp_path / "a.exr").array, image.array, rtol=1e-3)  # half
    np.testing.assert_array_equal(aureole.read_image(tmp_path / "a.pfm").array, image.array)
    levels = aureole.read_image(tmp_path / "a.png").array * 255
    np.testing.assert_array_equal(image.tonemap(), levels.round().astype(np.uint8))
    assert (tmp_path / "a.png").read_bytes() == image._repr_png_()
    brighter = image.tonemap(exposure=1)
    assert (brighter >= image.tonemap()).all() and (brighter != image.tonemap()).any()
    for wrong in (tmp_path / "a.jpg", tmp_path / "none" / "a.exr", tmp_path, "a"):
        with pytest.raises(aureole.Error):
            image.save(wrong)
    with pytest.raises(aureole.Error):
        aureole.read_image(tmp_path / "nothing.exr")
    (tmp_path / "bad.exr").write_bytes(b"\x76\x2f\x31\x01" + b"\0" * 20)
    with pytest.raises(aureole.Error, match="bad.exr"):
        aureole.read_image(tmp_path / "bad.exr")


def test_pictures_of_arrays(tmp_path):
    rng = np.random.default_rng(0)
    array = rng.random((5, 7, 3))
    image = aureole.Image(array)
    np.testing.assert_array_equal(image.array, array.astype(np.float32))
    image.save(tmp_path / "x.exr")
    np.testing.assert_array_equal(aureole.read_image(tmp_path / "x.exr").array, image.array)
    assert aureole.Image(array[..., 0]).channels == ["Y"]
    assert aureole.Image(np.zeros((2, 3, 2)), ["depth", "id"])._repr_png_() is None
    # Channels of names beyond colours, and arrays that are not contiguous.
    np.testing.assert_array_equal(aureole.Image(array[::-1, ::2]).array, array[::-1, ::2].astype(np.float32))
    for wrong, error in ((np.zeros((0, 3, 3)), aureole.Error), (np.zeros(3), aureole.Error), ("x", TypeError),
                         (np.zeros((2, 2, 3), complex), TypeError), (np.zeros((2, 2, 7)), aureole.Error)):
        with pytest.raises(error):
            aureole.Image(wrong)
    with pytest.raises(aureole.Error, match="channels"):
        aureole.Image(array, ["a"])
    with pytest.raises(KeyError, match="there are R, G, B"):
        image["X"]
    with pytest.raises(TypeError, match="^channel: expected a name"):
        image[np.array("R")]


def test_variance_seed_and_threads(scene):
    image = aureole.render(scene, 16, replicates=4, progress=False)
    assert image.variance is not None and image.variance.shape == image.shape and (image.variance >= 0).all()
    assert image.channels == ["R", "G", "B"]
    a, b = (aureole.render(scene, 16, seed=s, progress=False).array for s in (1, 2))
    assert not np.array_equal(a, b)
    one, two = (aureole.render(scene, 16, seed=1, threads=t, progress=False).array for t in (1, 2))
    assert np.array_equal(one, two) and np.array_equal(a, one)


def test_refinements(scene):
    images = list(aureole.render_iter(scene, 100))
    assert [i.samples for i in images] == [16, 32, 64, 100] or images[-1].info["samples_asked"] == 100
    assert np.array_equal(images[-1].array, aureole.render(scene, 100, progress=False).array)
    assert [i.info["samples_asked"] for i in aureole.render_iter(scene, 64, step=16)] == [16, 32, 48, 64]
    more = aureole.render(scene, 128, start=images[2], progress=False)
    assert np.array_equal(more.array, aureole.render(scene, 128, progress=False).array)
    with pytest.raises(aureole.Error, match="step"):
        aureole.render_iter(scene, 64, step=10)
    adaptive = list(aureole.render_iter(scene, 64, adaptive="absolute"))
    assert adaptive[-1].info["adaptive"] == "absolute" and images[0].info["adaptive"] == "none"
    assert np.array_equal(adaptive[-1].array, aureole.render(scene, 64, adaptive="absolute", progress=False).array)
    with pytest.raises(aureole.Error, match="adaptive"):
        aureole.render(scene, 128, adaptive="display", start=adaptive[-1], progress=False)
    with pytest.raises(aureole.Error, match="absolute, display, relative"):
        aureole.render(scene, 16, adaptive="some", progress=False)
    with pytest.raises(TypeError, match="adaptive"):
        aureole.render(scene, 16, adaptive=True, progress=False)
    scene["ball.radius"] = 0.5
    with pytest.raises(aureole.Error, match="another picture"):
        aureole.render(scene, 128, start=images[2], progress=False)
    with pytest.raises(aureole.Error, match="start"):
        aureole.render(scene, 16, start=aureole.Image(np.zeros((16, 24, 3))), progress=False)


def test_spectral_films(small_scene):
    small_scene["camera"]["film"] = {"type": "specfilm", "width": 6, "height": 4, "bins": 4,
                                     "wavelength_min": 400.0, "wavelength_max": 700.0}
    image = aureole.render(aureole.load_dict(small_scene), 4, progress=False)
    np.testing.assert_allclose(image.wavelengths, [437.5, 512.5, 587.5, 662.5])
    assert image.spectra.shape == (4, 6, 4) and (image.spectra > 0).all() and image._repr_png_() is not None and image.rgb.shape == (4, 6, 3)


def test_arguments(scene):
    for name, values in {"spp": (0, -1, 1.5, "16", True, 2**40), "seed": (-1, 0.5, 2**64), "threads": (-1, 5000, None),
                         "time": (-1, np.nan, "s"), "replicates": (0, 1.5), "progress": (None, 3),
                         "start": ("x", 1)}.items():
        for value in values:
            with pytest.raises((TypeError, aureole.Error), match=name):
                aureole.render(scene, **{name: value})
    with pytest.raises(TypeError, match="scene"):
        aureole.render({"type": "scene"})


def test_progress(scene, capfd):
    scene.update({"camera.film.width": 96, "camera.film.height": 96})
    calls = []
    aureole.render(scene, 512, progress=lambda *a: calls.append(a))
    assert calls and calls[-1][0] == calls[-1][1] and all(len(c) == 4 for c in calls)

    def broken(*_):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        aureole.render(scene, 4096, progress=broken)
    assert capfd.readouterr().out == ""


def test_interruption_keeps_what_is_done(scene):
    scene.update({"camera.film.width": 256, "camera.film.height": 256})
    threading.Timer(0.5, lambda: signal.raise_signal(signal.SIGINT)).start()
    started = time.monotonic()
    with pytest.warns(aureole.InterruptedWarning, match="interrupted"):
        image = aureole.render(scene, 2**20, progress=False)
    assert time.monotonic() - started < 20
    assert not image.complete and 0 < image.info["part"] < 1 and image.array.max() > 0 and "interrupted" in repr(image)
    more = aureole.render(scene, image.samples // 16 * 16 + 16, start=image, progress=False) if image.samples else None
    assert more is None or more.complete


def test_time_limit(scene):
    scene.update({"camera.film.width": 128, "camera.film.height": 128})
    image = aureole.render(scene, 2**20, time=0.3, progress=False)
    assert not image.complete and image.samples >= 16 and image.samples % 16 == 0


def test_other_threads_run_and_change_parameters(scene):
    scene.update({"camera.film.width": 256, "camera.film.height": 256})
    done = threading.Event()
    ticks = []

    def other():
        while not done.wait(0.01):
            ticks.append(1)
            if len(ticks) == 20:
                scene["ball.radius"] = 0.5

    thread = threading.Thread(target=other)
    thread.start()
    aureole.render(scene, 2**20, time=1.0, progress=False)
    done.set()
    thread.join()
    assert len(ticks) > 30
    assert scene["ball.radius"] == 0.5


def test_two_renders_at_once(scene, small_scene):
    expected = aureole.render(scene, 64, progress=False).array
    other = aureole.load_dict(small_scene)
    results = {}

    def work(name, s):
        results[name] = aureole.render(s, 64, progress=False).array

    threads = [threading.Thread(target=work, args=(i, s)) for i, s in enumerate((scene, scene, other))]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(np.array_equal(results[i], expected) for i in range(3))


def test_a_picture_says_how_its_file_was_understood(tmp_path):
    header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 1 +X 1\n"
    (tmp_path / "bright.hdr").write_bytes(header.encode() + bytes([128, 128, 128, 129]))
    image = aureole.read_image(tmp_path / "bright.hdr")
    [note] = image.notes
    assert note.startswith("values are divided by EXPOSURE") and image.array[0, 0, 0] == 0.5
    assert pickle.loads(pickle.dumps(image)).notes == image.notes
    assert aureole.Image(np.ones((2, 2))).notes == []
