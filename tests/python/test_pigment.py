# SPDX-License-Identifier: Apache-2.0
"""aureole.pigment: the closed forms that the C++ tests do not share, and a fit, a mixture and a match together."""
from __future__ import annotations

import doctest
import importlib
import warnings
import zipfile

import numpy as np
import pytest

import aureole
from aureole import optics, pigment


def test_layers_and_their_inverse():
    k, s = np.array([0.3, 1.0, 0.0])[:, None], np.array([2.0, 0.5])
    found = pigment.layer(k, s, 0.7)
    assert found.reflectance.shape == (3, 2)
    gamma = np.sqrt(k * (k + 2 * s))[:2]
    sinh, cosh = np.sinh(0.7 * gamma), np.cosh(0.7 * gamma)
    denominator = (k[:2] + s) * sinh + gamma * cosh
    np.testing.assert_allclose(found.reflectance[:2], s * sinh / denominator, rtol=1e-12)
    np.testing.assert_allclose(found.transmittance[:2], gamma / denominator, rtol=1e-12)
    back = pigment.coefficients(found.reflectance, found.transmittance, 0.7)
    np.testing.assert_allclose(back[0][:2], np.broadcast_to(k, (3, 2))[:2], rtol=1e-9)
    np.testing.assert_allclose(back[1], np.broadcast_to(s, (3, 2)), rtol=1e-9)
    assert pigment.k_over_s(pigment.opaque_reflectance(0.5)) == pytest.approx(0.5)


def test_interfaces():
    smooth = pigment.surface("diffuse", specular="included")
    assert smooth.seen == pytest.approx(0.0918, abs=5e-5) and smooth.k2 == pytest.approx(0.5963, abs=5e-5)
    r = np.linspace(0, 1, 11)
    np.testing.assert_allclose(smooth.inner(smooth.outer(r)), r, atol=1e-12)
    assert pigment.saunderson(0.04, 0.6).seen == 0.04
    with pytest.raises(aureole.Error, match="below what the interface itself reflects"):
        smooth.inner(0.05)


def test_differences():
    assert pigment.ciede2000([50, 2.6772, -79.7751], [50, 0, -82.7485]) == pytest.approx(2.0425, abs=5e-5)
    assert pigment.ciede2000(np.zeros((4, 3)), np.zeros(3)).shape == (4,)
    grey = pigment.lab(np.linspace(380, 780, 41), np.full((2, 41), 0.18))
    np.testing.assert_allclose(grey, [[116 * 0.18 ** (1 / 3) - 16, 0, 0]] * 2, atol=1e-9)


def test_figures_of_the_trade():
    """Numbers of tests/references/colour_figures.py; closed forms for greys."""
    a, b = [60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387]
    for formula, value in (("cie1976", 3.181924), ("cmc", 1.420486), ("cie94", 1.390995), ("cie94_textiles", 1.389733),
                           ("din99o", 1.710469)):
        assert pigment.difference(a, b, formula) == pytest.approx(value, abs=1e-5)
    assert pigment.difference(a, b, "cmc", cmc=(1, 1)) == pytest.approx(1.428230, abs=1e-5)
    nm = np.arange(360.0, 831.0)
    edge = 0.05 + 0.8 / (1 + np.exp(-(nm - 585) / 22)) + 0.12 * np.exp(-(((nm - 440) / 40) ** 2))
    np.testing.assert_allclose(pigment.lab(nm, edge, "F11/10"), [63.802258, 42.712687, 31.113900], atol=4e-4)
    white = pigment.colour(nm, 0.88 - 0.35 * np.exp(-(nm - 360) / 18), "D65/10")
    assert white.is_white and white.whiteness == pytest.approx(86.708641, abs=1e-3)
    assert white.yellowness == pytest.approx(0.435578, abs=1e-3)
    assert np.isnan(pigment.colour(nm, edge, "A").yellowness)
    seen = pigment.surface("d8", specular="included")
    grey = [seen.outer(np.full(nm.size, pigment.opaque_reflectance(q))) for q in (0.1, 0.6, 1.1)]
    found = pigment.compare(nm, grey[1], grey[2], illuminant="D65/10", others=["A/10", "D65/2"], white=grey[0], surface=seen)
    assert found.strength == pytest.approx(2) and found.strength_weighted == pytest.approx(2)
    assert found.tone_ciede2000 == pytest.approx(0, abs=1e-6) and found.metamerism["D65/2"] == pytest.approx(0, abs=1e-6)
    assert found.cie1976 == pytest.approx(-found.lab[0])
    with pytest.raises(aureole.Error, match="sample: expected 471 values"):
        pigment.compare(nm, edge, [0.5])
    with pytest.raises(aureole.Error, match="formula: expected"):
        pigment.difference(a, b, "rgb")


