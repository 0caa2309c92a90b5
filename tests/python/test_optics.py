# SPDX-License-Identifier: Apache-2.0
"""aureole.optics against closed forms, quadrature, published values and code that shares nothing with it."""
import doctest
import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np
import pytest

import aureole
from aureole import _apertures, _correlations, optics

UM = 1e-6
SQUARE = [(-UM, -UM), (UM, -UM), (UM, UM), (-UM, UM)]


def closed_file():
    with open(os.devnull, encoding="utf-8") as file:
        return file


POINTS = np.random.default_rng(5).uniform(0, 10, (50, 2))


def bessel(order, x):
    """J_order by Bessel's integral; the trapezoidal rule converges as soon as it resolves it."""
    x = np.asarray(x, float)
    n = int(x.max() / 2) + 40
    return sum(np.cos(order * t - x * np.sin(t)) for t in (np.arange(n) + 0.5) * np.pi / n) / n


def mie_reference(x, m):
    """a_n, b_n of Bohren & Huffman 4.56, 4.57 with Riccati-Bessel functions by their plain recurrences in long double."""
    count = int(x + 4 * x ** (1 / 3) + 10)

    def psi(z):
        values = np.zeros(count + 60, np.clongdouble)
        values[-2] = 1e-250
        for n in range(count + 58, 0, -1):
            values[n - 1] = (2 * n + 1) / np.clongdouble(z) * values[n] - values[n + 1]
        return values[: count + 1] * (np.sin(np.clongdouble(z)) / values[0])

    chi = [np.cos(np.longdouble(x)), np.cos(np.longdouble(x)) / x + np.sin(np.longdouble(x))]
    for n in range(2, count + 1):
        chi.append((2 * n - 1) / np.longdouble(x) * chi[-1] - chi[-2])
    p, q, xi = psi(x), psi(m * x), psi(x) - 1j * np.array(chi)
    n = np.arange(1, count + 1)
    dp, dq, dxi = (f[:-1] - n * f[1:] / z for f, z in ((p, x), (q, m * x), (xi, x)))
    p, q, xi = p[1:], q[1:], xi[1:]
    return (m * q * dp - p * dq) / (m * q * dxi - xi * dq), (q * dp - m * p * dq) / (q * dxi - m * xi * dq)


class TestMie:
    @pytest.mark.parametrize("x, m, qext, qsca, g", [
        (0.099, 0.75, 7.417859e-6, 7.417859e-6, 0.001448), (10, 0.75, 2.232265, 2.232265, 0.896473),
        (1000, 0.75, 1.997908, 1.997908, 0.844944), (100, 1.33 + 1e-5j, 2.101321, 2.096594, 0.868959),
        (1e4, 1.33 + 1e-5j, 2.004089, 1.723857, 0.907840), (1, 1.5 + 1j, 2.336321, 0.6634538, 0.192136),
        (1e4, 10 + 10j, 2.005914, 1.795393, 0.548194)])
    def test_published_values(self, x, m, qext, qsca, g):
        """Wiscombe's MIEV0 cases and Du (2004), which other codes quote."""
        result = optics.mie(x, m)
        assert result.qext == pytest.approx(qext, rel=4e-7)
        assert result.qsca == pytest.approx(qsca, rel=4e-7)
        assert result.qabs == pytest.approx(qext - qsca, abs=3e-6)
        assert result.g == pytest.approx(g, abs=6e-7)

    @pytest.mark.parametrize("x, m", [(0.3, 1.5), (5.0, 1.33 + 0.1j), (12.0, 0.2 + 3.4j), (20.0, 2.0)])
    def test_against_plain_recurrences(self, x, m):
        a, b = mie_reference(x, m)
        n = np.arange(1, len(a) + 1)
        result = optics.mie(x, m)
        assert result.qext == pytest.approx(float(2 / x**2 * ((2 * n + 1) * (a + b).real).sum()), rel=1e-12)
        assert result.qsca == pytest.approx(float(2 / x**2 * ((2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)).sum()), rel=1e-12)
        back = ((2 * n + 1) * (-1.0) ** n * (a - b)).sum()
        assert result.qback == pytest.approx(float(abs(back) ** 2 / x**2), rel=1e-10)
        # Amplitudes, by derivatives of Legendre polynomials.
        mu = np.array([-0.9, -0.2, 0.0, 0.5, 0.99])
        pi, tau = np.zeros((2, len(n), len(mu)))
        for k in n:
            legendre = np.polynomial.legendre.Legendre.basis(k)
            pi[k - 1], tau[k - 1] = legendre.deriv()(mu), mu * legendre.deriv()(mu) - (1 - mu**2) * legendre.deriv(2)(mu)
        w = ((2 * n + 1) / (n * (n + 1)))[:, None]
        s1, s2 = optics.mie_amplitudes(x, m, mu)
        np.testing.assert_allclose(s1, (w * (a[:, None] * pi + b[:, None] * tau)).sum(axis=0).astype(complex), rtol=1e-9)
        np.testing.assert_allclose(s2, (w * (a[:, None] * tau + b[:, None] * pi)).sum(axis=0).astype(complex), rtol=1e-9)

    def test_relations(self):
        x, m = np.array([0.5, 3.0, 30.0])[:, None], np.array([1.33, 1.5 + 0.1j])
        result = optics.mie(x, m)
        mu, weight = np.polynomial.legendre.leggauss(400)
        phase = optics.mie_phase_function(x, m, mu)
        assert phase.shape == (3, 2, 400)
        np.testing.assert_allclose(2 * np.pi * phase @ weight, 1, rtol=1e-9)
        np.testing.assert_allclose(2 * np.pi * (phase * mu) @ weight, result.g, rtol=1e-9)
        s1, s2 = optics.mie_amplitudes(x, m, [-1.0, 1.0])
        np.testing.assert_allclose(4 / x**2 * s1[..., 1].real, result.qext, rtol=1e-12)  # optical theorem
        np.testing.assert_allclose(4 / x**2 * abs(s1[..., 0]) ** 2, result.qback, rtol=1e-9)
        np.testing.assert_allclose(s2[..., 1], s1[..., 1], rtol=1e-12)
        np.testing.assert_allclose((abs(s1[..., 1]) ** 2) / (np.pi * x**2 * result.qsca), optics.mie_phase_function(x, m, 1.0))
        assert np.all(result.qabs[:, 0] <= 1e-12) and np.all(result.qabs[:, 1] > 0)

    def test_rayleigh(self):
        x, m = 1e-3, 1.5 + 0.2j
        k = (m**2 - 1) / (m**2 + 2)
        assert optics.mie(x, m).qsca == pytest.approx(8 / 3 * x**4 * abs(k) ** 2, rel=1e-5)
        assert optics.mie(x, m).qabs == pytest.approx(4 * x * k.imag, rel=1e-5)

    def test_blocks_of_angles(self):
        """More angles and spheres than one block; results do not depend on their company."""
        mu, x = np.linspace(-1, 1, 1001), np.linspace(1, 400, 300)
        s1, _ = optics.mie_amplitudes(x, 1.4, mu)
        for i, j in ((0, 0), (150, 500), (299, 1000)):
            assert s1[i, j] == optics.mie_amplitudes(x[i], 1.4, mu[j])[0]

    def test_sign_of_absorption(self):
        with pytest.raises(aureole.Error, match=r"^m: expected n \+ i k with k >= 0.*1.5-0.1j"):
            optics.mie(1, 1.5 - 0.1j)

    @pytest.mark.parametrize("x, m, name", [(0, 1.5, "x"), (1e5 + 1, 1.5, "x"), (-1, 1.5, "x"), (1, 0, "m"), (1, -1.5, "m"),
                                            (1, 101, "m"), (1, 1j, "m"), (1, 1e-300, "m")])
    def test_limits(self, x, m, name):
        for function in (optics.mie, lambda x, m: optics.mie_amplitudes(x, m, 0)):
            with pytest.raises(aureole.Error, match=f"^{name}: expected"):
                function(x, m)

    def test_no_scatterer(self):
        assert 0 <= optics.mie(1, 1).qext < 1e-30
        with pytest.raises(aureole.Error, match="^m: "):
            optics.mie_phase_function(1, [1.5, 1], 0)


