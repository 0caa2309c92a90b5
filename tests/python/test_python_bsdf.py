# SPDX-License-Identifier: Apache-2.0
"""BSDFs written in Python: evaluated alone, checked as any other, and in renders."""
from __future__ import annotations

import gc
import subprocess
import sys
import textwrap
import weakref

import numpy as np
import pytest

import aureole

UP = (0.0, 0.0, 1.0)


class Lambert(aureole.PythonBsdf):
    """Only what a class has to have."""

    lobes = ("diffuse", "reflect")

    def __init__(self, reflectance=0.5):
        self.reflectance = reflectance
        self.calls = 0

    def eval(self, wi, wo, wavelength):
        self.calls += 1
        return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), self.reflectance / np.pi * wo[:, 2], 0)


class Tilted:
    """No base class, all methods: a lobe about a direction that depends on the wavelength, so that rows go different ways."""

    lobes = "glossy", "reflect"
    power = 20

    def mirror(self, wi, wavelength):
        angle = (wavelength - 595) / 400
        x, z = wi[:, 0], wi[:, 2]
        return np.stack([-(x * np.cos(angle) + z * np.sin(angle)), -wi[:, 1], z * np.cos(angle) - x * np.sin(angle)], axis=-1)

    def pdf(self, wi, wo, wavelength):
        c = np.sum(self.mirror(wi, wavelength) * wo, axis=-1)
        return np.where((wi[:, 2] > 0) & (c > 0), (self.power + 1) / (2 * np.pi) * np.maximum(c, 0) ** self.power, 0)

    def eval(self, wi, wo, wavelength):
        return 0.8 * self.pdf(wi, wo, wavelength)

    def sample(self, wi, wavelength, u):
        axis = self.mirror(wi, wavelength)
        s = np.cross(axis, np.where(np.abs(axis[:, :1]) > 0.5, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)))
        s /= np.linalg.norm(s, axis=-1, keepdims=True)
        t = np.cross(axis, s)
        c, phi = (1 - u[:, 1]) ** (1 / (self.power + 1)), 2 * np.pi * u[:, 2]
        r = np.sqrt(1 - c * c)
        wo = (r * np.cos(phi))[:, None] * s + (r * np.sin(phi))[:, None] * t + c[:, None] * axis
        return wo, self.eval(wi, wo, wavelength), self.pdf(wi, wo, wavelength), (wi[:, 2] > 0) & (wo[:, 2] > 0)


class Prism(aureole.PythonBsdf):
    """A delta whose direction depends on the wavelength."""

    lobes = ("delta", "transmit")

    def eval(self, wi, wo, wavelength):
        return 0.0

    def sample(self, wi, wavelength, u):
        eta = 1.5 + (wavelength - 595) * 1e-3
        x, y = -wi[:, 0] / eta, -wi[:, 1] / eta
        wo = np.stack([x, y, -np.copysign(np.sqrt(1 - x * x - y * y), wi[:, 2])], axis=-1)
        one = np.ones(len(wi))
        return aureole.BsdfSample(wo, one, one, eta=eta)


def scene(bsdf, spp=4, size=8):
    return {
        "type": "scene",
        "sensor": {"type": "perspective", "fov": 40, "to_world": aureole.Transform().look_at(origin=(0, -3, 2), target=(0, 0, 0), up=(0, 0, 1)),
                   "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
                   "sampler": {"type": "independent", "sample_count": spp}},
        "integrator": {"type": "path", "max_depth": 3},
        "floor": {"type": "rectangle", "bsdf": bsdf},
        "ball": {"type": "sphere", "center": (0, 0, 0.5), "radius": 0.4, "bsdf": bsdf},
        "light": {"type": "constant", "radiance": 1.0},
    }


def pixels(image):
    return np.asarray(image, np.float64)[..., :3]


# ---------------------------------------------------------------- alone


