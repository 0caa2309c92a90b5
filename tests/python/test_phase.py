# SPDX-License-Identifier: Apache-2.0
"""Phase functions over arrays: values against closed forms, samples, broadcasting, bad input."""
from __future__ import annotations

import numpy as np
import pytest

import aureole

FLAKES = {"type": "sggx", "S": "0.5, 0.9, 0.2, 0.1, -0.15, 0.05"}
PHASES = {"isotropic": {"type": "isotropic"}, "hg": {"type": "hg", "g": 0.7}, "rayleigh": {"type": "rayleigh"},
          "table": {"type": "tabphase", "values": "0.5, 0.2, 1, 0.7, 3"}, "flakes": FLAKES,
          "mie": {"type": "mie", "radius": "1um", "size_spread": 0.2}}


def directions(random, *shape):
    z = random.uniform(-1, 1, shape)
    phi = random.uniform(0, 2 * np.pi, shape)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


@pytest.fixture
def random():
    return np.random.default_rng(3)


@pytest.fixture(scope="module", params=PHASES)
def phase(request):
    return aureole.load_dict(PHASES[request.param])


def test_is_a_phase(phase):
    assert isinstance(phase, aureole.Phase)
    assert phase.family == "phase"


def test_integrates_to_one(phase, random):
    """Value over density of samples is 1 each, and so is the integral by the midpoint rule."""
    mu = (np.arange(20000) + 0.5) / 10000 - 1
    sine = np.sqrt(1 - mu * mu)
    azimuths = (np.arange(32) + 0.5)[:, None] / 32 * 2 * np.pi
    wo = np.stack(np.broadcast_arrays(sine * np.cos(azimuths), sine * np.sin(azimuths), mu), axis=-1)
    np.testing.assert_allclose(phase.eval((0, 0, -1), wo, 550).mean() * 4 * np.pi, 1, rtol=2e-3)


def test_samples(phase, random):
    wi, nm = directions(random, 500), random.uniform(400, 700, 500)
    s = phase.sample(wi, nm, random.uniform(0, 1, (500, 3)))
    assert isinstance(s, aureole.PhaseSample) and s.valid.all()
    np.testing.assert_allclose(np.linalg.norm(s.wo, axis=-1), 1, atol=1e-6)
    np.testing.assert_allclose(s.value, phase.eval(wi, s.wo, nm), rtol=1e-3)
    np.testing.assert_allclose(s.pdf, phase.pdf(wi, s.wo, nm), rtol=1e-3)


def test_henyey_greenstein(random):
    g, phase = 0.7, aureole.load_dict(PHASES["hg"])
    wi, wo = directions(random, 100), directions(random, 100)
    mu = -(wi * wo).sum(-1)
    expected = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)
    np.testing.assert_allclose(phase.eval(wi, wo, 550), expected, rtol=1e-5)


def test_shapes_broadcast(phase, random):
    wi, wo, nm = directions(random, 4, 1), directions(random, 3), np.array([400.0, 500, 600])
    assert phase.eval(wi, wo, 550).shape == (4, 3)
    assert phase.eval(wi[:, :, None], wo[:, None], nm).shape == (4, 3, 3)
    assert phase.eval(wi[0, 0], wo[0], 550).shape == ()
    np.testing.assert_array_equal(phase.eval(wi, wo, nm)[2], phase.eval(wi[2, 0], wo, nm))
    assert phase.sample(wi, nm, (0.5, 0.2, 0.3)).wo.shape == (4, 3, 3)


def test_projected_area(random):
    d = directions(random, 50)
    s = np.array([[0.5, 0.1, -0.15], [0.1, 0.9, 0.05], [-0.15, 0.05, 0.2]])
    expected = np.sqrt(np.einsum("ni,ij,nj->n", d, s, d))
    np.testing.assert_allclose(aureole.load_dict(FLAKES).projected_area(d), expected, rtol=1e-5)
    assert (aureole.load_dict({"type": "hg"}).projected_area(d) == 1).all()


@pytest.mark.parametrize("call, text", [
    (lambda p: p.eval((0, 0, 2), (0, 0, 1), 550), "wi: expected unit vectors"),
    (lambda p: p.eval((0, 0, 1), (0, 1), 550), "wo"),
    (lambda p: p.eval((0, 0, 1), (0, 0, 1), 200), "wavelength: expected 360 to 830"),
    (lambda p: p.eval((0, 0, 1), (0, 0, 1), 550, p=(0, 0, float("nan"))), "p: expected three finite"),
    (lambda p: p.sample((0, 0, 1), 550, (0, 1, 0)), "u: expected numbers in"),
    (lambda p: p.projected_area((0, 0, 0)), "d: expected unit vectors"),
])
def test_bad_input(call, text):
    with pytest.raises(aureole.Error, match=text):
        call(aureole.load_dict({"type": "hg"}))