class TestFresnel:
    def test_normal_incidence(self):
        f = optics.fresnel(1, 1.5)
        assert f.reflectance == pytest.approx(0.04, rel=1e-14) and f.transmittance == pytest.approx(0.96, rel=1e-14)
        assert f.rs == pytest.approx(-0.2) and f.rp == pytest.approx(0.2) and f.ts == pytest.approx(0.8) == f.tp
        n, k = 0.2, 3.4
        assert optics.fresnel(1, n + k * 1j).reflectance == pytest.approx(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2))

    def test_textbook_angles(self):
        """Fresnel's sine and tangent formulas."""
        i, eta = np.radians(np.arange(5, 90, 5)), np.array([[1.2], [1.5], [2.4]])
        t = np.arcsin(np.sin(i) / eta)
        f = optics.fresnel(np.cos(i), eta)
        np.testing.assert_allclose(f.rs, -np.sin(i - t) / np.sin(i + t), rtol=1e-11)
        np.testing.assert_allclose(f.rp, np.tan(i - t) / np.tan(i + t), rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(f.ts, 2 * np.sin(t) * np.cos(i) / np.sin(i + t), rtol=1e-11)
        np.testing.assert_allclose(f.tp, 2 * np.sin(t) * np.cos(i) / (np.sin(i + t) * np.cos(i - t)), rtol=1e-11)
        np.testing.assert_allclose(f.cos_t, np.cos(t), rtol=1e-12)

    def test_brewster(self):
        eta = np.array([0.5, 1.33, 2.4])
        f = optics.fresnel(np.cos(np.arctan(eta)), eta)
        np.testing.assert_allclose(f.rp, 0, atol=1e-15)

    def test_total_reflection(self):
        critical = np.sqrt(1 - (1 / 1.5) ** 2)
        f = optics.fresnel(np.linspace(0.01, critical - 1e-6, 50), 1 / 1.5)
        np.testing.assert_allclose(abs(f.rs), 1, rtol=1e-12)
        np.testing.assert_allclose(f.reflectance, 1, rtol=1e-12)
        np.testing.assert_allclose(f.transmittance, 0, atol=1e-12)
        # Phases, Born & Wolf 1.5.4 equation 60: tan(delta_s/2) = -sqrt(sin^2 - n^2)/cos for exp(-i omega t).
        c, n = 0.5, 1 / 1.5
        assert np.angle(optics.fresnel(c, n).rs) == pytest.approx(-2 * np.arctan(np.sqrt(1 - c**2 - n**2) / c))

    def test_energy(self):
        rng = np.random.default_rng(1)
        cosine, eta = rng.uniform(0, 1, 500), rng.uniform(0.1, 4, 500) + 1j * rng.uniform(0, 4, 500) * (rng.random(500) < 0.5)
        f = optics.fresnel(cosine, eta)
        np.testing.assert_allclose(f.reflectance + f.transmittance, 1, rtol=1e-10)
        np.testing.assert_allclose(f.reflectance, 0.5 * (abs(f.rs) ** 2 + abs(f.rp) ** 2), rtol=1e-12)

    def test_ends(self):
        f = optics.fresnel([0, 0, 0, 1 + 1e-7], [1.5, 1, 0.2 + 3j, 1.5])
        np.testing.assert_allclose(f.reflectance, [1, 0, 1, 0.04])
        np.testing.assert_allclose(f.transmittance, [0, 1, 0, 0.96])

    def test_diffuse(self):
        mu, w = np.polynomial.legendre.leggauss(400)
        mu, w = (mu + 1) / 2, w / 2
        expected = (2 * mu * optics.fresnel(mu, 1.5).reflectance * w).sum()
        assert optics.fresnel_diffuse_reflectance(1.5) == pytest.approx(expected, abs=1e-7)

    @pytest.mark.parametrize("cosine, eta, name", [(1.1, 1.5, "cos_theta"), (-0.5, 1.5, "cos_theta"), (1, -1.5, "eta"),
                                                   (1, 1.5 - 1j, "eta"), (1, 0, "eta"), (1, 1e7, "eta")])
    def test_limits(self, cosine, eta, name):
        with pytest.raises(aureole.Error, match=f"^{name}: expected"):
            optics.fresnel(cosine, eta)


class TestSlabs:
    def test_airy(self):
        """Airy's sum of all reflections: R = F sin^2/(1 + F sin^2) with F = 4 r/(1 - r)^2 for one face's reflectance r."""
        cosine, thickness = np.linspace(0.05, 1, 20)[:, None], np.linspace(0.1, 3, 30)
        f = optics.fresnel(cosine, 1.5)
        phase = 2 * np.pi * 1.5 * thickness * f.cos_t.real
        expected = 0
        for r in (abs(f.rs) ** 2, abs(f.rp) ** 2):
            finesse = 4 * r / (1 - r) ** 2 * np.sin(phase) ** 2
            expected = expected + 0.5 * finesse / (1 + finesse)
        slab = optics.slab_powers(cosine, 1.5, thickness)
        np.testing.assert_allclose(slab.reflected, expected, rtol=1e-10, atol=1e-14)
        np.testing.assert_allclose(slab.reflected + slab.transmitted, 1, rtol=1e-12)
        np.testing.assert_allclose(slab.absorbed, 0, atol=1e-12)

    def test_absorption(self):
        thick = optics.slab_powers([1, 0.5], 1.5 + 0.1j, 500)
        np.testing.assert_allclose(thick.reflected, optics.fresnel([1, 0.5], 1.5 + 0.1j).reflectance, rtol=1e-10)
        np.testing.assert_allclose(thick.transmitted, 0, atol=1e-100)
        np.testing.assert_allclose(thick.absorbed, 1 - thick.reflected)
        weak = optics.slab_powers(1, 1.0 + 1e-4j, 10, outside=1.0)
        assert weak.transmitted == pytest.approx(np.exp(-4 * np.pi * 1e-4 * 10), rel=1e-6)

    def test_outside(self):
        """The wavelength in vacuum is the unit, on whichever side: in water the slab has the same optical thickness."""
        a = optics.slab_powers(1, 1.5, 0.25, outside=1.33)
        b = optics.slab_powers(1, 1.5 / 1.33, 0.25 * 1.33)
        assert a.reflected == pytest.approx(b.reflected, rel=1e-12)
        # Total reflection at a gap of air between glass that is thin lets light through.
        thin, thick = optics.slab_powers(0.5, 1.0, [0.05, 3.0], outside=1.5).transmitted
        assert thin > 0.8 and thick < 1e-6

    def test_incoherent(self):
        """The mean over thicknesses is the sum of powers, for each polarisation."""
        mean = optics.slab_powers(1, 1.5, np.linspace(10, 11, 3001)[:-1] / 3).reflected.mean()
        assert mean == pytest.approx(optics.thin_slab_reflectance(1, 1.5), rel=1e-3)
        assert optics.thin_slab_reflectance(1, 1.5) == pytest.approx(2 * 0.04 / 1.04)

    @pytest.mark.parametrize("arguments, name", [((1.1, 1.5, 1), "cos_theta"), ((1, 1.5 - 1j, 1), "index"), ((1, 0, 1), "index"),
                                                 ((1, 1.5, 0), "thickness"), ((1, 1.5, np.inf), "thickness")])
    def test_limits(self, arguments, name):
        with pytest.raises(aureole.Error, match=f"^{name}: expected"):
            optics.slab_powers(*arguments)


class TestAbsorption:
    def test_quantities(self):
        sigma, s = np.array([0.0, 1e-9, 3.0, 500.0])[:, None], np.array([0.0, 0.01, 1.0])
        t = optics.transmittance(sigma, s)
        np.testing.assert_allclose(t, np.exp(-sigma * s), rtol=1e-14)
        np.testing.assert_allclose(optics.absorptance(sigma, s), -np.expm1(-sigma * s), rtol=1e-14)
        np.testing.assert_allclose(optics.napierian_absorbance(t), sigma * s, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(optics.decadic_absorbance(t), sigma * s / np.log(10), rtol=1e-9, atol=1e-15)
        a = np.array([0.0, 0.3, 2.0])
        np.testing.assert_allclose(optics.decadic_absorbance(optics.transmittance_of_decadic(a)), a, atol=1e-14)
        np.testing.assert_allclose(optics.napierian_absorbance(optics.transmittance_of_napierian(a)), a, atol=1e-14)
        np.testing.assert_allclose(optics.absorption_of_napierian(a, 0.5), 2 * a)
        np.testing.assert_allclose(optics.absorption_of_decadic(a, 0.5), 2 * np.log(10) * a)
        assert not np.signbit(optics.decadic_absorbance(1.0))

    def test_matter(self):
        assert optics.absorption_of_index(1e-6, 500) == pytest.approx(4 * np.pi * 1e-6 / 500e-9)
        assert optics.index_of_absorption(optics.absorption_of_index(1e-6, 500), 500) == pytest.approx(1e-6)
        # 33000 L/(mol cm) at 1 umol/L: absorbance 0.033 in 1 cm.
        assert optics.decadic_absorbance(optics.transmittance(optics.absorption_of_molar(33000, 1e-6), 0.01)) == pytest.approx(0.033)
        assert optics.cross_section_of_molar(33000) * 1e-6 * 1e3 * 6.02214076e23 == pytest.approx(
            optics.absorption_of_molar(33000, 1e-6))
        assert optics.absorption_of_mass(2, 3) == 6 and optics.absorption_of_number(1e-12, 1e10) == pytest.approx(0.01)

    def test_phase_functions(self):
        mu, weight = np.polynomial.legendre.leggauss(200)
        for function, mean in ((lambda m: optics.henyey_greenstein(m, 0.6), 0.6), (lambda m: optics.rayleigh_phase(m, 0.03), 0)):
            assert 2 * np.pi * (function(mu) * weight).sum() == pytest.approx(1, rel=1e-12)
            assert 2 * np.pi * (function(mu) * mu * weight).sum() == pytest.approx(mean, abs=1e-12)
        assert optics.rayleigh_phase(1.0) == pytest.approx(3 / (8 * np.pi))
        f = np.array([0.0, 0.1, 0.6])
        np.testing.assert_allclose(optics.hard_sphere_structure_factor(0, f), (1 - f) ** 4 / (1 + 2 * f) ** 2, rtol=1e-12)

    def test_air_and_water(self):
        # The fit that Bodhaine et al. 1999 give for their own calculation, equation 29.
        um = np.array([0.3, 0.4, 0.55, 0.7, 0.85])
        fit = 1e-32 * (1.0455996 - 341.29061 / um**2 - 0.90230850 * um**2) / (1 + 0.0027059889 / um**2 - 85.968563 * um**2)
        np.testing.assert_allclose(optics.air_cross_section(1000 * um), fit, rtol=1e-3)
        assert optics.air_refractivity(589.3) == pytest.approx(2.77e-4, rel=3e-3)
        assert 0.027 < optics.air_depolarization(550) < 0.031
        np.testing.assert_allclose(optics.water_scattering([450, 500, 550]), [34.9e-4, 22.2e-4, 14.9e-4], rtol=0.02)

    def test_dipoles(self):
        albedo, index = np.linspace(0, 1, 11), np.array([[1.0], [1.33]])
        inside = optics.fresnel_diffuse_reflectance(1 / index)
        a, s = (1 + inside) / (1 - inside), np.sqrt(3 * (1 - albedo))
        reflectance = optics.dipole_reflectance(albedo, index)
        np.testing.assert_allclose(reflectance, albedo / 2 * (1 + np.exp(-4 / 3 * a * s)) * np.exp(-s), rtol=1e-6)
        np.testing.assert_allclose(optics.dipole_albedo(reflectance, index), np.broadcast_to(albedo, (2, 11)), atol=1e-6)

    @pytest.mark.parametrize("call, name", [
        (lambda: optics.air_cross_section(100), "nm"), (lambda: optics.dipole_reflectance(1.1), "reduced_albedo"),
        (lambda: optics.transmittance(-1, 1), "absorption"), (lambda: optics.transmittance(1, -1), "distance"),
        (lambda: optics.decadic_absorbance(0), "transmittance"), (lambda: optics.napierian_absorbance(1.5), "transmittance"),
        (lambda: optics.absorption_of_decadic(1, 0), "distance"), (lambda: optics.absorption_of_index(1, 0), "nm"),
        (lambda: optics.hard_sphere_structure_factor(1, 0.7), "fraction"), (lambda: optics.henyey_greenstein(0, 1), "g")])
    def test_limits(self, call, name):
        with pytest.raises(aureole.Error, match=f"^{name}: expected"):
            call()


class TestStructureFactor:
    def test_definition(self):
        """1/S' = 1 + c with the three terms of Rosenfeld (1990), in Bessel functions of another making."""
        u, fa = np.array([0.3, 1.0, 3.3, 7.0, 25.0]), np.array([[0.1], [0.4], [0.68]])
        w = fa / (1 - fa)

        def disc(v):
            return 2 * bessel(1, v) / v

        c = 4 * w * disc(2 * u) + 4 * w**2 * bessel(0, u) * disc(u) + (w**2 + 2 * w**3) * disc(u) ** 2
        np.testing.assert_allclose(optics.structure_factor(u, fa), 1 / (1 + c), rtol=1e-10)
        np.testing.assert_allclose(optics.structure_factor(0, fa), (1 - fa) ** 3 / (1 + fa), rtol=1e-12)
        assert np.all(optics.structure_factor([0, 5, 1e9], 0.5, model="poisson") == 1)
        assert optics.structure_factor(1e9, 0.7) == pytest.approx(1, abs=1e-9)

    @pytest.mark.parametrize("fa", [0.05, 0.3, 0.6])
    def test_is_transform_of_g(self, fa):
        """S'(u) = 1 + 2 Fa integral of (g - 1) J0(u r) r dr, panel by panel between the kinks of g."""
        nodes, weights = np.polynomial.legendre.leggauss(12)
        edges = np.concatenate([2 - 2 * np.linspace(1, 0, 9) ** 3, np.arange(2.5, 30.1, 0.5)])
        half = np.diff(edges)[:, None] / 2
        r = (edges[:-1, None] + half + half * nodes).ravel()
        w = (half * weights).ravel()
        h = optics.hard_disc_pair_correlation(r, fa) - 1
        for u in (0.0, 1.0, 3.0, 8.0):
            assert 1 + 2 * fa * (h * bessel(0, u * r) * r * w).sum() == pytest.approx(optics.structure_factor(u, fa), abs=3e-4)

    def test_g_at_low_density(self):
        """To first order g = 1 outside of contact, and then Fa overlap/pi (Hansen & McDonald, 5.1)."""
        r = np.array([0.5, 1.99, 2.0, 3.0, 5.0])
        overlap = np.where(r < 4, 8 * np.arccos(np.minimum(r / 4, 1)) - r / 2 * np.sqrt(np.maximum(16 - r**2, 0)), 0)
        expected = np.where(r < 2, 0, 1 + 1e-4 * overlap / np.pi)
        np.testing.assert_allclose(optics.hard_disc_pair_correlation(r, 1e-4), expected, atol=2e-4)
        outside = r >= 2
        np.testing.assert_allclose(optics.hard_disc_pair_correlation(r, 1e-4)[outside], expected[outside], atol=1e-7)
        np.testing.assert_array_equal(optics.hard_disc_pair_correlation(r, 0), [0, 0, 1, 1, 1])

    def test_objects(self):
        S = optics.StructureFactor
        u = np.linspace(0, 30, 301)
        np.testing.assert_array_equal(S.percus_yevick(0.4)(u), optics.structure_factor(u, 0.4))
        np.testing.assert_array_equal(S.poisson()(u), 1)
        np.testing.assert_allclose(S.table([0, 1, 2], [0, 2, 1])([0, 0.5, 1.5, 3]), [0, 1, 1.5, 1])
        r = np.linspace(2, 40, 2000)
        again = S.from_pair_correlation(r[::4], optics.hard_disc_pair_correlation(r[::4], 0.1), 0.1)
        np.testing.assert_allclose(again(u), optics.structure_factor(u, 0.1), atol=0.02)
        assert S.simulated(0.01)(0) == pytest.approx(S.percus_yevick(0.01)(0), abs=1e-6)

    def test_lattice(self):
        """The first spot of a hexagonal lattice of touching discs is at 2 pi/(sqrt(3) a); directions repeat after 60 degrees."""
        s = optics.StructureFactor.lattice(np.pi / np.sqrt(12), jitter=0.02, domain=6, random_orientation=False)
        first = 2 * np.pi / np.sqrt(3)
        angle = np.radians(np.arange(0, 360, 60) + 30)
        spots = s.at(first * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
        np.testing.assert_allclose(spots, spots[0], rtol=1e-9)
        assert not s.is_isotropic and spots[0] > 50 and s.at([first, 0.0]) < 0.2
        ring = s.at(2.9 * np.stack([np.cos(t := np.linspace(0, 2 * np.pi, 720, False)), np.sin(t)], axis=-1)).mean()
        assert s(2.9) == pytest.approx(ring, rel=0.02)
        for wrong in ({"area_fraction": 0.95}, {"area_fraction": 0}, {"kind": "cubic"}, {"jitter": -1}, {"domain": 1e9}):
            with pytest.raises(aureole.Error, match=f"^{'area_fraction' if 'domain' in wrong else list(wrong)[0]}: "):
                optics.StructureFactor.lattice(**{"area_fraction": 0.5, **wrong})

    def test_simulated(self):
        s = optics.StructureFactor.simulated(0.3, discs=400, snapshots=400, seed=1)
        np.testing.assert_allclose(s([0.0, 2.0, 3.0, 6.0]), optics.structure_factor([0.0, 2.0, 3.0, 6.0], 0.3), atol=0.05)

    def test_wrong(self):
        with pytest.raises(TypeError):
            optics.StructureFactor("percus_yevick")
        for call, name in ((lambda: optics.structure_factor(1, 0.71), "area_fraction"),
                           (lambda: optics.structure_factor(1, 0.5, model="percus"), "model"),
                           (lambda: optics.structure_factor(1, 0.5, model=np.ones(3)), "model"),
                           (lambda: optics.structure_factor(1e10, 0.5), "qa"),
                           (lambda: optics.hard_disc_pair_correlation(-1, 0.5), "ra"),
                           (lambda: optics.StructureFactor.table([1, 0], [1, 1]), "qa"),
                           (lambda: optics.StructureFactor.table([0, 1], [1, 1, 1]), "s"),
                           (lambda: optics.StructureFactor.from_pair_correlation([0, 1], [1, 1], 0.1), "ra"),
                           (lambda: optics.StructureFactor.poisson()(1e5), "qa"),
                           (lambda: optics.StructureFactor.simulated(0.5, discs=10), "discs"),
                           (lambda: optics.StructureFactor.simulated(0.5, snapshots=10**6), "snapshots")):
            with pytest.raises(aureole.Error, match=f"^{name}: "):
                call()


class TestApertures:
    SHAPES = {"circle": optics.circle(3 * UM), "ellipse": optics.ellipse(4 * UM, 2 * UM),
              "annulus": optics.annulus(4 * UM, 2 * UM), "ngon": optics.ngon(3 * UM, 5),
              "rectangle": optics.rectangle(6 * UM, 3 * UM), "star": optics.star(4 * UM, 5, 0.4),
              "polygon": optics.polygon(np.array([(0, 0), (3, 0), (0, 4)]) * UM, centroid=False)}
    AREAS = {"circle": 9 * np.pi, "ellipse": 8 * np.pi, "annulus": 12 * np.pi, "ngon": 2.5 * 9 * np.sin(2 * np.pi / 5),
             "rectangle": 18, "star": 5 * 4 * 1.6 * np.sin(np.pi / 5), "polygon": 6}

    @staticmethod
    def inside(name, x, y):
        """Of points in um."""
        def ring(corners):
            cross = np.zeros_like(x, bool)
            for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
                if ay != by:
                    cross ^= ((ay <= y) != (by <= y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
            return cross

        def around(radii):
            angle = np.pi / 2 + 2 * np.pi * np.arange(len(radii)) / len(radii)
            return list(zip(radii * np.cos(angle), radii * np.sin(angle)))

        r = np.hypot(x, y)
        return {"circle": lambda: r < 3, "ellipse": lambda: np.hypot(x / 4, y / 2) < 1, "annulus": lambda: (r < 4) & (r > 2),
                "ngon": lambda: ring(around(np.full(5, 3.0))), "rectangle": lambda: (abs(x) < 3) & (abs(y) < 1.5),
                "star": lambda: ring(around(np.tile([4.0, 1.6], 5))), "polygon": lambda: ring([(0, 0), (3, 0), (0, 4)])}[name]()

    @pytest.mark.parametrize("name", SHAPES)
    def test_transform(self, name):
        """Against a sum over a fine raster."""
        shape = self.SHAPES[name]
        assert shape.area == pytest.approx(self.AREAS[name] * UM**2, rel=1e-12)
        assert shape.radius == pytest.approx(np.sqrt(shape.area / np.pi), rel=1e-14)
        assert shape.squared_area == shape.area
        side = (np.arange(1000) + 0.5) / 100 - 5
        x, y = np.meshgrid(side, side)
        open_x, open_y = x[inside := self.inside(name, x, y)], y[inside]
        assert shape.bounding_radius == pytest.approx(np.hypot(open_x, open_y).max() * UM, rel=0.01)
        for q in ((0, 0), (0.4, 0.3), (-1.0, 2.0), (3.0, 0.0), (0.0, -3.0)):
            expected = np.exp(-1j * (q[0] * open_x + q[1] * open_y)).sum() / 100**2
            assert abs(shape.transform(np.array(q) / UM) / UM**2 - expected) < 0.01 * self.AREAS[name]

    def test_closed_forms(self):
        q = np.random.default_rng(2).normal(0, 3, (4, 5, 2)) / UM
        length = np.hypot(q[..., 0], q[..., 1])
        circle = self.SHAPES["circle"].transform(q)
        assert circle.shape == (4, 5)
        u = length * 3 * UM
        np.testing.assert_allclose(circle, 18 * np.pi * UM**2 * bessel(1, u) / u, atol=1e-12 * UM**2)
        sinc = 18 * UM**2 * np.sinc(q[..., 0] * 3 * UM / np.pi) * np.sinc(q[..., 1] * 1.5 * UM / np.pi)
        np.testing.assert_allclose(self.SHAPES["rectangle"].transform(q), sinc, atol=1e-10 * UM**2)
        assert self.SHAPES["circle"].is_circular and not self.SHAPES["star"].is_circular

    def test_babinet(self):
        """A frame is the outer square less the inner one."""
        q = np.random.default_rng(3).normal(0, 3, (50, 2)) / UM
        frame = optics.polygon(2 * np.array(SQUARE), holes=[SQUARE])
        expected = optics.rectangle(4 * UM, 4 * UM).transform(q) - optics.rectangle(2 * UM, 2 * UM).transform(q)
        np.testing.assert_allclose(frame.transform(q), expected, atol=1e-11 * UM**2)

    def test_origin(self):
        moved = np.array(SQUARE) + [5 * UM, 2 * UM]
        q = np.array([0.3, -0.7]) / UM
        kept, centred = optics.polygon(moved, centroid=False), optics.polygon(moved)
        phase = np.exp(-1j * (q @ [5 * UM, 2 * UM]))
        assert abs(kept.transform(q) - phase * centred.transform(q)) < 1e-11 * kept.area

    def test_mask(self):
        picture = np.zeros((60, 80))
        picture[20:40, 30:60] = 1
        picture[20:25, 30:60] = 0.5
        shape = optics.mask(picture, 0.1 * UM, centroid=False)
        assert shape.area == pytest.approx((15 + 2.5) * 30 * 0.01 * UM**2)
        assert shape.squared_area == pytest.approx((15 + 1.25) * 30 * 0.01 * UM**2)
        x, y = np.meshgrid((np.arange(80) - 39.5) * 0.1, (29.5 - np.arange(60)) * 0.1)
        for q in ((0, 0), (1.0, 2.0), (-3.0, 0.5)):
            pixel = 0.01 * np.sinc(q[0] * 0.05 / np.pi) * np.sinc(q[1] * 0.05 / np.pi)
            expected = (picture * np.exp(-1j * (q[0] * x + q[1] * y))).sum() * pixel
            assert abs(shape.transform(np.array(q) / UM) / UM**2 - expected) < 1e-4 * picture.sum() * 0.01
        assert optics.mask(picture > 0.7, 0.1 * UM).area == pytest.approx(15 * 30 * 0.01 * UM**2)

    @pytest.mark.parametrize("call, name", [
        (lambda: optics.circle(3), "radius"), (lambda: optics.circle(0), "radius"), (lambda: optics.circle([1e-6, 2e-6]), "radius"),
        (lambda: optics.ellipse(1e-6, -1e-6), "radius_y"), (lambda: optics.annulus(1e-6, 1e-6), "inner_radius"),
        (lambda: optics.annulus(1e-6, 2e-6), "inner_radius"), (lambda: optics.ngon(1e-6, 2), "sides"),
        (lambda: optics.rectangle(1, 1e-9), "height"), (lambda: optics.star(1e-6, 5, 2), "inner_ratio"),
        (lambda: optics.polygon(SQUARE[:2]), "vertices"), (lambda: optics.polygon([1, 2, 3]), "vertices"),
        (lambda: optics.polygon([(0, 0), (1e-6, 1e-6), (1e-6, 0), (0, 1e-6)]), "vertices"),
        (lambda: optics.polygon([(0, 0), (1, 1), (2, 2)]), "vertices"), (lambda: optics.polygon(np.zeros((5, 2))), "vertices"),
        (lambda: optics.polygon(np.random.default_rng(0).normal(0, 1, (20001, 2))), "vertices"),
        (lambda: optics.polygon(np.array(SQUARE) * 1e9), "vertices"),
        (lambda: optics.polygon(SQUARE, holes=[np.array(SQUARE) + 9 * UM]), "holes"),
        (lambda: optics.polygon(SQUARE, holes=SQUARE), r"holes\[0\]"), (lambda: optics.polygon(SQUARE, holes=[[1, 2]]), r"holes\[0\]"),
        (lambda: optics.mask(np.ones(5), 1e-6), "open"), (lambda: optics.mask(np.zeros((3, 3)), 1e-6), "open"),
        (lambda: optics.mask(np.full((3, 3), 2.0), 1e-6), "open"), (lambda: optics.mask(np.ones((0, 3)), 1e-6), "open"),
        (lambda: optics.mask(np.ones((3, 3)), 0), "pixel_size"), (lambda: optics.mask(np.ones((3, 3)), 10), "pixel_size"),
        (lambda: optics.circle(1e-6).transform(1.0), "q"), (lambda: optics.circle(1e-6).transform([1, 2, 3]), "q"),
        (lambda: optics.circle(1e-6).transform([1e300, 0]), "q"), (lambda: optics.circle(1e-6).transform([np.nan, 0]), "q")])
    def test_wrong(self, call, name):
        with pytest.raises(aureole.Error, match=f"^{name}: "):
            call()

    @pytest.mark.parametrize("call", [lambda: optics.circle("5um"), lambda: optics.ngon(1e-6, 5.5), lambda: optics.polygon(5),
                                      lambda: optics.polygon(SQUARE, holes=5),
                                      lambda: optics.polygon(SQUARE, holes=closed_file()), lambda: optics.polygon(SQUARE, centroid=1),
                                      lambda: optics.mask("picture.png", 1e-6), lambda: optics.circle(1e-6).transform("x"),
                                      lambda: optics.circle(1e-6).transform(None), lambda: optics.ApertureShape()])
    def test_wrong_types(self, call):
        with pytest.raises((TypeError, aureole.Error)):
            call()

    def test_empty(self):
        assert optics.circle(1e-6).transform(np.zeros((3, 0, 2))).shape == (3, 0)


def nearest(points, box):
    d = points[:, None] - points
    d -= box * np.round(d / box)
    r = np.hypot(d[..., 0], d[..., 1])
    r[np.arange(len(r)), np.arange(len(r))] = np.inf
    return r


class TestHardDiscs:
    def test_no_overlap(self):
        d = optics.hard_discs(500, 0.6, seed=7, radius=2.5)
        assert d.positions.shape == (500, 2) and np.all((d.positions >= 0) & (d.positions <= d.box)) and d.box[0] == d.box[1]
        assert 500 * np.pi * 2.5**2 / d.box.prod() == pytest.approx(0.6) and np.all(d.radius == 2.5)
        assert nearest(d.positions, d.box).min() >= 5 * (1 - 1e-12)

    def test_mixture(self):
        radius = np.random.default_rng(1).lognormal(0, 0.3, 300)
        d = optics.hard_discs(300, 0.6, seed=2, radius=radius)
        np.testing.assert_allclose(d.radius, radius, rtol=1e-14)
        assert (np.pi * radius**2).sum() / d.box.prod() == pytest.approx(0.6)
        assert (nearest(d.positions, d.box) - radius - radius[:, None]).min() > -1e-9

    def test_seed(self):
        a, b, c = (optics.hard_discs(200, 0.4, seed=s).positions for s in (1, 1, 2))
        assert np.array_equal(a, b) and not np.array_equal(a, c)

    def test_equilibrium(self):
        """Pressure and g(2a+) of Henderson (1975)."""
        fa = 0.5
        d = optics.hard_discs(1000, fa, seed=3, snapshots=200)
        assert d.positions.shape == (200, 1000, 2)
        assert d.pressure == pytest.approx((1 + fa**2 / 8) / (1 - fa) ** 2, rel=0.01)
        g = optics.pair_correlation(d.positions, d.box, edges=[0, 2, 2.02, 2.04, 2.06])
        assert g.g[0] == 0
        contact = np.polyval(np.polyfit(g.r[1:] - 2, g.g[1:], 1), 0)
        assert contact == pytest.approx((1 - 7 * fa / 16) / (1 - fa) ** 2, rel=0.02)

    @pytest.mark.parametrize("arguments, name", [
        ((0, 0.5), "n"), ((10**7, 0.5), "n"), ((5, 0.5), "n"), ((100, 0.7), "area_fraction"), ((100, 0), "area_fraction"), ((100, 1e-20), "area_fraction"),
        ((100, 0.5, -1), "seed"), ((100, 0.5, 2**64), "seed")])
    def test_wrong(self, arguments, name):
        with pytest.raises(aureole.Error, match=f"^{name}: "):
            optics.hard_discs(*arguments)
        for keywords, name in (({"radius": [1, 2]}, "radius"), ({"radius": -1}, "radius"), ({"snapshots": 0}, "snapshots"),
                               ({"snapshots": 10**9}, "snapshots"), ({"sweeps": -1}, "sweeps"),
                               ({"radius": np.geomspace(1, 1000, 100)}, "radius")):
            with pytest.raises(aureole.Error, match=f"^{name}: "):
                optics.hard_discs(100, 0.5, **keywords)
        with pytest.raises(TypeError):
            optics.hard_discs(100.5, 0.5)


class TestPoints:
    @pytest.mark.parametrize("periodic", [True, False])
    def test_counts(self, periodic):
        """Every pair, by numpy. The box is not square and has between one and many cells."""
        rng, box = np.random.default_rng(8), np.array([12.0, 7.0])
        points = rng.uniform(0, 1, (2, 300, 2)) * box
        for r_max in (3.5, 1.7, 0.4):
            g = optics.pair_correlation(points, box, r_max=r_max, bins=10, periodic=periodic)
            expected = np.zeros(10)
            for field in points:
                d = abs(field[:, None] - field)
                if periodic:
                    d = np.minimum(d, box - d)
                r = np.hypot(d[..., 0], d[..., 1])
                np.fill_diagonal(r, np.inf)
                weight = np.full(r.shape, 1 / box.prod()) if periodic else 1 / (box - d).prod(axis=-1)
                expected += np.histogram(r, np.linspace(0, r_max, 11), weights=weight)[0] / 2
            ring = np.pi * np.diff(np.linspace(0, r_max, 11) ** 2)
            np.testing.assert_allclose(g.g, expected * box.prod() ** 2 / (300 * 299 * ring), rtol=1e-10)

    @pytest.mark.parametrize("periodic", [True, False])
    def test_intervals(self, periodic):
        """Of independent points 95 % of the intervals of g and S hold 1."""
        held_g, held_s = [], []
        for seed in range(60):
            points = np.random.default_rng(seed).uniform(0, 30, (600, 2))
            g = optics.pair_correlation(points, 30, r_max=6, bins=6, periodic=periodic)
            s = optics.point_structure_factor(points, 30, edges=[0.6, 1, 2, 3, 4], periodic=periodic)
            held_g += list((g.low <= 1) & (1 <= g.high))
            held_s += list((s.low <= 1) & (1 <= s.high))
        assert 0.91 < np.mean(held_g) < 0.985
        assert 0.88 < np.mean(held_s) < 0.995

    def test_structure_factor_of_a_box(self):
        """Each ring is a mean of |sum exp(-i q.r)|^2/n over the wave vectors of the box."""
        rng, box = np.random.default_rng(4), np.array([9.0, 6.0])
        points = rng.uniform(0, 1, (80, 2)) * box
        edges = np.array([0.5, 1.2, 2.0, 3.0])
        s = optics.point_structure_factor(points, box, edges=edges, per_ring=10**6)
        k = np.stack(np.meshgrid(np.arange(-6, 7), np.arange(-6, 7)), axis=-1).reshape(-1, 2) * 2 * np.pi / box
        length = np.hypot(k[:, 0], k[:, 1])
        power = abs(np.exp(-1j * k @ points.T).sum(axis=1)) ** 2 / 80
        for i in range(3):
            ring = (length >= edges[i]) & (length < edges[i + 1])
            assert s.q[i] == pytest.approx(length[ring].mean()) and s.s[i] == pytest.approx(power[ring].mean(), rel=1e-4)
            assert s.error[i] == pytest.approx(s.s[i] / np.sqrt(ring.sum() / 2), rel=1e-6)

    def test_hard_discs(self):
        """Points of a fluid have its structure factor, in boxes and in windows, and its hole in g."""
        d = optics.hard_discs(4000, 0.2, seed=5)
        expected = optics.structure_factor([1.0, 2.0, 3.0], 0.2)
        edges = [0.9, 1.1, 1.9, 2.1, 2.9, 3.1]
        for periodic in (True, False):
            s = optics.point_structure_factor(d.positions, d.box, edges=edges, periodic=periodic)
            np.testing.assert_allclose(s.s[::2], expected, rtol=0.12)
            g = optics.pair_correlation(d.positions, d.box, edges=[0, 1, 2, 8, 9], periodic=periodic)
            assert g.g[0] == g.g[1] == 0 and g.high[1] < 0.01 and g.low[3] < 1 < g.high[3]

    def test_defaults(self):
        for function in (optics.pair_correlation, optics.point_structure_factor):
            for periodic in (True, False):
                result = function(POINTS, 10, periodic=periodic)
                assert all(np.all(np.isfinite(column)) for column in result)

    @pytest.mark.parametrize("arguments, name", [
        ({"positions": np.zeros((5, 3))}, "positions"), ({"positions": [[1, 2]]}, "positions"), ({"positions": [1, 2]}, "positions"),
        ({"positions": POINTS - 1}, "positions"), ({"positions": np.zeros((0, 2))}, "positions"),
        ({"positions": np.zeros((0, 5, 2))}, "positions"), ({"box": [1, 2, 3]}, "box"), ({"box": 0}, "box"), ({"box": -10}, "box"),
        ({"box": [1e9, 1e-9]}, "box"), ({"edges": [1, 0]}, "edges"), ({"edges": [0]}, "edges"), ({"edges": [-1, 0]}, "edges"),
        ({"edges": [0, 1e9]}, "edges")])
    @pytest.mark.parametrize("periodic", [True, False])
    def test_wrong(self, arguments, name, periodic):
        for function in (optics.pair_correlation, optics.point_structure_factor):
            with pytest.raises(aureole.Error, match=f"^{name}: "):
                function(**{"positions": POINTS, "box": 10, "periodic": periodic, **arguments})

    def test_wrong_options(self):
        for function, keywords, name in ((optics.pair_correlation, {"r_max": 6}, "r_max"), (optics.pair_correlation, {"r_max": 0}, "r_max"),
                                         (optics.pair_correlation, {"bins": 0}, "bins"), (optics.pair_correlation, {"tiles": 1}, "tiles"),
                                         (optics.point_structure_factor, {"q_max": 1e9}, "q_max"),
                                         (optics.point_structure_factor, {"rings": 10**9}, "rings"),
                                         (optics.point_structure_factor, {"per_ring": 0}, "per_ring"),
                                         (optics.point_structure_factor, {"q_max": 0.1, "periodic": False}, "q_max"),
                                         (optics.point_structure_factor, {"edges": [0, 0.1], "periodic": False}, "edges")):
            with pytest.raises(aureole.Error, match=f"^{name}: "):
                function(POINTS, 10, **keywords)

    def test_too_much_work(self):
        points = np.zeros((10**5, 2))
        with pytest.raises(aureole.Error, match="^per_ring: "):
            optics.point_structure_factor(points, 1, q_max=6000, per_ring=10**6)
        with pytest.raises(aureole.Error, match="at most"):
            optics.pair_correlation(POINTS, 10, bins=10000, tiles=32)

    def test_all_points_on_the_edge(self):
        with pytest.raises(aureole.Error):
            optics.point_structure_factor(np.zeros((5, 2)), 1, periodic=False)


# Every function of arrays: its arguments, right ones, by name.
FUNCTIONS = {
    "mie": (optics.mie, {"x": [1.0, 2.0], "m": [1.5, 1.25]}),
    "mie_amplitudes": (optics.mie_amplitudes, {"x": [1.0, 2.0], "m": [1.5, 1.25], "mu": [0.5, -0.25]}),
    "mie_phase_function": (optics.mie_phase_function, {"x": [1.0, 2.0], "m": [1.5, 1.25], "mu": [0.5, -0.25]}),
    "fresnel": (optics.fresnel, {"cos_theta": [1.0, 0.5], "eta": [1.5, 1.25]}),
    "fresnel_diffuse_reflectance": (optics.fresnel_diffuse_reflectance, {"eta": [1.5, 1.25]}),
    "structure_factor": (optics.structure_factor, {"qa": [1.0, 2.0], "area_fraction": [0.5, 0.25]}),
    "hard_disc_pair_correlation": (optics.hard_disc_pair_correlation, {"ra": [1.0, 2.5], "area_fraction": [0.5, 0.25]}),
    "percus_yevick": (lambda qa: optics.StructureFactor.percus_yevick(0.5)(qa), {"qa": [1.0, 2.0]}),
}
CASES = [(name, argument) for name, (_, arguments) in FUNCTIONS.items() for argument in arguments]
WRONG = {"nan": np.nan, "infinity": [1, np.inf], "-infinity": -np.inf, "text": "one", "texts": ["a", "b"], "none": None, "object": object(),
         "objects": np.array([1, 2], object), "booleans": np.array([True, False]), "ragged": [1, [2, 3]], "dates": np.array(["2020"], "M8[D]"),
         "masked": np.ma.masked_array([1.0, 1.0], [True, False]), "dict": {}, "shape": np.ones((3, 5, 7)), "bytes": b"1"}


def columns(result):
    return result if isinstance(result, tuple) else (result,)


@pytest.mark.parametrize("name, argument", CASES)
@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_values(name, argument, wrong):
    function, arguments = FUNCTIONS[name]
    if wrong == "shape" and (argument == "mu" or len(arguments) == 1):
        pytest.skip("any shape is right")
    with pytest.raises((aureole.Error, TypeError), match=rf"^({argument}|\w+ and \w+): "):
        function(**{**arguments, argument: WRONG[wrong]})


@pytest.mark.parametrize("name, argument", CASES)
def test_formats(name, argument):
    """Whatever numpy makes of it, the values count."""
    function, arguments = FUNCTIONS[name]
    expected = columns(function(**arguments))
    values = np.array(arguments[argument])
    for same in (tuple(values), values.astype(np.float32), values.astype(">f8"), np.repeat(values, 3)[::3], np.longdouble(values),
                 np.asfortranarray(np.stack([values, values]))[0], np.ma.masked_array(values), values[::-1].copy()[::-1]):
        for a, b in zip(columns(function(**{**arguments, argument: same})), expected):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_shapes(name):
    function, arguments = FUNCTIONS[name]
    for shape in ((), (1,), (0,), (3, 0, 2), (2, 3)):
        full = {key: np.full(shape, value[0]) for key, value in arguments.items()}
        for column in columns(function(**full)):
            assert np.shape(column) == (shape * 2 if "mu" in full else shape)
    assert all(np.isscalar(c) for c in columns(function(**{key: value[0] for key, value in arguments.items()})))
    if len(arguments) > 1 and "mu" not in arguments:
        first, second = arguments
        outer = function(**{first: np.full((4, 1), arguments[first][0]), second: np.full(3, arguments[second][0])})
        assert all(np.shape(c) == (4, 3) for c in columns(outer))


def test_too_many_results():
    """Small arguments that would have results of terabytes."""
    for call in (lambda: optics.mie(np.ones((10**5, 1)), np.full(10**5, 1.5)), lambda: optics.fresnel(np.ones((10**5, 1)), np.full(10**5, 1.5)),
                 lambda: optics.mie_amplitudes(np.ones(10**5), 1.5, np.ones(10**5)), lambda: optics.structure_factor(np.ones((10**5, 1)), np.full(10**5, 0.1))):
        with pytest.raises(aureole.Error, match="at most"):
            call()


@contextmanager
def interrupted_after(seconds):
    """Ctrl-C, by a timer; the work would take minutes."""
    def handler(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, handler)
    start = time.monotonic()
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
        assert time.monotonic() - start < seconds + 5
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("work", [
    lambda: optics.mie(np.full(10**6, 1e5), 1.5), lambda: optics.mie_amplitudes(1e5, 1.5, np.linspace(-1, 1, 10**7)),
    lambda: optics.hard_discs(10**5, 0.6), lambda: optics.hard_disc_pair_correlation(np.full(10**6, 100.0), 0.5),
    lambda: optics.pair_correlation(np.random.default_rng(0).uniform(0, 1, (10**6, 2)), 1, r_max=0.5),
    lambda: optics.point_structure_factor(np.random.default_rng(0).uniform(0, 1, (10**5, 2)), 1, periodic=False),
    lambda: optics.StructureFactor.lattice(0.5, jitter=0, random_orientation=False)(np.full(10**6, 1e4))])
def test_interrupt(work):
    with interrupted_after(0.3):
        work()


def test_interrupt_of_growing_discs():
    """A mixture that cannot reach its density soon: the start itself takes long."""
    radius = np.random.default_rng(0).uniform(0.5, 1, 20000)
    with interrupted_after(0.3):
        optics.hard_discs(20000, 0.68, radius=radius)


def test_threads():
    """Calls from several threads at once, none of them the main one."""
    x = np.geomspace(0.1, 300, 2000)
    expected = optics.mie(x, 1.4).qsca
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: optics.mie(x, 1.4).qsca, range(12)):
            np.testing.assert_array_equal(result, expected)


def test_private_functions_check_sizes():
    """Private functions reject arguments that the package itself never passes."""
    with pytest.raises(aureole.Error):
        aureole._aureole.mie(np.ones(3), np.ones(2, complex), np.empty((4, 3)))
    with pytest.raises(TypeError):  # a copy would be filled
        aureole._aureole.mie(np.ones(3), np.ones(3, complex), np.empty((4, 3), np.float32))
    with pytest.raises(aureole.Error):
        aureole._aureole.hard_discs(np.ones(0), 0.5, 0, 1.0, 1.0, np.empty((1, 0, 2)))


@pytest.mark.parametrize("module", [optics, _apertures, _correlations])
def test_examples(module):
    assert doctest.testmod(module).failed == 0


def test_documented():
    for name in optics.__all__:
        assert getattr(optics, name).__doc__, name