def test_one_call_for_a_whole_array():
    plugin, mine = aureole.load_dict({"type": "diffuse", "reflectance": 0.5}), Lambert()
    bsdf = aureole.as_bsdf(mine)
    random = np.random.default_rng(1)
    wo = random.normal(size=(50, 1, 3))
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
    nm = np.linspace(400, 700, 7)
    np.testing.assert_allclose(bsdf.eval(UP, wo, nm), plugin.eval(UP, wo, nm), rtol=1e-6)
    assert mine.calls == 1 and bsdf.eval(UP, wo, nm).shape == (50, 7)
    np.testing.assert_allclose(bsdf.pdf(UP, wo, nm), plugin.pdf(UP, wo, nm), rtol=1e-6)
    s = bsdf.sample(UP, nm, random.random((50, 1, 3)))
    assert s.wo.shape == (50, 7, 3) and s.valid.all() and not s.is_delta.any()
    np.testing.assert_allclose(s.weight, 0.5, rtol=1e-9)
    np.testing.assert_allclose(bsdf.albedo([0, 1.0], 500), 0.5, rtol=1e-9)
    assert bsdf.eval(np.zeros((0, 3)), UP, 500).shape == (0,)
    assert isinstance(bsdf.eval(UP, UP, 500), float)
    assert bsdf.lobes == ("diffuse", "reflect") and bsdf.family == "bsdf" and "Lambert" in repr(bsdf)


def test_as_bsdf_passes_plugins():
    bsdf = aureole.load_dict({"type": "diffuse"})
    assert aureole.as_bsdf(bsdf) is bsdf


def test_uv_and_mode_for_those_who_ask():
    class Curious(Lambert):
        def eval(self, wi, wo, wavelength, *, mode, uv):
            assert uv.shape == (len(wi), 2)
            return uv[:, 0] * (1 if mode == "radiance" else 2)

    bsdf = aureole.as_bsdf(Curious())
    assert bsdf.eval(UP, UP, 500, uv=[(0.25, 0), (0.75, 0)]).tolist() == [0.25, 0.75]
    assert bsdf.eval(UP, UP, 500, mode="importance") == 1.0


def test_harness():
    """The harness asks for 8 wavelengths at a time."""
    report = aureole.check(aureole.as_bsdf(Lambert(0.8)), samples=1000)
    assert report.passed, report


# ---------------------------------------------------------------- renders


def test_renders_as_the_plugin_does():
    mine = pixels(aureole.render(aureole.load_dict(scene(Lambert(0.5), spp=8)), seed=1))
    plugin = pixels(aureole.render(aureole.load_dict(scene({"type": "diffuse", "reflectance": 0.5}, spp=8)), seed=2))
    assert mine.mean() > 0.1
    np.testing.assert_allclose(mine.mean(axis=(0, 1)), plugin.mean(axis=(0, 1)), rtol=0.03)
    assert np.abs(mine - plugin).mean() < 0.15 * plugin.mean()


def test_rows_that_go_different_ways_conserve_energy():
    image = pixels(aureole.render(aureole.load_dict(scene(Tilted(), spp=8)), seed=1))
    assert np.isfinite(image).all() and 0.1 < image.mean() < 1.05


def test_deltas_that_depend_on_the_wavelength():
    image = pixels(aureole.render(aureole.load_dict(scene(Prism(), spp=8)), seed=1))
    np.testing.assert_allclose(image[..., 1].mean(), 1, rtol=0.05)  # everything passes: the constant light


def test_inside_of_a_plugin():
    inner = {"type": "twosided", "nested": Lambert(0.5)}
    image = pixels(aureole.render(aureole.load_dict(scene(inner, spp=4)), seed=1))
    assert np.isfinite(image).all() and image.mean() > 0.1


class Trouble(Exception):
    pass


def test_exceptions_reach_the_caller():
    class Faulty(Lambert):
        def eval(self, wi, wo, wavelength):
            if self.calls > 20:
                raise Trouble("on purpose")
            return super().eval(wi, wo, wavelength)

    opened = aureole.load_dict(scene(Faulty(), spp=4))
    with pytest.raises(Trouble, match="on purpose") as e:
        aureole.render(opened)
    assert "super().eval" not in str(e.value) and any(entry.name == "eval" for entry in e.traceback)


