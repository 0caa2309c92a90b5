# SPDX-License-Identifier: Apache-2.0
"""Media over arrays: coefficients and asymmetry against closed forms, broadcasting, bad input."""
from __future__ import annotations

import numpy as np
import pytest

import aureole


@pytest.fixture(scope="module")
def fog():
    return aureole.load_dict({"type": "homogeneous", "sigma_t": 2, "albedo": 0.75, "phase": {"type": "hg", "g": 0.6}})


def test_is_a_medium(fog):
    assert isinstance(fog, aureole.Medium) and fog.family == "medium" and fog.is_uniform
    assert isinstance(fog.phase, aureole.Phase)
    assert fog.phase.eval((0, 0, -1), (0, 0, 1), 550) == pytest.approx((1 - 0.36) / (4 * np.pi * 0.4**3), rel=1e-4)


def test_coefficients(fog):
    nm = np.linspace(400, 700, 20).reshape(4, 5)
    c = fog.coefficients(nm)
    assert isinstance(c, aureole.MediumCoefficients) and c.sigma_t.shape == (4, 5)
    np.testing.assert_allclose(c.sigma_t, 2, rtol=1e-5)
    np.testing.assert_allclose(c.sigma_s, 1.5, rtol=1e-5)
    np.testing.assert_allclose(c.sigma_a, 0.5, rtol=1e-5)
    np.testing.assert_allclose(c.albedo, 0.75, rtol=1e-5)
    assert not c.emission.any()
    np.testing.assert_allclose(fog.asymmetry(nm), 0.6, rtol=1e-3)
    assert np.shape(fog.asymmetry(550)) == () and np.shape(fog.coefficients(550).sigma_a) == ()


def test_direction_of_flakes():
    """Flakes across z show light along z their whole area (Heitz et al. 2015)."""
    flakes = aureole.load_dict({"type": "homogeneous", "sigma_t": 1, "albedo": 1,
                                "phase": {"type": "sggx", "S": "0.01, 0.01, 1, 0, 0, 0"}})
    d = np.array([[0, 0, 1], [1, 0, 0]])
    assert flakes.coefficients([[450], [600]], d=d).sigma_t.shape == (2, 2)
    np.testing.assert_allclose(flakes.coefficients(550, d=d).sigma_t, [1, 0.1], rtol=1e-3)


def test_beer():
    """An absorbance of 1 per cm."""
    ink = aureole.load_dict({"type": "solution", "solvent": "vacuum", "ingredient": {"type": "dye", "absorbance_1cm": 1}})
    c = ink.coefficients(np.arange(400, 701, 100))
    np.testing.assert_allclose(np.exp(-0.01 * c.sigma_a), 0.1, rtol=1e-4)
    assert not c.sigma_s.any() and ink.asymmetry(500) == 0


def test_bad_input(fog):
    with pytest.raises(aureole.Error, match="wavelength"):
        fog.coefficients([550, 2000])
    with pytest.raises(aureole.Error, match="wavelength"):
        fog.asymmetry([550, 2000])
    with pytest.raises(aureole.Error, match="d"):
        fog.coefficients(550, d=(0, 0, 2))
    with pytest.raises(aureole.Error, match="p"):
        fog.coefficients(550, p=(0, np.nan, 0))
    with pytest.raises(aureole.Error, match="more particles than fit"):
        aureole.load_dict({"type": "suspension", "ingredient": {"type": "spheres", "radius": "1um", "int_ior": 1.5,
                                                                  "volume_fraction": 0.9}})


def test_loading_long_tables_can_be_interrupted():
    """Ctrl-C in a table of minutes: the exception of the signal's handler comes out soon."""
    import signal
    import time

    def ring(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, 0.5)
    start = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            aureole.load_dict({"type": "mie", "radius": "250um", "distribution": "gamma"})
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - start < 30
