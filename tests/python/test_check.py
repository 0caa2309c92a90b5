# SPDX-License-Identifier: Apache-2.0
"""`aureole.check`: right BSDFs pass, wrong ones fail where they are wrong."""
from __future__ import annotations

import functools
import os
import signal
import threading

import numpy as np
import pytest

import aureole
from aureole import PythonBsdf
from aureole._plot_check import pools

FAST = 20_000


class Lambert(PythonBsdf):
    lobes = ("diffuse", "reflect")
    reflectance = 0.5

    def eval(self, wi, wo, wavelength):
        up = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        return np.where(up, self.reflectance / np.pi * wo[:, 2], 0)

    def pdf(self, wi, wo, wavelength):
        return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), wo[:, 2], 0) / np.pi


class GainsEnergy(Lambert):
    reflectance = 1.2


class WrongDensity(Lambert):
    def pdf(self, wi, wo, wavelength):
        return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), 1 / (2 * np.pi), 0)


class NotReciprocal(Lambert):
    def eval(self, wi, wo, wavelength):
        return super().eval(wi, wo, wavelength) * wi[:, 2]


class NanAtGrazing(Lambert):
    def eval(self, wi, wo, wavelength):
        value = np.asarray(super().eval(wi, wo, wavelength), float)
        return np.where((wo[:, 2] > 0) & (wo[:, 2] < 1e-6), np.nan, value)


class MissesAHemisphere(PythonBsdf):
    """It scatters to both sides, and goes to one of them."""

    lobes = ("diffuse", "reflect", "transmit")

    def eval(self, wi, wo, wavelength):
        return 0.3 / np.pi * np.abs(wo[:, 2])

    def pdf(self, wi, wo, wavelength):
        return np.where(wi[:, 2] * wo[:, 2] > 0, np.abs(wo[:, 2]), 0) / np.pi

    def sample(self, wi, wavelength, u):
        return Lambert.sample(_ReflectOnly(), wi, wavelength, u)


class _ReflectOnly(Lambert):
    pass


class Negative(Lambert):
    def eval(self, wi, wo, wavelength):
        return np.asarray(super().eval(wi, wo, wavelength)) - np.where((wi[:, 2] > 0) & (wo[:, 2] > 0.999), 1.0, 0)


GOOD = {
    "diffuse": {"type": "diffuse"},
    "white": {"type": "diffuse", "reflectance": 1.0},
    "roughconductor": {"type": "roughconductor", "alpha": 0.2},
    "dielectric": {"type": "dielectric"},
    "roughdielectric": {"type": "roughdielectric", "alpha": 0.3},
    "plastic": {"type": "plastic"},
    "twosided": {"type": "twosided", "nested": {"type": "diffuse"}},
    "conductor": {"type": "conductor"},
    "scatterers": {"type": "correlated_scatterers", "radius": "5um", "area_fraction": 0.4},
}


@pytest.mark.parametrize("name", sorted(GOOD))
def test_plugins_pass(name):
    report = aureole.check(aureole.load_dict(GOOD[name]), samples=FAST)
    assert report.passed, str(report)
    assert report.problems == [] and report.failed() == []
    assert report.raise_if_failed() is report
    assert report.name == GOOD[name]["type"]
    kinds = {c.kind for c in report.checks}
    assert {"finite", "sample", "energy", "density_integral", "sample_energy"} <= kinds
    assert ("black" in kinds) == (name in ("diffuse", "white", "roughconductor", "plastic", "conductor"))


def test_albedo_of_a_diffuse_surface():
    report = aureole.check(aureole.load_dict({"type": "diffuse", "reflectance": 0.3}), samples=1000)
    above = report.angles < 90
    assert list(report.angles[above]) == [0, 10, 20, 30, 40, 50, 60, 70, 80, 85]
    assert report.albedo.shape == (len(report.angles), len(report.wavelengths))
    assert np.all(np.diff(report.wavelengths) > 0)
    np.testing.assert_allclose(report.albedo[above], 0.3, atol=1e-5)
    np.testing.assert_array_equal(report.albedo[~above], 0)


def test_lossless():
    white, grey = (aureole.load_dict({"type": "diffuse", "reflectance": r}) for r in (1.0, 0.9))
    assert aureole.check(white, lossless=True, samples=FAST).passed
    assert aureole.check(grey, samples=FAST).passed
    report = aureole.check(grey, lossless=True, samples=FAST)
    assert report.failed() == ["energy"]
    assert report.problems[0].startswith("loses energy: 0.")


