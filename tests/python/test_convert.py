# SPDX-License-Identifier: Apache-2.0
"""`aureole convert` and `aureole.convert`, judged by Pillow and by formulas."""
import os
import socket
import struct
import subprocess
import threading

import numpy as np
import pytest
from PIL import Image as Pillow
from PIL import ImageCms

import aureole


def encode(linear):
    linear = np.asarray(linear, float)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)


def decode(value):
    value = np.asarray(value, float)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


@pytest.fixture
def picture(tmp_path):
    """A picture below the shoulder of the display's curve, and its values."""
    values = np.random.default_rng(1).uniform(0.001, 0.7, (12, 17, 3)).astype(np.float32)
    aureole.Image(values).save(tmp_path / "a.exr")
    return tmp_path / "a.exr", values


def test_integers_are_encoded(picture, tmp_path):
    path, values = picture
    for name, error in (("b.png", 0.5 / 255), ("b.tif", 0.5 / 65535), ("b.jpg", 8 / 255)):
        aureole.convert(path, tmp_path / name, quality=100)
        back = aureole.read_image(tmp_path / name).array
        np.testing.assert_allclose(back, encode(values), atol=error + 1e-5)
    np.testing.assert_allclose(np.asarray(Pillow.open(tmp_path / "b.png")) / 255, encode(values), atol=0.51 / 255)
    # Encoded values come back linear.
    aureole.convert(tmp_path / "b.tif", tmp_path / "c.exr")
    np.testing.assert_allclose(aureole.read_image(tmp_path / "c.exr").array, values, rtol=2e-3, atol=2e-5)
    aureole.convert(path, tmp_path / "f.tif", bits=32)
    np.testing.assert_array_equal(aureole.read_image(tmp_path / "f.tif").array, values)


def test_exposure_crop_and_difference(picture, tmp_path):
    path, values = picture
    aureole.convert(path, tmp_path / "b.exr", exposure=-1.5, crop=[3, 2, 5, 7])
    expected = values[2:9, 3:8] * np.float32(2**-1.5)
    np.testing.assert_allclose(aureole.read_image(tmp_path / "b.exr").array, expected, rtol=1e-6)
    aureole.convert(path, tmp_path / "half.exr", exposure=-1)
    for kind, expected in (("plain", values / 2), ("absolute", values / 2), ("relative", np.ones_like(values))):
        aureole.convert(path, tmp_path / "d.exr", difference=tmp_path / "half.exr", difference_kind=kind)
        np.testing.assert_allclose(aureole.read_image(tmp_path / "d.exr").array, expected, rtol=1e-5)
    aureole.convert(tmp_path / "half.exr", tmp_path / "d.exr", difference=path, difference_kind="plain")
    np.testing.assert_allclose(aureole.read_image(tmp_path / "d.exr").array, -values / 2, rtol=1e-5)


def test_alpha(tmp_path):
    values = np.array([[[0.2, 0.1, 0.05, 0.5], [0, 0, 0, 0], [0.4, 0.5, 0.6, 1]]], np.float32)
    aureole.Image(values).save(tmp_path / "a.exr")
    aureole.convert(tmp_path / "a.exr", tmp_path / "a.png", bits=16)
    image = np.asarray(aureole.read_image(tmp_path / "a.png").array)
    np.testing.assert_allclose(image[0, 0], [*encode([0.4, 0.2, 0.1]), 0.5], atol=1e-4)
    aureole.convert(tmp_path / "a.png", tmp_path / "b.exr")
    np.testing.assert_allclose(aureole.read_image(tmp_path / "b.exr").array, values, atol=1e-4)
    with pytest.warns(UserWarning, match="has no alpha: the picture is over black"):
        aureole.convert(tmp_path / "a.exr", tmp_path / "a.jpg")
    np.testing.assert_allclose(np.asarray(Pillow.open(tmp_path / "a.jpg"))[0, 2] / 255, encode([0.4, 0.5, 0.6]), atol=0.06)


