# SPDX-License-Identifier: Apache-2.0
"""aureole.spectrum against published colorimetry, closed forms and quadrature."""
import doctest

import numpy as np
import pytest

import aureole
from aureole import spectrum

NM = np.arange(360.0, 831.0)


class TestObserver:
    def test_published_values(self):
        """CIE 018:2019 table 6, some lines."""
        np.testing.assert_allclose(spectrum.observer([450, 555, 600, 700]), [
            [0.3362, 0.0380, 1.77211], [0.51205, 1.0, 0.00575], [1.0622, 0.631, 0.0008], [0.011359, 0.004102, 0]], atol=2e-6)

    def test_between_and_outside(self):
        np.testing.assert_allclose(spectrum.observer(555.5), spectrum.observer([555, 556]).mean(axis=0))
        np.testing.assert_array_equal(spectrum.observer([100, 359.9, 830.1, 1e6]), 0)

    def test_integrals(self):
        """The equal-energy spectrum is white: its integrals agree to the rounding of the table."""
        integrals = np.trapezoid(spectrum.observer(NM), NM, axis=0) if hasattr(np, "trapezoid") else np.trapz(
            spectrum.observer(NM), NM, axis=0)
        np.testing.assert_allclose(integrals, 106.8569, rtol=4e-4)


class TestIlluminants:
    def test_published_values(self):
        """CIE 15:2004, table T.1."""
        d65 = spectrum.illuminant("D65", [300, 460, 560, 780], normalize="table")
        np.testing.assert_allclose(d65, [0.0341, 117.812, 100, 63.3828], rtol=1e-6)

    @pytest.mark.parametrize("name, x, y", [("A", 0.44758, 0.40745), ("D50", 0.34567, 0.35851), ("D65", 0.31272, 0.32903),
                                            ("E", 1 / 3, 1 / 3), ("FL2", 0.3721, 0.3751), ("F11", 0.3805, 0.3769)])
    def test_chromaticities(self, name, x, y):
        """CIE 15:2004, tables T.3 and T.6, which sum every 5 nm: lamps with lines differ by 2.4e-4."""
        nm = np.arange(380, 781, 5)
        xyz = spectrum.to_xyz(nm, spectrum.illuminant(name, nm))
        assert xyz[:2] / xyz.sum() == pytest.approx([x, y], abs=1e-4 if name[0] != "F" else 3e-4)

    def test_luminance(self):
        for name in spectrum.illuminants():
            s = spectrum.illuminant(name, NM, outside="zero")
            assert spectrum.to_xyz(NM, s)[1] == pytest.approx(1, abs=2e-4), name
            assert np.all(s >= 0)

    def test_a_is_planckian(self):
        """Illuminant A: Planck's law with c2 = 1.435e7 nm K at 2848 K, CIE 15:2004, 3.1."""
        law = 100 * (560 / NM) ** 5 * np.expm1(1.435e7 / (2848 * 560)) / np.expm1(1.435e7 / (2848 * NM))
        np.testing.assert_allclose(spectrum.illuminant("a", NM[::5], normalize="table"), law[::5], rtol=2e-5)

    def test_wrong(self):
        with pytest.raises(aureole.Error, match='^name: there is no illuminant "D66"; did you mean "D6'):
            spectrum.illuminant("D66", 500)
        with pytest.raises(aureole.Error, match="^wavelength: expected 300 to 830 nm, .*, got 900"):
            spectrum.illuminant("D65", [500, 900])
        assert spectrum.illuminant("D65", 900, outside="zero") == 0
        for keyword in ({"normalize": "power"}, {"outside": "nearest"}, {"outside": None}):
            with pytest.raises(aureole.Error, match=f"^{list(keyword)[0]}: "):
                spectrum.illuminant("D65", 500, **keyword)
        for name in (5, None, b"D65", ["D65"]):
            with pytest.raises(TypeError, match="^name: "):
                spectrum.illuminant(name, 500)
        for name in ("", "\0", "\ud800", "D65" * 1000):
            with pytest.raises(aureole.Error, match="^name: "):
                spectrum.illuminant(name, 500)