def test_from_measurements_to_a_recipe(tmp_path):
    palette = pigment.fit("kimera")
    assert len(palette.names) == 13 and palette.relative and palette.k.shape == (13, 170)
    assert (palette.s > 0).all() and np.isfinite(palette.k_error).all()
    np.testing.assert_array_equal(palette.k, pigment.Palette.load("kimera").k)
    recipe = {"red": 0.15, "cold yellow": 0.05, "white": 0.8}
    paint = palette.mix(recipe)
    found = palette.match(paint.reflectance())
    assert found[0].difference < 1e-3 and found[0].metamerism["A"] < 0.01
    assert found[0].recipe == pytest.approx(recipe, rel=0.01)
    by_colour = palette.match(pigment.lab(palette.nm, paint.reflectance()), paints=2, most={"white": 0.5})
    assert all(m.recipe.get("white", 0) <= 0.5 + 1e-9 and len(m.recipe) <= 2 for m in by_colour)
    thin, thick = paint.reflectance(0.1, 0.9), paint.reflectance(1e4, 0.9)
    np.testing.assert_allclose(thick, paint.reflectance(), atol=1e-9)
    assert (thin > thick)[thick < 0.7].all()  # the substrate is brighter than this paint but where that is nearly white
    table = tmp_path / "samples.csv"
    table.write_text("paints,500,600\nwhite,0.9,0.9\nred,0.2,0.5\n")
    with pytest.raises(aureole.Error, match='"red": an opaque tint with "white" is missing'):
        pigment.fit(table)


def test_recipes_with_trade_offs():
    palette = pigment.fit("kimera")
    wanted = palette.mix({"red": 0.15, "cold yellow": 0.05, "white": 0.8}).reflectance()
    prices = {name: 1.0 + i for i, name in enumerate(palette.names)}
    front = palette.match(wanted, prices=prices, trade_offs=True, within=3, solutions=50)
    for one in front:
        assert one.difference <= 3 and one.cost == pytest.approx(sum(prices[n] * f for n, f in one.recipe.items()))
        for other in front:
            assert not (other.difference < one.difference - 0.02 and other.cost < one.cost - 1e-5
                        and max(other.metamerism.values()) < max(one.metamerism.values()) - 0.02)
    assert all(not {"red", "white"} <= set(m.recipe) for m in palette.match(wanted, apart=[("red", "white")]))
    assert all(min(m.recipe.values()) >= 0.05 for m in palette.match(wanted, smallest=0.05))
    by_spectrum, by_colour = (palette.match(wanted * 0.98, by=by, solutions=1)[0] for by in ("spectrum", "colour"))
    assert by_spectrum.rms < by_colour.rms
    best = palette.match(wanted, solutions=1)[0]
    assert best.dosing_error == pytest.approx(np.sqrt(sum(d**2 for d in best.dosing.values()))) and best.contrast == 1
    hiding = palette.match(pigment.lab(palette.nm, wanted), thickness=3.0, substrate=0.8, opacity=0.95)
    assert all(0.95 <= m.contrast < 1 for m in hiding)
    for wrong, words in (({"prices": {"red": 1}}, "prices: there is no price"), ({"apart": [("red", "snow")]}, "apart: unknown paint"),
                         ({"by": "name"}, "by: expected"), ({"opacity": 0.9}, "needs a layer with a thickness")):
        with pytest.raises(aureole.Error, match=words):
            palette.match(wanted, **wrong)


def test_two_flux_error():
    """Transport of isotropic scatterers without an interface: R_inf of docs/pigments.md; Kubelka and Munk by their closed form."""
    albedo = np.array([[0.5], [0.9], [0.99]])
    found = pigment.two_flux_error(albedo, [1e3, 2e3], index=1)
    assert found.reflectance.shape == (3, 2)
    np.testing.assert_allclose(found.reflectance[:, 0], [0.1465, 0.478, 0.795], atol=5e-4)
    np.testing.assert_allclose(found.reflectance[:, 1], found.reflectance[:, 0], atol=1e-9)
    ratio = 2 * (1 - albedo[:, 0]) / (0.75 * albedo[:, 0])
    by_two = 1 + ratio - np.sqrt(ratio**2 + 2 * ratio)
    np.testing.assert_allclose(found.reflectance[:, 0] + found.error[:, 0], by_two, atol=1e-9)
    np.testing.assert_allclose(found.lightness, 116 * np.cbrt(found.reflectance) - 16, atol=1e-9)
    dark = pigment.two_flux_error(0.3, 1, 0.5, convention="diffusion")  # S is negative
    assert np.isnan(dark.error) and np.isnan(dark.lightness_error) and dark.reflectance > 0


