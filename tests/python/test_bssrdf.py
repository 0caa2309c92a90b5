# SPDX-License-Identifier: Apache-2.0
"""BSSRDFs over arrays: profiles against a closed form, samples against profiles, broadcasting, bad input."""
from __future__ import annotations

import numpy as np
import pytest

import aureole

MATTER = {"sigma_a": 50, "sigma_s": 950, "int_ior": 1, "ext_ior": 1}
R = np.geomspace(1e-7, 1, 40001)


def integral(values):
    """Over the plane."""
    f = values * 2 * np.pi * R
    return float(((f[1:] + f[:-1]) / 2 * np.diff(R)).sum())


@pytest.fixture(scope="module", params=["dipole", "normalized_diffusion"])
def bssrdf(request):
    return aureole.load_dict({"type": request.param, **MATTER})


def test_is_a_bssrdf(bssrdf):
    assert isinstance(bssrdf, aureole.Bssrdf) and bssrdf.family == "bssrdf"
    assert isinstance(bssrdf.boundary, aureole.Bsdf)


def test_dipole_of_equal_indices():
    """Total diffuse reflectance of Jensen, Marschner, Levoy & Hanrahan 2001 (A = 1), and the profile itself."""
    dipole = aureole.load_dict({"type": "dipole", **MATTER})
    albedo = 0.95
    root = np.sqrt(3 * (1 - albedo))
    assert integral(dipole.eval(R, 550)) == pytest.approx(
        albedo / 2 * np.exp(-root) * (1 + np.exp(-4 / 3 * root)), rel=1e-3)
    r, extinction = 0.002, 1000.0
    effective = np.sqrt(3 * 50 * extinction)
    terms = [z * (1 + effective * d) * np.exp(-effective * d) / d**3
             for z in (1 / extinction, (1 + 4 / 3) / extinction) for d in [np.hypot(r, z)]]
    assert dipole.eval(r, 550) == pytest.approx(albedo / (4 * np.pi) * sum(terms), rel=1e-4)


def test_samples_follow_the_density(bssrdf):
    assert integral(bssrdf.pdf(R, 550)) == pytest.approx(1, abs=2e-3)
    u = (np.arange(200000) + 0.5) / 200000
    drawn = bssrdf.sample(550, u)
    assert drawn.shape == u.shape and (drawn >= 0).all()
    edges = np.array([0, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2])
    found = np.histogram(drawn, edges)[0] / len(u)
    cumulative = np.concatenate([[0], np.cumsum(np.diff(R) * np.pi * (
        (bssrdf.pdf(R, 550) * R)[1:] + (bssrdf.pdf(R, 550) * R)[:-1]))])
    np.testing.assert_allclose(found, np.diff(np.interp(edges, R, cumulative)), atol=2e-3)


def test_arguments_broadcast(bssrdf):
    values = bssrdf.eval([[1e-4], [1e-3], [1e-2]], [450, 650])
    assert values.shape == (3, 2)
    assert values[1, 1] == bssrdf.eval(1e-3, 650) and np.shape(bssrdf.eval(1e-3, 650)) == ()
    assert bssrdf.sample([450, 550], [[0.1], [0.5], [0.9]]).shape == (3, 2)


def test_bad_input(bssrdf):
    for distance in (-1, np.nan, np.inf):
        with pytest.raises(aureole.Error, match="distance"):
            bssrdf.eval([1e-3, distance], 550)
    with pytest.raises(aureole.Error, match="wavelength"):
        bssrdf.pdf(1e-3, [550, 2000])
    with pytest.raises(aureole.Error, match="u: expected numbers"):
        bssrdf.sample(550, 1)
    with pytest.raises((aureole.Error, TypeError)):
        bssrdf.sample(550, None)