class TestBlackbody:
    def test_laws(self):
        """Wien and Stefan-Boltzmann: peak at 2.897772e6 nm K, total sigma T^4/pi."""
        nm = np.geomspace(50, 1e6, 40001)
        for t in (1000.0, 6000.0):
            s = spectrum.blackbody(t, nm)
            assert nm[np.argmax(s)] * t == pytest.approx(2.897772e6, rel=1e-3)
            total = (0.5 * (s[1:] + s[:-1]) * np.diff(nm)).sum()
            assert total == pytest.approx(5.670374e-8 * t**4 / np.pi, rel=1e-4)

    def test_ends(self):
        assert spectrum.blackbody(1e-300, 500) == 0 and spectrum.blackbody(1, 1e-3) == 0
        assert np.isfinite(spectrum.blackbody(1e12, [1e-3, 1e12])).all()
        assert spectrum.blackbody([[1000], [2000]], [500, 600, 700]).shape == (2, 3)
        for arguments, name in (((0, 500), "temperature"), ((-5, 500), "temperature"), ((300, 0), "wavelength"), ((300, -1), "wavelength")):
            with pytest.raises(aureole.Error, match=f"^{name}: expected"):
                spectrum.blackbody(*arguments)


class TestColour:
    def test_white(self):
        """D65 and what reflects all of it are the white of sRGB."""
        d65 = spectrum.illuminant("D65", NM)
        np.testing.assert_allclose(spectrum.to_xyz(NM, d65), [0.95047, 1, 1.08883], atol=1e-4)
        np.testing.assert_allclose(spectrum.to_srgb(NM, d65, encoded=False), 1, atol=2e-4)
        np.testing.assert_allclose(spectrum.to_srgb(NM, np.ones_like(NM), "D65"), 1, atol=1e-4)

    def test_against_quadrature(self):
        """Piecewise linear curves, integrated on a grid of 1 pm."""
        rng = np.random.default_rng(1)
        nm = np.sort(rng.uniform(340, 850, 40))
        values, light = rng.uniform(0, 1, (2, 40))
        fine = np.arange(360, 830.0005, 0.001)
        weight = spectrum.observer(fine) * 0.001
        for name, power in ((None, np.ones_like(fine)), ("FL11", spectrum.illuminant("FL11", fine, outside="zero")), (light, np.interp(fine, nm, light, 0, 0))):
            white = 106.856895 if name is None else power @ weight[:, 1]
            for outside, ends in (("zero", (0, 0)), ("nearest", (None, None))):
                if outside == "nearest" and name is light:
                    power = np.interp(fine, nm, light)
                    white = power @ weight[:, 1]
                expected = (np.interp(fine, nm, values, *ends) * power) @ weight / white
                np.testing.assert_allclose(spectrum.to_xyz(nm, values, name, outside=outside), expected, rtol=2e-5)

    def test_narrow_line(self):
        """A line far narrower than the observer's steps counts with its area."""
        line = spectrum.to_xyz([540.4, 540.401, 540.402], [0, 1000.0, 0])
        np.testing.assert_allclose(line, spectrum.observer(540.401) / 106.8569, rtol=1e-5)

    def test_linear(self):
        values = np.random.default_rng(2).uniform(0, 1, (4, 3, NM.size))
        xyz = spectrum.to_xyz(NM, values, "A")
        assert xyz.shape == (4, 3, 3)
        np.testing.assert_allclose(xyz[2, 1], spectrum.to_xyz(NM, values[2, 1], "A"), rtol=1e-12)
        np.testing.assert_allclose(spectrum.to_xyz(NM, 7 * values, "A"), 7 * xyz, rtol=1e-12)
        np.testing.assert_array_equal(spectrum.to_srgb(NM, values, "A", encoded=False), spectrum.xyz_to_srgb(xyz))

    def test_srgb_matrix(self):
        """The primaries of IEC 61966-2-1."""
        for i, (x, y) in enumerate([(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)]):
            rgb = spectrum.xyz_to_srgb([x / y, 1, (1 - x - y) / y])
            assert abs(rgb[(i + 1) % 3]) + abs(rgb[(i + 2) % 3]) < 1e-3 * rgb[i]
        np.testing.assert_allclose(spectrum.xyz_to_srgb([0.95047, 1, 1.08883]), 1, atol=1e-5)

    def test_srgb_curve(self):
        x = np.linspace(0, 1, 1001)
        expected = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
        np.testing.assert_allclose(spectrum.srgb_encode(x), expected, atol=2e-7)
        np.testing.assert_allclose(spectrum.srgb_decode(spectrum.srgb_encode(x)), x, atol=5e-7)
        assert np.isfinite([spectrum.srgb_encode(1e30), spectrum.srgb_decode(1e15), spectrum.srgb_decode(-1e15)]).all()
        assert spectrum.srgb_encode(0.5) == pytest.approx(0.735357, abs=1e-6)

    def test_encoded_is_cut(self):
        rgb = spectrum.to_srgb(NM, 5 * spectrum.illuminant("A", NM))
        assert np.all((rgb >= 0) & (rgb <= 1)) and rgb[0] == pytest.approx(1, abs=1e-6)

    @pytest.mark.parametrize("arguments, name", [
        ((500, 1), "wavelengths"), (([500, 400], [1, 1]), "wavelengths"), (([400, 400], [1, 1]), "wavelengths"), (([], []), "wavelengths"),
        (([[400, 500]], [1, 1]), "wavelengths"), (([100, 200], [1, 1]), "wavelengths"), (([900, 950], [1, 1]), "wavelengths"),
        (([400, 500], [1, 2, 3]), "values"), (([400, 500], 1), "values"), (([400, 500], [1, np.nan]), "values"),
        (([400, 500], [1e30, 1]), "values"), (([400, 500], [1, 1], "D66"), "illuminant"), (([400, 500], [1, 1], [1, 1, 1]), "illuminant"),
        (([400, 500], [1, 1], [0, 0]), "illuminant"), (([400, 500], [1, 1], [-1, 1]), "illuminant")])
    def test_wrong(self, arguments, name):
        for function in (spectrum.to_xyz, spectrum.to_srgb):
            with pytest.raises(aureole.Error, match=f"^{name}: "):
                function(*arguments)

    def test_wrong_shapes(self):
        for function, argument in ((spectrum.xyz_to_srgb, "xyz"), (lambda rgb: spectrum.upsample(rgb, 500), "rgb")):
            for wrong in (1.0, [1, 2], np.zeros((3, 2)), [1, 2, np.nan], [1, 2, np.inf]):
                with pytest.raises(aureole.Error, match=f"^{argument}: "):
                    function(wrong)
            assert function(np.zeros((0, 3))).shape[0] == 0