def test_spreading_rate():
    """White that does not absorb hides at S X = 49 (0.98 = SX/(1 + SX)): 490 um of S = 1e5/m; half of that wet is 1.02 m^2/l."""
    chalk = pigment.Paint(np.array([400.0, 700.0]), np.zeros(2), np.full(2, 1e5), pigment.Surface())
    assert chalk.spreading_rate(0.5, white=1) == pytest.approx(0.5 / 0.49, rel=1e-9)


def test_hiding():
    """Without absorption R = S X/(1 + S X) over black, and over white all is reflected: a ratio of .98 at S X = 49."""
    chalk = pigment.Paint(np.array([400.0, 550, 700]), np.zeros(3), np.full(3, 1e5), pigment.Surface())
    assert chalk.contrast_ratio(49e-5, white=1) == pytest.approx(0.98, abs=1e-6)
    assert chalk.hiding_thickness(white=1) == pytest.approx(49e-5, rel=1e-5)
    assert chalk.hiding_thickness(white=1, ratio=0.5) == pytest.approx(1e-5, rel=1e-5)
    clear = pigment.Paint(chalk.nm, np.zeros(3), np.zeros(3), pigment.Surface())
    assert clear.hiding_thickness() == np.inf
    assert chalk.hiding_thickness(black=0.5, ratio=0.5) < 1e-14  # what is below hides itself
    with pytest.raises(aureole.Error, match="white: must reflect more"):
        chalk.contrast_ratio(1e-5, black=0.8, white=0.5)


FILMS = {
    "films.csv": """sample,paints,backing,thickness_um,unit,400,550,700
card,,,,percent,80,82,84
a,chalk,0,20,percent,40,45,50
b,chalk,card,20,percent,81,82.5,85
""",
    "films.cgats": """CGATS.17
KEYWORD "PAINTS"
KEYWORD "THICKNESS_UM"
SPECTRAL_NORM "100"
BEGIN_DATA_FORMAT
SAMPLE_ID PAINTS BACKING THICKNESS_UM SPECTRAL_NM400 SPECTRAL_NM550 SPECTRAL_NM700
END_DATA_FORMAT
BEGIN_DATA
card "" "" "" 80 82 84
a chalk 0 20 40 45 50
b chalk card 20 81 82.5 85
END_DATA
""",
    "films.cxf": """<?xml version="1.0"?>
<CxF xmlns="http://colorexchangeformat.com/CxF3-core"><Resources><ObjectCollection>
<Object Name="card" Id="1"><ColorValues><ReflectanceSpectrum ColorSpecification="CS">0.80 0.82 0.84</ReflectanceSpectrum></ColorValues>
<TagCollection Name="drawdown"><Tag Name="Paints" Value=""/></TagCollection></Object>
<Object Name="chalk" Id="2"><ColorValues><ReflectanceSpectrum ColorSpecification="CS">0.40 0.45 0.50</ReflectanceSpectrum></ColorValues>
<TagCollection Name="drawdown"><Tag Name="Backing" Value="0"/><Tag Name="Thickness_um" Value="20"/></TagCollection></Object>
<Object Name="chalk" Id="3"><ColorValues><ReflectanceSpectrum ColorSpecification="CS">0.81 0.825 0.85</ReflectanceSpectrum></ColorValues>
<TagCollection Name="drawdown"><Tag Name="Backing" Value="card"/><Tag Name="Thickness_um" Value="20"/></TagCollection></Object>
</ObjectCollection><ColorSpecificationCollection><ColorSpecification Id="CS"><MeasurementSpec>
<WavelengthRange StartWL="400" Increment="150"/></MeasurementSpec></ColorSpecification></ColorSpecificationCollection></Resources></CxF>
""",
}


@pytest.mark.parametrize("name", FILMS)
def test_formats_of_laboratories(name, tmp_path):
    (tmp_path / name).write_text(FILMS[name])
    palette = pigment.fit(tmp_path / name)
    assert palette.names == ("chalk",) and not palette.relative
    np.testing.assert_array_equal(palette.nm, [400, 550, 700])
    # Kubelka 1948 by its hyperbolic form, 20 um over black and over the card.
    over_black, over_card, card = np.array([0.40, 0.45, 0.50]), np.array([0.81, 0.825, 0.85]), np.array([0.80, 0.82, 0.84])
    k, s = palette.k[0], palette.s[0]
    a = (k + s) / s
    b = np.sqrt(a * a - 1)
    coth = 1 / np.tanh(b * s * 20e-6)
    np.testing.assert_allclose(1 / (a + b * coth), over_black, rtol=1e-9)
    np.testing.assert_allclose((1 - card * (a - b * coth)) / (a - card + b * coth), over_card, rtol=1e-9)