@pytest.mark.parametrize("method, answer, message", [
    ("eval", lambda n: np.full(n, np.nan), "Broken.eval: values: expected finite"),
    ("eval", lambda n: np.zeros((n, 2)), r"Broken.eval: values: expected the shape \(\d+,\), got"),
    ("eval", lambda n: "no", "Broken.eval: values: expected real numbers"),
    ("eval", lambda n: -np.ones(n), "Broken.eval: values: expected at least 0"),
    ("pdf", lambda n: -np.ones(n), "Broken.pdf: densities: expected at least 0"),
    ("pdf", lambda n: None, "Broken.pdf: densities: expected real numbers"),
    ("sample", lambda n: np.zeros((n, 2)), "Broken.sample: wo: expected real numbers of the shape"),
    ("sample", lambda n: (np.ones((n, 3)), np.ones(n), np.ones(n)), "Broken.sample: wo: expected unit vectors"),
    ("sample", lambda n: (np.tile(UP, (n, 1)), np.ones(n), np.full(n, np.inf)), "Broken.sample: pdf: expected finite"),
    ("sample", lambda n: (np.tile(UP, (n, 1)), np.ones(n), np.zeros(n), np.ones(n, bool)), "Broken.sample: pdf: expected positive"),
    ("sample", lambda n: (np.tile(UP, (n, 1)), np.ones(n), np.ones(n), np.ones(n)), "Broken.sample: valid: expected booleans"),
    ("sample", lambda n: (1, 2), "Broken.sample: expected wo"),
])
def test_wrong_answers(method, answer, message):
    class Broken(Lambert):
        pass

    setattr(Broken, method, lambda self, wi, *others: answer(len(wi)))
    with pytest.raises((aureole.Error, TypeError), match=message):
        bsdf = aureole.as_bsdf(Broken())
        bsdf.sample(UP, 500, (0.1, 0.2, 0.3)) if method == "sample" else getattr(bsdf, method)(UP, UP, 500)
    with pytest.raises((aureole.Error, TypeError), match=message):
        aureole.render(aureole.load_dict(scene(Broken(), spp=1)))


def test_no_directions():
    class Black(Lambert):
        def sample(self, wi, wavelength, u):
            return None

    s = aureole.as_bsdf(Black()).sample([UP, UP], 500, (0, 0, 0))
    assert not s.valid.any() and not s.weight.any()
    assert np.isfinite(pixels(aureole.render(aureole.load_dict(scene(Black(), spp=1))))).all()


@pytest.mark.parametrize("instance, error, message", [
    (object(), TypeError, "object: a BSDF needs the methods"),
    (Lambert, TypeError, "the class itself"),
    (type("Odd", (Lambert,), {"lobes": ("shiny",)})(), aureole.Error, "Odd.lobes: 'shiny' is not one of"),
    (type("Odd", (Lambert,), {"lobes": ("diffuse",)})(), aureole.Error, "Odd.lobes: expected"),
])
def test_what_is_no_bsdf(instance, error, message):
    with pytest.raises(error, match=message):
        aureole.as_bsdf(instance)


def test_nothing_stays():
    mine = Lambert()
    gone = weakref.ref(mine)
    opened = aureole.load_dict(scene(mine, spp=1))
    aureole.render(opened)
    del mine, opened
    gc.collect()
    assert gone() is None


def test_end_of_the_program_is_clean():
    """Objects of the main module, which are part of a cycle through C++, do not crash the end of the interpreter."""
    program = textwrap.dedent("""
        import numpy as np, aureole
        class Mine(aureole.PythonBsdf):
            def eval(self, wi, wo, wavelength):
                return wo[:, 2] * 0
        bsdf = aureole.as_bsdf(Mine())
        scene = aureole.load_dict({"type": "scene", "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 2, "height": 2}},
                                   "s": {"type": "rectangle", "bsdf": Mine()}})
        aureole.render(scene)
    """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