class TestUpsample:
    @pytest.mark.parametrize("method, tolerance", [("fit", 1e-4), ("table", 3e-3)])
    def test_round_trip(self, method, tolerance):
        rgb = np.random.default_rng(3).uniform(0.02, 0.98, (50, 3))
        s = spectrum.upsample(rgb, NM, method=method)
        assert s.shape == (50, NM.size) and np.all((s >= 0) & (s <= 1))
        np.testing.assert_allclose(spectrum.to_srgb(NM, s, "D65", encoded=False), rgb, atol=tolerance + 2e-4)

    def test_greys(self):
        for v in (0.0, 0.25, 1.0):
            for method in ("fit", "table"):
                np.testing.assert_allclose(spectrum.upsample([v, v, v], NM, method=method), v, atol=1e-6)

    @pytest.mark.parametrize("method", ["fit", "table"])
    def test_unbounded(self, method):
        rgb = np.array([8.0, 2.0, 0.5])
        s = spectrum.upsample(rgb, NM, unbounded=True, method=method)
        light = spectrum.to_srgb(NM, s * spectrum.illuminant("D65", NM), encoded=False)
        np.testing.assert_allclose(light, rgb, atol=0.05)
        np.testing.assert_array_equal(spectrum.upsample([0, 0, 0], NM, unbounded=True, method=method), 0)

    @pytest.mark.parametrize("method", ["fit", "table"])
    def test_near_white(self, method):
        rgb = np.array([[0.99, 0.999, 0.99], [0.98, 1, 0.985], [1, 0.99, 0.98]])
        s = spectrum.upsample(rgb, NM, method=method)
        assert np.all(s >= 1 - 2 * (1 - rgb.min(axis=1, keepdims=True))) and np.all(s <= 1)
        np.testing.assert_allclose(spectrum.to_srgb(NM, s, "D65", encoded=False), rgb, atol=4e-4)

    def test_shapes_and_ends(self):
        s = spectrum.upsample(np.full((2, 4, 3), [0.2, 0.5, 0.1]), [[300, 360], [830, 900]])
        assert s.shape == (2, 4, 2, 2)
        np.testing.assert_allclose(s[..., 0, 0], s[..., 0, 1])
        assert spectrum.upsample([0.1, 0.2, 0.3], 500).shape == ()

    def test_wrong(self):
        for keywords in ({"rgb": [1.1, 0, 0]}, {"rgb": [-0.1, 0, 0], "unbounded": True}, {"rgb": [1e31, 0, 0], "unbounded": True},
                         {"method": "spline"}, {"wavelength": -1}, {"wavelength": np.inf}):
            with pytest.raises(aureole.Error, match=f"^{list(keywords)[0]}: "):
                spectrum.upsample(**{"rgb": [0.1, 0.2, 0.3], "wavelength": 500, **keywords})
        with pytest.raises(TypeError, match="^unbounded: "):
            spectrum.upsample([0.1, 0.2, 0.3], 500, unbounded=1)
        with pytest.raises(aureole.Error, match="at most"):
            spectrum.upsample(np.zeros((10**5, 3)), np.full(10**5, 500.0))