def test_histograms():
    report = aureole.check(aureole.load_dict({"type": "twosided", "nested": {"type": "diffuse"}}), samples=FAST)
    assert len(report.histograms) == 12
    for h in report.histograms:
        assert h.found.sum() == FAST
        assert h.expected.sum() == pytest.approx(FAST, rel=1e-4)
        np.testing.assert_allclose(np.linalg.norm(h.centers, axis=1), 1, atol=1e-6)
        # Chi-square over the groups of the plot is the test's own.
        expected, found = pools(h)
        assert len(expected) == h.pools
        assert np.sum((found - expected) ** 2 / expected) == pytest.approx(h.chi_square, rel=1e-3)


def test_pairs_of_two_media():
    """Without the squared indices (1.5046 by default) the pairs would not agree."""
    report = aureole.check(aureole.load_dict({"type": "roughdielectric", "alpha": 0.4}), samples=FAST)
    p = report.pairs
    through = (p["wi"][:, 2] * p["wo"][:, 2] < 0) & (p["forward"] > 1e-3)
    assert through.sum() > 50
    np.testing.assert_allclose(p["forward"][through], p["backward"][through], rtol=2e-3)


def test_index_ratio():
    rough = aureole.load_dict({"type": "roughdielectric", "alpha": 0.4, "int_ior": 1.5, "ext_ior": 1.0})
    assert aureole.check(rough, samples=1000, index_ratio=1.5).passed
    assert "reciprocity" in aureole.check(rough, samples=1000, index_ratio=1.2).failed()
    assert aureole.check(rough, samples=1000, index_ratio=1.2, reciprocal=False).passed


def test_two_sided():
    surface = aureole.load_dict({"type": "diffuse"})
    assert "density_integral" in aureole.check(surface, samples=1000, two_sided=True, may_fail=False).failed()
    assert aureole.check(surface, samples=1000, two_sided=False).passed
    both = aureole.load_dict({"type": "twosided", "nested": {"type": "diffuse"}})
    assert aureole.check(both, samples=1000, two_sided=True).passed
    assert aureole.check(both, samples=1000, two_sided=False).failed() == ["black"]


@functools.lru_cache(maxsize=None)
def report_of(kind, samples=8000):
    """Integrals of a class written in Python take more than a second, whatever the samples: tests share reports."""
    return aureole.check(kind(), samples=samples)


@pytest.mark.parametrize("wrong, kinds", [
    (GainsEnergy, {"energy"}),
    (WrongDensity, {"chi_square", "sample_energy"}),
    (NotReciprocal, {"reciprocity", "modes"}),
    (NanAtGrazing, {"finite"}),
    (MissesAHemisphere, {"sample_energy"}),
    (Negative, {"finite", "modes", "reciprocity"}),
])
def test_wrong_ones_fail_in_the_right_check(wrong, kinds):
    report = report_of(wrong, None if wrong is WrongDensity else 8000)
    assert set(report.failed()) == kinds, str(report)
    assert not report.passed
    assert report.problems
    with pytest.raises(AssertionError, match="FAILED"):
        report.raise_if_failed()


def test_right_one_in_python():
    calls = []

    class Counting(Lambert):
        def eval(self, wi, wo, wavelength):
            calls.append(len(wi))
            return super().eval(wi, wo, wavelength)

    report = aureole.check(Counting(), samples=4000)
    # Python is called for arrays.
    assert sum(calls) > 100_000
    assert len(calls) < 5000
    assert report.passed, str(report)
    assert report.name == "Counting" and "30,000" not in str(report)
    np.testing.assert_allclose(report.albedo[report.angles < 90], 0.5, atol=1e-5)
    wrapped = aureole.check(aureole.as_bsdf(Lambert()), samples=4000)
    assert [c.figure for c in wrapped.checks] == [c.figure for c in report.checks]


def test_exceptions_of_a_class_arrive():
    class Raises(Lambert):
        def eval(self, wi, wo, wavelength):
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        aureole.check(Raises())

    class WrongShape(Lambert):
        def eval(self, wi, wo, wavelength):
            return np.zeros((len(wi), 2))

    with pytest.raises(aureole.Error, match="WrongShape.eval"):
        aureole.check(WrongShape())


