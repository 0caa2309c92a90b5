# SPDX-License-Identifier: Apache-2.0
"""Diffraction by edges in aureole.optics, against numpy and closed forms."""
import doctest
import math

import numpy as np
import pytest

import aureole
from aureole import _diffraction, _edge_waves, optics

SQUARE = [(-5, -5), (5, -5), (5, 5), (-5, 5)]
K = 2 * math.pi


def square_transform(q):
    return 100 * np.sinc(5 * q[..., 0] / np.pi) * np.sinc(5 * q[..., 1] / np.pi)


def test_edge_waves_of_a_square():
    q = np.random.default_rng(1).normal(size=(3, 20, 2))
    waves = optics.EdgeWaves.polygon(SQUARE, zeroth_order="none")
    field = waves.field(q)
    assert field.shape == (3, 20)
    assert np.abs(field - square_transform(q)).max() < 1e-11
    removed = optics.EdgeWaves.polygon(SQUARE, zeroth_order="beam", sigma=0.1)
    chi = np.exp(-(q ** 2).sum(-1) / 0.02)
    assert np.allclose(removed.intensity(q, K), (1 - chi) * np.abs(field) ** 2)


def test_power_and_samples():
    waves = optics.EdgeWaves.polygon(SQUARE, sigma=0.1)
    power = waves.power()
    assert power == pytest.approx(waves.power(2 * K), rel=0.02)
    assert waves.quality() == pytest.approx(power / waves.powers().sum())
    q = waves.sample(20000, seed=3)
    assert np.array_equal(q, waves.sample(20000, seed=3))
    values = waves.intensity(q) / waves.pdf(q)
    assert values.mean() == pytest.approx(power, abs=4 * values.std() / math.sqrt(len(q)))
    cut = waves.balanced()
    assert abs(math.log(power / cut.powers().sum())) <= abs(math.log(waves.quality()))
    edge = optics.EdgeWaves([[(0, 0), (1, 0)]], [[1, 1j]], zeroth_order="edge")
    constants = optics.edge_constants(math.sqrt(3))
    assert edge.powers()[0] == pytest.approx(2 * constants.alpha1 + 0.5 * constants.alpha2)


def test_triangles_and_beams():
    q = np.random.default_rng(2).normal(size=(7, 2))
    halves = [[(-5, -5), (5, -5), (5, 5)], [(-5, -5), (5, 5), (-5, 5)]]
    assert np.abs(optics.triangle_transform(halves, np.ones((2, 3)), q) - square_transform(q)).max() < 1e-11
    assert optics.gaussian_beam_power(SQUARE, 5) == pytest.approx(math.erf(1 / math.sqrt(2)) ** 2)


def test_mean_edge_kernel_is_kellers_far_from_the_beam():
    sigma, theta = 25.0, 0.2
    qy = np.linspace(-0.2, 0.2, 401)
    k = np.array([optics.mean_edge_kernel([[(0, -800), (0, 800)]], 0, 0.5, (K * theta, y), K, sigma) for y in qy])
    assert k.sum() * (qy[1] - qy[0]) / K == pytest.approx(1 / (2 * math.pi * theta) ** 2, rel=2e-3)


def test_uniform_theory_and_knife_edge():
    # A long way behind an absorbing half plane: Fresnel's approximation.
    theta = np.array([-0.02, 0.01, 0.03])
    field = optics.utd_field(1.5 * math.pi + theta, math.pi / 2, K, 2000, faces=(0, 0))
    v = -2 * np.sqrt(4000) * np.sin(theta / 2)
    assert np.abs(field) == pytest.approx(np.abs(optics.knife_edge(v)), rel=2e-3)
    assert optics.fresnel_integral(1e6) == pytest.approx(0.5 + 0.5j, abs=1e-6)
    assert optics.transition_function(0.5) == pytest.approx(0.6768 - 0.2682j, abs=1e-4)
    assert optics.utd_field(0.0, 1.0, K, 3.0) == pytest.approx(0, abs=1e-12)  # on soft metal


def test_integrals_on_the_axis():
    z = np.array([3.0, 20.0])
    rim = np.hypot(4, z)
    points = np.stack([0 * z, 0 * z, z], axis=-1)
    exact = np.exp(1j * K * z) - z / rim * np.exp(1j * K * rim)
    assert np.abs(optics.rayleigh_sommerfeld(points, K, radius=4) - exact).max() < 1e-9
    assert np.abs(optics.kirchhoff(points, K, radius=4) - np.exp(1j * K * z) + 0.5 * (1 + z / rim) * np.exp(1j * K * rim)).max() < 1e-9
    q = np.array([[0.3, 0.2], [2, -1]])
    assert np.abs(optics.fraunhofer(q, polygons=[SQUARE]) - square_transform(q)).max() < 1e-9


def test_radio_materials():
    table = optics.radio_materials()
    assert len(table["glass"]) == 2 and table["concrete"][0].max_frequency == 100e9
    assert optics.radio_permittivity("brick", [1e9, 10e9]).real == pytest.approx([3.91, 3.91])


@pytest.mark.parametrize("call, message", [
    (lambda: optics.EdgeWaves.polygon(SQUARE), "sigma: expected a standard deviation"),
    (lambda: optics.EdgeWaves([[(0, 0), (0, 0)]], sigma=1), "edges: expected positive lengths"),
    (lambda: optics.EdgeWaves.polygon(SQUARE, zeroth_order="none").pdf([1, 1]), "zeroth_order: .*not finite"),
    (lambda: optics.EdgeWaves.polygon(SQUARE, zeroth_order="edge").power(), "q_max: expected a limit"),
    (lambda: optics.EdgeWaves.polygon(SQUARE, sigma=1).power(1e9), "q_max: expected less work"),
    (lambda: optics.utd_coefficient(7, 1, K, 5), "utd_coefficient: angle of the observer"),
    (lambda: optics.utd_coefficient(1, 1, K, 5, n=3), "n: angle outside a wedge"),
    (lambda: optics.rayleigh_sommerfeld([0, 0, -1], K, radius=1), "points: point behind a screen"),
    (lambda: optics.rayleigh_sommerfeld([0, 0, 1], K), "radius or polygons"),
    (lambda: optics.rayleigh_sommerfeld([0, 0, 1], K, radius=1, source=(0, 0, 1)), "source: point source: expected z < 0"),
    (lambda: optics.rayleigh_sommerfeld([0, 0, 1], 1e9, radius=1), "opening: expected less work"),
    (lambda: optics.radio_permittivity("brick", 60e9), "known for 1 to 40 GHz"),
    (lambda: optics.radio_permittivity("cheese", 1e9), "concrete, brick"),
    (lambda: optics.triangle_transform([(0, 0), (1, 0)], [1, 1, 1], [0, 0]), "corners and values"),
    (lambda: optics.mean_edge_kernel([[(0, 0), (1, 0)]], 1, 0.5, (1, 0), K, 1), "index: expected at most 0")])
def test_wrong_arguments(call, message):
    with pytest.raises(aureole.Error, match=message):
        call()


@pytest.mark.parametrize("module", [_edge_waves, _diffraction])
def test_examples(module):
    assert doctest.testmod(module, optionflags=doctest.ELLIPSIS).failed == 0
