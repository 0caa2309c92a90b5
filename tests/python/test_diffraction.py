# SPDX-License-Identifier: Apache-2.0
"""Diffraction by edges in aureole.optics, against numpy and closed forms."""
import doctest
import math

import numpy as np
import pytest

import aureole
from aureole import _diffraction, _edge_kernels, _edge_waves, optics

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


def test_moments_and_the_light_straight_ahead():
    corners, values = np.array([(0.1, -0.2), (0.9, 0.3), (0.2, 0.8)]), np.array([1.0, 2 - 0.5j, 0.3j])
    m = optics.amplitude_moments(corners, values)
    h = 1e-4
    q = np.array([(0, 0), (h, 0), (-h, 0), (0, h), (0, -h)])
    field = optics.triangle_transform(corners, values, q)
    assert m.total == pytest.approx(field[0])
    assert (m.x, m.y) == (pytest.approx(1j * (field[1] - field[2]) / (2 * h), rel=1e-6), pytest.approx(1j * (field[3] - field[4]) / (2 * h), rel=1e-6))
    assert m.xx == pytest.approx(-(field[1] - 2 * field[0] + field[2]) / h ** 2, rel=1e-5)
    # The power straight on and the power by Parseval, of an amplitude that is 1 in a square.
    halves, even = [[(-5, -5), (5, -5), (5, 5)], [(-5, -5), (5, 5), (-5, 5)]], np.ones((2, 3))
    assert optics.triangle_power(halves, even) == pytest.approx(100)
    assert optics.amplitude_moments(halves, even).xx == pytest.approx(10 * 250 / 3)
    sigma = 0.1
    assert optics.zeroth_order_power(halves, even, sigma) == pytest.approx(100 ** 2 / (2 * math.pi) / (2 * 25 / 3 + 1 / sigma ** 2))


def test_waves_and_powers_by_name():
    along, across = np.array([-7.0, 0.02, 0.3, 2.0]), np.array([[0.2], [-3.0]])
    h = 0.5 * along
    factor = across / (2 * math.pi * (along ** 2 + across ** 2))
    assert np.allclose(optics.edge_alpha1(along, across), factor * 0.5 * (np.cos(h) - np.sin(h) / h) / h, atol=1e-12)
    assert np.allclose(optics.edge_alpha2(along, across), factor * np.sin(h) / h)
    edges = [[(0, 0), (10, 0)], [(10, 0), (10, 10)], [(10, 10), (0, 10)], [(0, 10), (0, 0)]]
    waves = optics.EdgeWaves(edges, sigma=0.1)
    assert optics.interfering_power(edges, sigma=0.1, nodes=8) == waves.power()
    assert optics.interfering_power(edges, sigma=0.1, nodes=2) == pytest.approx(waves.power(), rel=0.01)
    assert optics.mean_edge_sigma(edges) == pytest.approx(math.sqrt(3) / 10)
    q = np.random.default_rng(3).normal(size=(4, 2))
    field = optics.EdgeWaves(edges, zeroth_order="none").field(q)
    assert np.allclose(optics.diffracted_intensity(field, q, K, 0.1), waves.intensity(q, K))
    assert np.allclose(optics.diffracted_intensity(field, q, K), (K / (2 * math.pi)) ** 2 * np.abs(field) ** 2)


def test_kernels_of_a_straight_edge():
    sigma, theta = 25.0, 4 / (2 * K * 25.0)
    y = np.linspace(-0.03, 0.03, 2001)
    k = optics.straight_edge_kernels(theta, y, K, sigma)
    assert k.shape == y.shape and k.sum() * (y[1] - y[0]) == pytest.approx(1 / (2 * math.pi * theta) ** 2, rel=0.01)
    edge = [[(0, -400), (0, 400)]]
    power = optics.mean_edge_powers(edge, 0, [0.5, 0.4], K, sigma)
    assert power == pytest.approx(np.full(2, sigma * (math.asinh(1) + math.sqrt(2) - 1) / math.sqrt(2 * math.pi)), rel=1e-3)
    # Light at an angle to the edge: less of it is seen, and some directions are missing.
    assert optics.mean_edge_powers(edge, 0, 0.5, K, sigma, lengths=[1000]) == pytest.approx(0.8 * power[0] - 0.6 / (4 * K), rel=1e-3)
    assert optics.straight_edge_power(0.6, K, sigma) == pytest.approx(0.8 * optics.straight_edge_power(0.0, K, sigma) - 0.6 / (4 * K))
    more = optics.straight_edge_corrections(theta, y, K, sigma, weight=0.5)
    for i in range(0, y.size, 100):
        mean = optics.mean_edge_kernel(edge, 0, 0.5, (K * theta, K * y[i]), K, sigma)
        assert more[i] == pytest.approx(0.5 * (k[i] - mean), abs=1e-4 * k.max())
    assert optics.straight_edge_power_correction(0.6, sigma) == pytest.approx(
        0.8 * (optics.straight_edge_power(0.0, K, sigma) - power[0]), abs=2e-4 * sigma)
    assert optics.straight_edge_weights((0, 0), [50 * sigma, 0], 50 * sigma, [], sigma) == pytest.approx([1, 0.5])
    assert optics.straight_edge_weights((0, 0), 50 * sigma, 50 * sigma, [[(50 * sigma, 1e-7), (-50 * sigma, 1e-7)]], sigma) == pytest.approx(0, abs=1e-6)