def test_noise_ends():
    """Adaptive subdivision of a density without any smoothness ends."""
    class Noise(Lambert):
        def pdf(self, wi, wo, wavelength):
            return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), np.modf(np.abs(np.sin(wo[:, 0] * 1e5) * 1e4))[0], 0)

    assert not aureole.check(Noise(), samples=1000).passed


def test_wavelengths():
    copper = aureole.load_dict({"type": "roughconductor", "alpha": 0.3, "material": "Cu"})
    some = aureole.check(copper, samples=1000, wavelengths=(500, 600))
    assert 500 <= some.wavelengths.min() and some.wavelengths.max() <= 600
    everything = aureole.check(copper, samples=1000, wavelengths=None)
    np.testing.assert_array_equal(everything.wavelengths, aureole.check(copper, samples=1000).wavelengths)
    assert aureole.check(Lambert(), samples=1000, wavelengths=None).passed


def test_seed():
    b = aureole.load_dict({"type": "roughconductor", "alpha": 0.3})
    one, same, other = (aureole.check(b, samples=FAST, seed=s) for s in (1, 1, 2))
    assert str(one) == str(same) != str(other)


def test_fewer_samples_in_python():
    report = report_of(WrongDensity, None)
    assert report.samples == 30_000 and "30,000 samples instead" in str(report)
    assert "p < 1e-300" in str(report)


def test_text():
    report = report_of(GainsEnergy)
    text = str(report)
    assert text.startswith("GainsEnergy: FAILED (energy)")
    assert "gains energy: 1.2" in text and "1.2 (bound 1)" in text
    assert repr(report) == text
    assert max(len(line) for line in text.splitlines() if "problems" not in line) < 200
    page = report._repr_html_()
    assert page.startswith("<div>") and page.endswith("</div>") and "FAILED" in page and "<table>" in page
    assert report.worst("energy").figure == pytest.approx(1.2, abs=1e-4)
    assert report.worst("delta_lobes") is None


def test_progress_and_its_exceptions():
    parts = []
    aureole.check(aureole.load_dict({"type": "diffuse"}), samples=FAST, progress=parts.append)
    assert parts[-1] == 1 and all(b >= a for a, b in zip(parts, parts[1:]))

    def stop(part):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        aureole.check(aureole.load_dict({"type": "diffuse"}), progress=stop)


def test_interrupt():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            aureole.check(aureole.load_dict({"type": "roughdielectric", "alpha": 0.3}), samples=5_000_000)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("arguments, error, message", [
    ({"samples": 10}, aureole.Error, "samples"),
    ({"samples": 1e5}, TypeError, "samples"),
    ({"significance": 0}, aureole.Error, "significance"),
    ({"significance": np.nan}, aureole.Error, "significance"),
    ({"wavelengths": (500,)}, aureole.Error, "wavelengths"),
    ({"wavelengths": (700, 500)}, aureole.Error, "wavelengths"),
    ({"wavelengths": (100, 900)}, aureole.Error, "wavelengths.*360 to 830"),
    ({"wavelengths": "red"}, TypeError, "wavelengths"),
    ({"seed": -1}, aureole.Error, "seed"),
    ({"tolerance": -1}, aureole.Error, "tolerance"),
    ({"largest_energy": 0.5}, aureole.Error, "largest_energy"),
    ({"index_ratio": 0}, aureole.Error, "index_ratio"),
    ({"mode": "light"}, aureole.Error, "mode"),
    ({"progress": 3}, TypeError, "progress"),
    ({"lossless": "yes"}, TypeError, "lossless"),
    ({"two_sided": 2}, TypeError, "two_sided"),
    ({"reciprocal": None}, TypeError, "reciprocal"),
])
def test_wrong_arguments(arguments, error, message):
    with pytest.raises(error, match=message):
        aureole.check(aureole.load_dict({"type": "diffuse"}), **arguments)


@pytest.mark.parametrize("bsdf", [None, 3, "diffuse", Lambert, {"type": "diffuse"}, object()])
def test_what_is_no_bsdf(bsdf):
    with pytest.raises(TypeError, match="bsdf: expected a BSDF"):
        aureole.check(bsdf)