@pytest.mark.parametrize("name, old, new, place", [
    ("films.csv", "45", "x", r"films\.csv:3:\d+: .*\"x\""),
    ("films.cgats", "40 45", "40 145", r"films\.cgats:10:\d+: .*reflectance 1\.45"),
    ("films.cgats", "b chalk card", "b chalk cart", r"films\.cgats:11: .*no bare substrate \"cart\""),
    ("films.cgats", "END_DATA\n", "", r"films\.cgats:8: BEGIN_DATA does not end"),
    ("films.cxf", "0.45", "0,45", r"films\.cxf:5:\d+: expected a number, got \"0,45\""),
    ("films.cxf", ' Increment="150"', "", r"films\.cxf:3:\d+: the spectrum has no Increment"),
    ("films.cxf", "</CxF>", "", r"films\.cxf:\d+:\d+: not well-formed"),
])
def test_errors_in_files_are_located(name, old, new, place, tmp_path):
    before, found, after = FILMS[name].rpartition(old)
    assert found
    (tmp_path / name).write_text(before + new + after)
    with pytest.raises(aureole.Error, match=place):
        pigment.fit(tmp_path / name)


def grains(name):
    return aureole.load_dict({"type": "suspension", "host": 1.5, "ingredient": {
        "type": "spheres", "radius": "40nm", "int_ior": name, "volume_fraction": 0.01}})


def test_grains_by_name():
    """Rutile by DeVore's formula, and Mie's theory of one sphere, by hand."""
    nm = np.array([450.0, 589.0, 700.0])
    square = (nm * 1e-3) ** 2
    ordinary, extraordinary = np.sqrt(5.913 + 0.2441 / (square - 0.0803)), np.sqrt(7.197 + 0.3322 / (square - 0.0843))
    index = (2 * ordinary + extraordinary) / 3
    assert index[1] == pytest.approx(2.71, abs=0.005)
    efficiency = aureole.optics.mie(2 * np.pi * 40 * 1.5 / nm, index / 1.5).qsca
    for name in ("rutile", "Titanium white"):
        found = grains(name).coefficients(nm)
        np.testing.assert_allclose(found.sigma_s, 0.01 * efficiency * 3 / (4 * 40e-9), rtol=0.01)
        assert (found.sigma_a < 1e-6 * found.sigma_s).all()
    red = grains("iron oxide red").coefficients([450, 700])
    assert red.sigma_a[0] > 5 * red.sigma_a[1] > 0
    with pytest.raises(aureole.Error, match='int_ior.*did you mean "rutile"'):
        grains("rutil")


@pytest.mark.parametrize("call, words", [
    (lambda p: p.mix("magneta: 1 + white: 1"), "did you mean \"magenta\""),
    (lambda p: p.mix({"red": -1, "white": 2}), "must be positive"),
    (lambda p: p.match([1, 2]), "target: expected 3 numbers"),
    (lambda p: p.match([50, 0, 0], most={"snow": 1}), "unknown paint 'snow'"),
    (lambda p: p.match([50, 0, 0], illuminant="D66"), "D66"),
    (lambda p: p.match([50, 0, 0], paints=9), "must be from 1 to 6"),
    (lambda p: pigment.layer(-1, 1, 1), "k: expected at least 0"),
    (lambda p: pigment.coefficients(0.6, 0.6, 1), "must not exceed 1"),
    (lambda p: pigment.surface("sphere"), "geometry: expected"),
    (lambda p: pigment.two_flux_error(1.1, 1), "albedo: expected at most 1"),
    (lambda p: pigment.two_flux_error(0.5, 1, 1), "g: expected at most 0.99"),
    (lambda p: pigment.two_flux_error(0.5, 1, convention="two"), "convention: expected 'three_quarters' or"),
    (lambda p: pigment.Palette.load("missing.csv"), "no such file"),
])
def test_wrong_arguments_are_named(call, words):
    with pytest.raises(aureole.Error, match=words):
        call(pigment.Palette.load("kimera"))