def test_the_mean_of_drawn_kernels_is_the_mean_kernel():
    sigma, turn = 2.0, 0.3
    edges = np.array([[(0, 0), (2, 0.5)], [(2, 0.5), (1, 2)], [(1, 2), (0, 0)]])
    lengths = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    normal = np.random.default_rng(4).normal(size=(20000, 2))
    drawn = sum(length * optics.drawn_edge_kernels(edges, i, normal, turn, K, sigma) for i, length in enumerate(lengths))
    at = (np.arange(64) + 0.5) / 64
    mean = sum(length * optics.mean_edge_kernel(edges, i, at, (K * turn, 0), K, sigma).mean() for i, length in enumerate(lengths))
    assert drawn.min() >= 0 and drawn.mean() == pytest.approx(mean, abs=4 * drawn.std() / math.sqrt(drawn.size))


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


def test_keller_and_spreadings():
    phi, phi_i = np.array([0.3, 1.0, 3.9]), 0.8
    for n in (1.5, 2.0):
        for polarisation in ("soft", "hard"):
            keller = optics.keller_coefficient(phi, phi_i, K, n=n, polarisation=polarisation)
            uniform = optics.utd_coefficient(phi, phi_i, K, 1e7, n=n, polarisation=polarisation)
            assert np.abs(keller / uniform - 1).max() < 1e-5
    s = np.array([2.0, 30.0])
    assert optics.point_source_distance(5.0, s, 0.5) == pytest.approx(5 * s / (5 + s) / 4)
    assert optics.plane_wave_distance(s, 0.5) == pytest.approx(s / 4)
    assert optics.point_source_spreading(5.0, s) == pytest.approx(np.sqrt(5 / (s * (5 + s))))
    assert optics.point_source_spreading(1e12, s) == pytest.approx(optics.plane_wave_spreading(s))


def test_faddeeva():
    # Abramowitz & Stegun 1964, table 7.9.
    assert optics.faddeeva(1 + 1j) == pytest.approx(0.304744 + 0.208219j, abs=1e-6)
    x = np.linspace(-3, 3, 13)
    assert optics.faddeeva(x).real == pytest.approx(np.exp(-x ** 2))
    assert optics.faddeeva(1j * np.array([0.1, 2])).real == pytest.approx([math.exp(y * y) * math.erfc(y) for y in (0.1, 2)])


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
    (lambda: optics.edge_alpha1(0, 0), "along and across: expected finite waves"),
    (lambda: optics.zeroth_order_power([(0, 0), (1, 0), (0, 1)], [1, -1, 0], 1), "values: power of the 0th order"),
    (lambda: optics.interfering_power([[(0, 0), (1, 0)]], sigma=1, nodes=3), "nodes: expected 2, 4 or 8"),
    (lambda: optics.mean_edge_powers([[(0, 0), (1, 0)]], 0, 0.5, K, 1, lengths=[0.5]), "lengths: expected none below"),
    (lambda: optics.drawn_edge_kernels([[(0, 0), (1e9, 1)]], 0, (0, 0), 1, K, 1), "edges: expected phases below"),
    (lambda: optics.keller_coefficient(7, 1, K), "phi: expected at most"),
    (lambda: optics.keller_coefficient(1, 1, K, n=3), "n: angle outside a wedge"),
    (lambda: optics.mean_edge_kernel([[(0, 0), (1, 0)]], 1, 0.5, (1, 0), K, 1), "index: expected at most 0")])
def test_wrong_arguments(call, message):
    with pytest.raises(aureole.Error, match=message):
        call()


@pytest.mark.parametrize("module", [_edge_waves, _edge_kernels, _diffraction])
def test_examples(module):
    assert doctest.testmod(module, optionflags=doctest.ELLIPSIS).failed == 0