def test_layers_and_channels(tmp_path):
    names = ["R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "depth.Y"]
    values = np.random.default_rng(2).uniform(0.01, 0.7, (4, 5, 7)).astype(np.float32)
    aureole.Image(values, names).save(tmp_path / "a.exr")
    aureole.convert(tmp_path / "a.exr", tmp_path / "b.exr", channel="albedo")
    np.testing.assert_array_equal(aureole.read_image(tmp_path / "b.exr").array, values[..., 3:6])
    aureole.convert(tmp_path / "a.exr", tmp_path / "b.pfm", channel="depth.Y")
    np.testing.assert_array_equal(aureole.read_image(tmp_path / "b.pfm").array[..., 0], values[..., 6])
    with pytest.raises(aureole.Error, match="there is no channel normal; there are"):
        aureole.convert(tmp_path / "a.exr", tmp_path / "b.png", channel="normal")
    with pytest.warns(UserWarning, match="the exposure changes R, G, B and Y, not albedo.B"):
        aureole.convert(tmp_path / "a.exr", tmp_path / "b.exr", exposure=1)
    image = aureole.read_image(tmp_path / "b.exr")
    np.testing.assert_allclose(image["R"], 2 * values[..., 0], rtol=1e-6)
    np.testing.assert_array_equal(image["depth.Y"], values[..., 6])


def test_false_colors(tmp_path):
    values = np.geomspace(0.1, 1000, 64, dtype=np.float32).reshape(1, 64).repeat(40, 0)
    aureole.Image(values).save(tmp_path / "a.exr")
    aureole.convert(tmp_path / "a.exr", tmp_path / "a.png", false_color="gray", log=True, contours=2)
    row = np.asarray(Pillow.open(tmp_path / "a.png"))[26 + 15, :640, 0].reshape(64, 10)[:, 5] / 255
    np.testing.assert_allclose(np.delete(row, [20, 21, 42, 43]), np.delete(np.linspace(0, 1, 64), [20, 21, 42, 43]), atol=0.03)
    for settings, said in ((dict(false_color="rainbow"), "no colour map"), (dict(false_color="gray", low=3, high=2), "the scale must rise"),
                           (dict(false_color="gray", log=True, low=-1), "begins above 0"), (dict(low=1), "are for false colours"),
                           (dict(bits=12), "8 or 16 bits"), (dict(crop=[0, 0, 65, 2]), "is not inside 64 x 40 pixels"),
                           (dict(tonemap="x"), "expected asinh"), (dict(crop=[1, 2]), "x, y, width and height")):
        with pytest.raises(aureole.Error, match=said):
            aureole.convert(tmp_path / "a.exr", tmp_path / "b.png", **settings)
    assert not (tmp_path / "b.png").exists()


def test_profiles(tmp_path):
    """Profiles that Pillow embeds are converted, and Pillow takes ours for sRGB."""
    rgb = np.array([[[255, 255, 255], [200, 100, 50], [20, 180, 90]]], np.uint8)
    srgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB"))
    Pillow.fromarray(rgb).save(tmp_path / "s.png", icc_profile=srgb.tobytes())
    assert np.array_equal(np.round(aureole.read_image(tmp_path / "s.png").array * 255), rgb)
    lab = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB"))
    Pillow.fromarray(rgb).save(tmp_path / "l.png", icc_profile=lab.tobytes())
    with pytest.warns(UserWarning, match="is not used .iCCP.*: its colours are taken for sRGB"):
        aureole.convert(tmp_path / "l.png", tmp_path / "l.exr")
    Pillow.fromarray(rgb).save(tmp_path / "bad.jpg", icc_profile=b"no profile" * 30)
    with pytest.warns(UserWarning, match="colour profile in the file is damaged"):
        aureole.convert(tmp_path / "bad.jpg", tmp_path / "bad.exr")
    values = decode(rgb / 255).astype(np.float32)
    aureole.Image(values).save(tmp_path / "a.exr")
    for name in ("a.jpg", "a.tif"):
        aureole.convert(tmp_path / "a.exr", tmp_path / name, bits=8 if name == "a.tif" else None)
        image = Pillow.open(tmp_path / name)
        import io
        ours = ImageCms.ImageCmsProfile(io.BytesIO(image.info["icc_profile"]))
        same = ImageCms.profileToProfile(image.convert("RGB"), ours, srgb)
        assert np.abs(np.asarray(same, int) - np.asarray(image.convert("RGB"), int)).max() <= 1
    assert Pillow.open(tmp_path / "s.png").mode == "RGB"


def test_command(picture, tmp_path):
    path, values = picture
    run = lambda *words: subprocess.run([os.environ["AUREOLE_BINARY"], "convert", *map(str, words)], capture_output=True, text=True)
    done = run(path, "-o", tmp_path / "b.png", "--exposure", "-1", "--crop", "0,0,4,4")
    assert done.returncode == 0 and "4 x 4 pixels" in done.stdout
    np.testing.assert_allclose(np.asarray(Pillow.open(tmp_path / "b.png")) / 255, encode(values[:4, :4] / 2), atol=0.51 / 255)
    for words, said in (((path, "-o", tmp_path / "b.gif"), "is none of a picture's"), ((path, "-o", tmp_path / "b.png", "--crop", "0,0,1.5,4"), "whole pixels"),
                        ((tmp_path / "none.exr", "-o", tmp_path / "b.png"), "no such file"), ((path, "-o", tmp_path / "b.hdr", "--tonemap", "asinh"), "tone mapping is for integers")):
        failed = run(*words)
        assert failed.returncode == 2 and said in failed.stderr, failed.stderr


def _packets(connection):
    """Packets of one connection, decoded as tev does: u32 length with itself, u8 type, content."""
    data = b""
    while block := connection.recv(1 << 16):
        data += block
    while data:
        (length,) = struct.unpack_from("<I", data)
        yield data[4], data[5:length]
        data = data[length:]


def _text(data):
    end = data.index(0)
    return data[:end].decode(), data[end + 1:]


def test_viewer(tmp_path):
    (tmp_path / "a.xml").write_text('''<scene version="3.0.0"><integrator type="path"/><emitter type="constant"/>
        <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="12"/></film>
        <sampler type="independent"><integer name="sample_count" value="64"/></sampler></sensor>
        <shape type="sphere"><point name="center" x="0" y="0" z="4"/></shape></scene>''')
    server = socket.create_server(("localhost", 0))
    seen = []

    def listen():
        connection, _ = server.accept()
        seen.extend(_packets(connection))

    listener = threading.Thread(target=listen)
    listener.start()
    port = server.getsockname()[1]
    command = [os.environ["AUREOLE_BINARY"], "render", str(tmp_path / "a.xml"), "-o", str(tmp_path / "a.exr"), "-q", "--tev"]
    done = subprocess.run([*command, f"localhost:{port}"], capture_output=True, text=True)
    listener.join()
    server.close()
    assert done.returncode == 0, done.stderr
    kind, content = seen[0]
    assert kind == 4 and content[0] == 0
    name, rest = _text(content[1:])
    width, height, count = struct.unpack_from("<iii", rest)
    assert (name, width, height) == ("a.exr", 20, 12)
    kind, content = seen[-1]
    assert kind == 6
    name, rest = _text(content[1:])
    (channels,) = struct.unpack_from("<i", rest)
    rest, names = rest[4:], []
    for _ in range(channels):
        one, rest = _text(rest)
        names.append(one)
    x, y, width, height, *layout = struct.unpack_from(f"<iiii{2 * channels}q", rest)
    values = np.frombuffer(rest[16 + 16 * channels:], "<f4")
    assert (name, x, y, width, height, channels) == ("a.exr", 0, 0, 20, 12, count)
    image = aureole.read_image(tmp_path / "a.exr")
    for c, one in enumerate(names):
        offset, stride = layout[c], layout[channels + c]
        np.testing.assert_allclose(values[offset::stride].reshape(12, 20), image[one], rtol=1e-3)  # the file has halves
    failed = subprocess.run([*command, f"localhost:{port}", "--restart"], capture_output=True, text=True)
    assert failed.returncode == 2 and "no viewer listens" in failed.stderr, failed.stderr
    wrong = subprocess.run([*command, "localhost:tev", "--restart"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "the port is a number up to 65535" in wrong.stderr, wrong.stderr