def test_fluxes_within_a_layer():
    """The fluxes obey Kubelka and Munk's equations, and the ends are those of the layer and the substrate."""
    k, s, thickness, substrate = 0.4, 2.0, 1.3, 0.25
    free = pigment.layer(k, s, thickness)
    x = np.linspace(0, thickness, 2001)
    f = pigment.fluxes_within(k, s, thickness, substrate, x)
    assert f.down[0] == pytest.approx(1)
    assert f.up[0] == pytest.approx(free.reflectance + free.transmittance**2 * substrate / (1 - free.reflectance * substrate))
    assert f.up[-1] == pytest.approx(substrate * f.down[-1])
    np.testing.assert_allclose(np.gradient(f.down, x)[1:-1], (-(k + s) * f.down + s * f.up)[1:-1], atol=2e-5)
    np.testing.assert_allclose(-np.gradient(f.up, x)[1:-1], (-(k + s) * f.up + s * f.down)[1:-1], atol=2e-5)
    assert pigment.fluxes_within(k, s, [[1.0], [2.0]], 0, [0.1, 0.2]).up.shape == (2, 2)
    with pytest.raises(aureole.Error, match="^depth: expected at most the thickness"):
        pigment.fluxes_within(k, s, 1, 0, 1.5)


def test_paint_from_its_grains():
    """By hand: Mie's cross sections, the number of grains, and each convention."""
    nm, radius, fraction, binder = np.array([450.0, 550.0, 650.0]), 0.12e-6, 0.1, 1.5
    mie = aureole.optics.mie(2 * np.pi * radius * binder / (nm * 1e-9), (1.95 + 0.79j) / binder)
    per_length = fraction / (4 / 3 * np.pi * radius**3) * np.pi * radius**2
    sigma_s, sigma_a = per_length * mie.qsca, per_length * mie.qabs
    for convention, s in (("three_quarters", 0.75 * sigma_s * (1 - mie.g)), ("double_gauss", sigma_s * (1 - 0.75 * mie.g)),
                          ("diffusion", np.maximum(0.75 * sigma_s * (1 - mie.g) - sigma_a / 4, 0))):
        paint = pigment.paint_of_grains(nm, "carbon black", radius, fraction=fraction, convention=convention)
        np.testing.assert_allclose(paint.k, 2 * sigma_a, rtol=1e-9)
        np.testing.assert_allclose(paint.s, s, atol=1e-9 * sigma_s.max())
        k, unclipped = pigment.coefficients_of_transport(sigma_a, sigma_s, mie.g, convention=convention)
        np.testing.assert_allclose(k, paint.k, rtol=1e-9)
        np.testing.assert_allclose(np.maximum(unclipped, 0), s, atol=1e-9 * sigma_s.max())
    given = pigment.paint_of_grains(nm, pigment.grain_index("carbon black", nm), radius, fraction=fraction, binder=[binder] * 3)
    np.testing.assert_array_equal(given.k, pigment.paint_of_grains(nm, "carbon black", radius, fraction=fraction).k)
    white = [pigment.paint_of_grains([550], "rutile", 0.11e-6, fraction=0.15, hard_spheres=dense, spread=0.2) for dense in (False, True)]
    assert 0.5 < white[1].s[0] / white[0].s[0] < 0.95 and white[0].k[0] < 1e-9
    assert white[0].reflectance()[0] == pytest.approx(1)


@pytest.mark.parametrize("change, message", [
    ({"nm": [650, 550]}, "^nm: expected increasing"), ({"index": "rutil"}, 'did you mean "rutile"'), ({"index": 1.5 - 0.1j}, "^index: expected n"),
    ({"index": [1.5] * 4}, "^index: expected one number or 2"), ({"fraction": 0}, "^fraction: "), ({"fraction": 0.7, "hard_spheres": True}, "^fraction: "),
    ({"binder": 0.5}, "^binder: "), ({"radius": 0}, "^radius: "), ({"radius": 1.0}, "size parameter"), ({"spread": 2}, "^spread: "),
    ({"convention": "none"}, "^convention: "), ({"weighting": "mass"}, "^weighting: ")])
def test_wrong_grains(change, message):
    right = {"nm": [550, 650], "index": "rutile", "radius": 1e-7, "fraction": 0.1}
    pigment.paint_of_grains(**right)
    with pytest.raises(aureole.Error, match=message):
        pigment.paint_of_grains(**{**right, **change})


def test_index_of_grains_by_name():
    assert "rutile" in pigment.grain_names() and "titanium white" in pigment.grain_names()
    n = pigment.grain_index("Titanium White", [[500, 589.3]])
    assert n.shape == (1, 2) and n[0, 1].real == pytest.approx((2 * 2.613 + 2.909) / 3, abs=4e-3)