class TestRefractiveIndex:
    def test_published_values(self):
        """Data sheet of Schott N-BK7: F, d, C lines; water at 589.3 nm and 20 C (Daimon & Masumura 2007): 1.33334 in vacuum."""
        np.testing.assert_allclose(spectrum.refractive_index("bk7", [486.1327, 587.5618, 656.2725]), [1.52238, 1.51680, 1.51432], atol=6e-6)
        assert spectrum.refractive_index("water", 589.3) == pytest.approx(1.3334, abs=4e-4)
        assert spectrum.refractive_index("bk7", 500, dispersion=False) == 1.5046

    def test_all(self):
        for name in spectrum.materials():
            info = spectrum.material(name)
            low, high = (info.minimum, info.maximum) if info.dispersive else (360, 830)
            index = spectrum.refractive_index(name, np.linspace(low, high, 500))
            assert np.iscomplexobj(index) == info.absorbing and np.all(np.isfinite(index)) and np.all(np.real(index) >= 0)
            assert info.source and (np.all(index.imag >= 0) if info.absorbing else np.all(index > 0))
            result = np.empty(500, complex)
            aureole._aureole.refractive_index(name, True, np.linspace(low, high, 500), result)
            assert info.absorbing == bool(np.any(result.imag > 0)), name

    def test_wrong(self):
        with pytest.raises(aureole.Error, match="^wavelength: expected 300 to 2500 nm, .*bk7, got 200"):
            spectrum.refractive_index("bk7", [500, 200])
        with pytest.raises(aureole.Error, match='^name: there is no material "bk8".*bk7'):
            spectrum.refractive_index("bk8", 500)
        for name in (None, 5, b"bk7"):
            with pytest.raises(TypeError, match="^name: "):
                spectrum.refractive_index(name, 500)
        with pytest.raises(TypeError, match="^dispersion: "):
            spectrum.refractive_index("bk7", 500, dispersion="yes")
        with pytest.raises(aureole.Error, match="^name: "):
            spectrum.material("\0")


FUNCTIONS = {
    "observer": (spectrum.observer, "wavelength", [500.0, 600.0], (3,)),
    "illuminant": (lambda wavelength: spectrum.illuminant("A", wavelength), "wavelength", [500.0, 600.0], ()),
    "blackbody": (lambda wavelength: spectrum.blackbody(3000, wavelength), "wavelength", [500.0, 600.0], ()),
    "temperature": (lambda temperature: spectrum.blackbody(temperature, 500), "temperature", [500.0, 600.0], ()),
    "index": (lambda wavelength: spectrum.refractive_index("bk7", wavelength), "wavelength", [500.0, 600.0], ()),
    "metal": (lambda wavelength: spectrum.refractive_index("Au", wavelength), "wavelength", [500.0, 600.0], ()),
    "encode": (spectrum.srgb_encode, "linear", [0.25, 0.5], ()),
    "decode": (spectrum.srgb_decode, "encoded", [0.25, 0.5], ()),
    "upsample": (lambda wavelength: spectrum.upsample([0.1, 0.2, 0.3], wavelength), "wavelength", [500.0, 600.0], ()),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_formats(name):
    function, argument, values, more = FUNCTIONS[name]
    values = np.array(values)
    expected = function(values)
    assert np.shape(expected) == (2,) + more
    for same in (list(values), values.astype(np.float32), values.astype(">f8"), np.repeat(values, 2)[::2], values[::-1].copy()[::-1],
                 np.ma.masked_array(values), np.longdouble(values)):
        np.testing.assert_array_equal(function(same), expected)
    for shape in ((), (0,), (3, 0, 2), (2, 3)):
        assert np.shape(function(np.full(shape, values[0]))) == shape + more
    for wrong in ("red", None, object(), [1, [2]], True, 1j, np.array([1], object), np.ma.masked_array([500.0], [True]), np.nan, [500, np.inf]):
        with pytest.raises((TypeError, aureole.Error), match=f"^{argument}: "):
            function(wrong)
    if name not in ("encode", "decode"):
        with pytest.raises(aureole.Error, match=f"^{argument}: "):
            function(-values)


def test_examples():
    assert doctest.testmod(spectrum).failed == 0


def test_documented():
    for name in spectrum.__all__:
        assert getattr(spectrum, name).__doc__, name