def test_free_films_by_both_theories(tmp_path):
    nm = np.array([400.0, 550.0, 700.0])
    k, s = np.array([2e4, 1e4, 0.0]), np.array([4e4, 3e4, 2e4])
    seen = pigment.saunderson(0.0418, 0.5963, specular="excluded")
    # N = (1 - k2 R)^2 - (k2 T)^2 for equal interfaces on both sides.
    inner = pigment.layer(k, s, 20e-6)
    free = pigment.Paint(nm, k, s, seen).free_film(20e-6)
    n = (1 - seen.k2 * inner.reflectance) ** 2 - (seen.k2 * inner.transmittance) ** 2
    np.testing.assert_allclose(free.transmittance, seen.through * inner.transmittance / n, rtol=1e-12)
    np.testing.assert_allclose(
        free.reflectance, seen.through * (inner.reflectance - seen.k2 * (inner.reflectance**2 - inner.transmittance**2)) / n, rtol=1e-12)
    # By streams: K = 2 sigma_a, S = 3/4 sigma_s (1 - g) in a slab of the binder in air, without gloss.
    by = pigment.Streams(index=1.5, g=0.7, geometry="d8", specular="excluded")
    free = pigment.Paint(nm, k, s, seen, by).free_film(20e-6)
    slab = optics.PlaneStack([optics.StackLayer(20e-6, absorption=k / 2, scattering=4 / 3 * s / 0.3, g=0.7, index=1.5)], streams=32)
    expected = slab.fluxes(cosine=np.cos(np.radians(8)))
    np.testing.assert_allclose(free.reflectance, expected.reflectance - expected.unscattered_reflectance, atol=1e-3)
    np.testing.assert_allclose(free.transmittance, expected.transmittance, atol=1e-3)
    with pytest.raises(aureole.Error, match="thickness"):
        pigment.Paint(nm, k, s, seen, by).free_film(-1)
    # A joint fit of the free film by streams has its K and S.
    rows = [f"{q},ink,none,{q},20," + ",".join(f"{x:.6f}" for x in values)
            for q, values in (("R", expected.reflectance - expected.unscattered_reflectance), ("T", expected.transmittance))]
    (tmp_path / "free.csv").write_text("sample,paints,backing,quantity,thickness_um,400,550,700\n" + "\n".join(rows) + "\n")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = pigment.joint_fit(tmp_path / "free.csv", theory="streams", geometry="d8", index=1.5, g=0.7, noise=1e-3)
    ink = found.palette.mix("ink")
    np.testing.assert_allclose(ink.k[:2], k[:2], rtol=0.1)
    np.testing.assert_allclose(ink.s, s, rtol=0.1)


def test_examples_of_the_modules():
    for module in ("_paint_colours", "_paint_fits", "_paint_layers", "_paint_palettes"):
        assert doctest.testmod(importlib.import_module(f"aureole.{module}"), optionflags=doctest.ELLIPSIS).failed == 0


def _films(path, hidden=False):
    """Films by the closed forms, over two cards: white, red and their mixtures."""
    nm = np.arange(400, 701, 20)
    paints = {"white": (0.01 + 0 * nm, 8 * (550 / nm) ** 1.3), "red": (0.05 + 8 / (1 + np.exp((nm - 580) / 15)), 1.5 + 0 * nm)}
    seen = pigment.saunderson(0.0418, 0.5963, specular="excluded")
    lines = ["sample,specimen,paints,backing," + ",".join(str(int(x)) for x in nm)]
    for number, share in enumerate((0, 1, 0.1, 0.3, 0.5)):
        k, s = (share * paints["red"][i] + (1 - share) * paints["white"][i] for i in (0, 1))
        recipe = " + ".join(f"{name}: {part}" for name, part in (("red", share), ("white", 1 - share)) if part > 0)
        free = pigment.layer(k, s, 1)
        for card in (0.05, 0.8):
            outer = seen.outer(free.reflectance + free.transmittance**2 * card / (1 - free.reflectance * card))
            lines.append(f"{number} on {card},{number},{recipe},{card}," + ",".join(f"{v:.6f}" for v in outer))
    path.write_text("\n".join(lines) + "\n")
    return nm, paints, seen


def test_joint_fit(tmp_path):
    nm, paints, seen = _films(tmp_path / "films.csv")
    found = pigment.joint_fit(tmp_path / "films.csv", theory="two-flux", surface=seen, noise=0.001, thickness_error=0.001,
                              amount_error=0.001, hold_out=["3"])
    assert found.palette.relative
    white = found.palette.names.index("white")
    np.testing.assert_allclose(found.palette.s[white], paints["white"][1], rtol=0.08)
    assert all(s.rms < 0.005 for s in found.specimens)
    assert [h.specimen for h in found.held_out] == ["3"]
    assert found.held_out[0].difference < 1
    assert found.ratio_error.shape == (2, nm.size)
    with pytest.raises(aureole.Error, match="no specimen is called"):
        pigment.joint_fit(tmp_path / "films.csv", theory="two-flux", hold_out="x")
    assert found.g.size == 0
    streams = pigment.joint_fit(tmp_path / "films.csv", theory="streams", geometry="d8", g=0.7, g_error=0.2)
    assert streams.g.shape == streams.g_error.shape == (2,) and np.all(np.abs(streams.g - 0.7) < 0.15)
    for wrong, said in ((dict(theory="streams", surface=seen), "surface: is for the theory"), (dict(theory="two-flux", g_error=0.1), "g_error: is for the theory"),
                        (dict(theory="two-flux", surface=seen, geometry="d8"), "surface: stands for an interface by itself")):
        with pytest.raises(aureole.Error, match=said):
            pigment.joint_fit(tmp_path / "films.csv", **wrong)


def test_joint_fits_state_noise_and_theory(tmp_path):
    _films(tmp_path / "films.csv")
    errors = [np.median(pigment.joint_fit(tmp_path / "films.csv", theory="two-flux", noise=0.001, relative_noise=relative).palette.s_error)
              for relative in (0, 0.2)]
    assert errors[1] > 2 * errors[0]
    with pytest.raises(aureole.Error, match="^relative_noise: "):
        pigment.joint_fit(tmp_path / "films.csv", theory="two-flux", relative_noise=-1)
    with pytest.warns(UserWarning, match="no interface is taken off"):
        pigment.joint_fit(tmp_path / "films.csv", theory="streams")


def test_palettes_by_streams_predict_by_streams(tmp_path):
    palette = tmp_path / "palette.csv"
    palette.write_text("unit,film\ntheory,streams\nstreams index,1.5\nstreams g,0.5\nstreams geometry,diffuse\n"
                       "nm,a K,a S,b K,b S\n400,0.2,3,1,0.3\n550,0.4,2.5,0.5,0.2\n700,0.1,2,2,0.1\n")
    paints = pigment.Palette.load(palette)
    assert paints.streams == pigment.Streams(1.5, 0.5, "diffuse", "excluded")
    mixed = paints.mix("a: 0.7 + b: 0.3")
    k, s = (0.7 * of[0] + 0.3 * of[1] for of in (paints.k, paints.s))
    for thickness in (0.5, 1.0, 4.0):
        # The solver of stacks has the film over a Lambertian substrate as it is; gloss is what a black film reflects.
        layers = [optics.StackLayer(thickness, absorption=k / 2, scattering=4 / 3 * s / 0.5, g=0.5, index=1.5)]
        black = optics.PlaneStack([optics.StackLayer(thickness, absorption=np.full(3, 1e4), scattering=0.0, g=0.0, index=1.5)],
                                  index_below=1.5, streams=64)
        gloss = black.fluxes().reflectance
        for substrate in (0.0, 0.8):
            stack = optics.PlaneStack(layers, index_below=1.5, substrate=substrate, streams=64)
            np.testing.assert_allclose(mixed.reflectance(thickness, substrate), stack.fluxes().reflectance - gloss, atol=2e-3)
    thin, deep = mixed.contrast_ratio(0.5), mixed.contrast_ratio(4)
    assert thin < deep < 1 and 0.97 < mixed.contrast_ratio(mixed.hiding_thickness()) < 0.99
    found = paints.match(mixed.reflectance(1.0, 0.8), paints=2, thickness=1.0, substrate=0.8)
    assert found[0].recipe["a"] == pytest.approx(0.7, abs=0.01) and found[0].difference < 0.05
    np.testing.assert_allclose(found[0].reflectance, mixed.reflectance(1.0, 0.8), atol=1e-3)


def test_the_better_theory_of_a_joint_fit_is_kept(tmp_path):
    _films(tmp_path / "films.csv")
    found = pigment.joint_fit(tmp_path / "films.csv", geometry="d8", noise=0.002, relative_noise=0, hold_out="each")
    assert {t.name for t in found.theories} == {"two fluxes", "streams"}
    kept = [t for t in found.theories if t.is_kept]
    assert len(kept) == 1 and kept[0].difference == min(t.difference for t in found.theories)
    assert (found.palette.streams is not None) == (kept[0].name == "streams")
    assert kept[0].difference == pytest.approx(np.mean([h.difference for h in found.held_out]), rel=1e-6)
    assert 0 < kept[0].coverage <= 1
    residuals = found.residuals
    assert 0 < residuals.degrees_of_freedom < residuals.values <= 160 and residuals.relative > 0
    assert residuals.k_error.shape == residuals.s_error.shape == residuals.ratio_error.shape == found.palette.k.shape
    assert (np.median(residuals.s_error) < np.median(found.palette.s_error / found.palette.s)) == (residuals.relative < 1)


def test_a_joint_fit_takes_the_stated_geometry(tmp_path):
    table = "SAMPLE_NAME PAINTS BACKING nm400 nm700\nEND_DATA_FORMAT\nBEGIN_DATA\n" \
        'a white 0.1 .8 .7\nb white 0.8 .88 .85\nc "red: 1 + white: 9" 0.1 .5 .7\nd "red: 1 + white: 9" 0.8 .52 .8\nEND_DATA\n'
    stated, plain = tmp_path / "stated.cgats", tmp_path / "plain.cgats"
    stated.write_text('MEASUREMENT_GEOMETRY "45/0"\nBEGIN_DATA_FORMAT\n' + table)
    plain.write_text("BEGIN_DATA_FORMAT\n" + table)
    for theory in ("two-flux", "streams"):
        with pytest.warns(UserWarning, match="was measured at the geometry 45_0"):
            found = pigment.joint_fit(stated, theory=theory)
        given = pigment.joint_fit(plain, theory=theory, geometry="45_0")
        np.testing.assert_array_equal(found.palette.k, given.palette.k)
        assert found.palette.surface == given.palette.surface
        with pytest.warns(UserWarning, match="the arguments, which differ, are taken"):
            pigment.joint_fit(stated, theory=theory, geometry="d8")


def test_notes_are_warnings(tmp_path):
    table = tmp_path / "percent.csv"
    table.write_text("paints,400,700\nwhite,90,91\n")
    with pytest.warns(UserWarning, match="taken for per cent"):
        pigment.fit(table)


def test_several_files_and_their_geometry(tmp_path):
    head = 'MEASUREMENT_GEOMETRY "d/8 SCI"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME PAINTS nm400 nm700\nEND_DATA_FORMAT\nBEGIN_DATA\n'
    one, two = tmp_path / "one.cgats", tmp_path / "two.cgats"
    one.write_text(head + 'a white .9 .8\nb red .1 .5\nEND_DATA\n')
    two.write_text(head + 'c "red: 1 + white: 9" .5 .7\nEND_DATA\n')
    with pytest.warns(UserWarning, match="d8, specular included"):
        stated = pigment.fit([one, two])
    given = pigment.fit([one, two], surface=pigment.surface("d8", specular="included"))
    np.testing.assert_array_equal(stated.k, given.k)
    assert stated.surface == given.surface and stated.names == ("white", "red")


def _write_xlsx(path, rows):
    """A workbook of one sheet, with texts in their cells."""
    def cell(at, value):
        if isinstance(value, str):
            return f'<c r="{at}" t="inlineStr"><is><t>{value}</t></is></c>'
        return f'<c r="{at}"><v>{value}</v></c>'

    data = "".join(f'<row r="{r}">' + "".join(cell(f"{chr(65 + c)}{r}", v) for c, v in enumerate(row)) + "</row>"
                   for r, row in enumerate(rows, 1))
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    kinds = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    with zipfile.ZipFile(path, "w") as book:
        book.writestr("[Content_Types].xml", f'<Types xmlns="{package}/content-types">'
                      '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                      '<Default Extension="xml" ContentType="application/xml"/></Types>')
        book.writestr("_rels/.rels", f'<Relationships xmlns="{package}/relationships"><Relationship Id="a" '
                      f'Type="{kinds}/officeDocument" Target="xl/workbook.xml"/></Relationships>')
        book.writestr("xl/workbook.xml", f'<workbook xmlns="{main}" xmlns:r="{kinds}"><sheets>'
                      '<sheet name="paints" sheetId="1" r:id="b"/></sheets></workbook>')
        book.writestr("xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{package}/relationships"><Relationship Id="b" '
                      f'Type="{kinds}/worksheet" Target="worksheets/sheet1.xml"/></Relationships>')
        book.writestr("xl/worksheets/sheet1.xml", f'<worksheet xmlns="{main}"><sheetData>{data}</sheetData></worksheet>')


def test_spreadsheets(tmp_path):
    pytest.importorskip("python_calamine")
    rows = [["paints", "unit", 400, 550, 700], ["white", "percent", 90, 91.5, 92], ["red", "percent", 5, 6, 60],
            ["red: 1 + white: 9", "percent", 40, 42, 85]]
    _write_xlsx(tmp_path / "paints.xlsx", rows)
    (tmp_path / "paints.csv").write_text("\n".join(",".join(map(str, row)) for row in rows))
    sheet, text = pigment.fit(tmp_path / "paints.xlsx"), pigment.fit(tmp_path / "paints.csv")
    assert sheet.names == text.names
    np.testing.assert_array_equal(sheet.k, text.k)
    rows[2][3] = "dark"
    _write_xlsx(tmp_path / "wrong.xlsx", rows)
    with pytest.raises(aureole.Error, match=r'wrong.xlsx:3:\d+: expected a number, got "dark"'):
        pigment.fit(tmp_path / "wrong.xlsx")
