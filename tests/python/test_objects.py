# SPDX-License-Identifier: Apache-2.0
"""Plug-in objects over arrays: values against closed forms, broadcasting, bad input."""
from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import aureole

GOLD = '<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.2"/></bsdf>'
MIRROR_GGX = '<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/></bsdf>'
ROUGH_GLASS = '<bsdf type="roughdielectric"><float name="alpha" value="0.3"/></bsdf>'
LAYER = '<bsdf type="correlated_scatterers"><string name="radius" value="3um"/><float name="area_fraction" value="0.3"/></bsdf>'
BSDFS = {"diffuse": '<bsdf type="diffuse"/>', "gold": GOLD, "rough glass": ROUGH_GLASS, "layer": LAYER,
         "bumps": '<bsdf type="bumpmap"><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf>'}


def directions(random, *shape, both_sides=False):
    z = random.uniform(-1 if both_sides else 0.02, 1, shape)
    phi = random.uniform(0, 2 * np.pi, shape)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


@pytest.fixture
def random():
    return np.random.default_rng(7)


@pytest.fixture(scope="module", params=BSDFS, ids=lambda name: name.replace(" ", "_"))
def any_bsdf(request):
    return aureole.load_string(BSDFS[request.param])


# ---------------------------------------------------------------- values


def test_lambert(random):
    bsdf = aureole.load_dict({"type": "diffuse", "reflectance": 0.25})
    wi, wo = directions(random, 100, both_sides=True), directions(random, 100, both_sides=True)
    seen = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    np.testing.assert_allclose(bsdf.eval(wi, wo, 550), np.where(seen, 0.25 / np.pi * wo[:, 2], 0), rtol=1e-6)
    np.testing.assert_allclose(bsdf.pdf(wi, wo, 550), np.where(seen, wo[:, 2] / np.pi, 0), rtol=1e-6)


def test_ggx_mirror(random):
    """Torrance and Sparrow's model, written here in double precision."""
    bsdf, a2 = aureole.load_string(MIRROR_GGX), 0.3**2
    wi, wo = directions(random, 500), directions(random, 500)
    m = wi + wo
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    d = a2 / (np.pi * (m[:, 2] ** 2 * (a2 - 1) + 1) ** 2)

    def g1(w):
        return 2 * w[:, 2] / (w[:, 2] + np.sqrt(a2 + (1 - a2) * w[:, 2] ** 2))

    np.testing.assert_allclose(bsdf.eval(wi, wo, 500), d * g1(wi) * g1(wo) / (4 * wi[:, 2]), rtol=2e-5)
    np.testing.assert_allclose(bsdf.pdf(wi, wo, 500), d * g1(wi) / (4 * wi[:, 2]), rtol=2e-5)


def test_conductor_has_fresnel_reflectance():
    bsdf = aureole.load_dict({"type": "conductor", "eta": 0.2, "k": 3.0})
    s = bsdf.sample((0, 0, 1), 500, (0.5, 0.5, 0.5))
    assert s.is_delta and s.valid
    np.testing.assert_allclose(s.weight, ((0.2 - 1) ** 2 + 9) / ((0.2 + 1) ** 2 + 9), rtol=1e-5)
    np.testing.assert_allclose(s.wo, (0, 0, 1), atol=1e-7)
    assert bsdf.eval((0, 0, 1), (0, 0, 1), 500) == 0  # a delta has no value


def test_same_bits_alone_and_in_a_batch(any_bsdf, random):
    n = 150
    wi, wo, nm = directions(random, n), directions(random, n, both_sides=True), random.uniform(360, 830, n)
    wi[50:90], wo[50:75] = wi[50], wo[50]  # runs that share directions
    for function in (any_bsdf.eval, any_bsdf.pdf):
        batch = function(wi, wo, nm)
        assert batch.tolist() == [function(wi[i], wo[i], nm[i]) for i in range(n)]
        grid = function(wi[:20, None], wo[:20, None], nm[:30])
        assert grid.tolist() == [[function(wi[i], wo[i], nm[j]) for j in range(30)] for i in range(20)]
        assert np.count_nonzero(batch) > n / 10


def test_sample_agrees_with_eval_and_pdf(any_bsdf, random):
    wi, nm = directions(random, 400), random.uniform(360, 830, 400)
    s = any_bsdf.sample(wi, nm, random.random((400, 3)))
    smooth = s.valid & ~s.is_delta
    assert smooth.sum() > 20
    wi, wo, nm = wi[smooth], s.wo[smooth], nm[smooth]
    np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1, atol=1e-6)
    np.testing.assert_allclose(any_bsdf.eval(wi, wo, nm), s.value[smooth], rtol=1e-4)
    np.testing.assert_allclose(any_bsdf.pdf(wi, wo, nm), s.pdf[smooth], rtol=1e-4)


def test_sample_of_nothing_is_zero():
    s = aureole.load_dict({"type": "diffuse"}).sample([(0, 0, 1), (0, 0, -1)], 500, (0.1, 0.2, 0.3))
    assert s.valid.tolist() == [True, False]
    assert s.wo[1].tolist() == [0, 0, 0] and s.value[1] == 0 and s.pdf[1] == 0 and s.weight[1] == 0 and s.lobe[1] == 0


def test_refraction_and_transport_modes():
    bsdf = aureole.load_string('<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>')
    u = (0.99, 0.5, 0.5)
    radiance, importance = (bsdf.sample((0.6, 0, 0.8), 500, u, mode=mode) for mode in ("radiance", "importance"))
    np.testing.assert_allclose(radiance.wo, (-0.4, 0, -np.sqrt(1 - 0.16)), atol=1e-6)
    assert radiance.eta == 1.5 and radiance.lobe == aureole.Lobe.delta | aureole.Lobe.transmit
    np.testing.assert_allclose(importance.weight, 1, rtol=1e-6)
    np.testing.assert_allclose(radiance.weight, 1 / 1.5**2, rtol=1e-6)  # radiance mode: light comes out of the glass


@pytest.mark.parametrize("xml", ['<bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf>', '<bsdf type="dielectric"/>',
                                 '<bsdf type="conductor"/>', '<bsdf type="thindielectric"/>'])
def test_albedo_of_what_absorbs_nothing(xml):
    bsdf = aureole.load_string(xml)
    theta = np.linspace(0, 1.5, 7)
    np.testing.assert_allclose(bsdf.albedo(theta, 550), 1, rtol=2e-6)
    parts = bsdf.albedo(theta, 550, part="reflect") + bsdf.albedo(theta, 550, part="transmit")
    np.testing.assert_allclose(parts, 1, rtol=2e-6)


def test_albedo_against_quadrature():
    """GGX with alpha 0.3, integrated with a product rule."""
    bsdf = aureole.load_string(MIRROR_GGX)
    z, w = np.polynomial.legendre.leggauss(400)
    z, w = 0.5 * (z + 1), 0.5 * w
    phi = 2 * np.pi * (np.arange(400) + 0.5) / 400
    r = np.sqrt(1 - z * z)[:, None]
    wo = np.stack([r * np.cos(phi), r * np.sin(phi), np.broadcast_to(z[:, None], (400, 400))], axis=-1)
    for theta in (0.0, 0.7, 1.3):
        exact = np.sum(bsdf.eval((np.sin(theta), 0, np.cos(theta)), wo, 500) * w[:, None]) * 2 * np.pi / 400
        albedo, error = bsdf.albedo(theta, 500, samples=8192, return_error=True)
        assert error < 2e-3 and abs(albedo - exact) < 5 * error + 1e-4
    # An element depends on its own arguments only.
    assert bsdf.albedo([0.3, 0.7], [400, 500])[1] == bsdf.albedo(0.7, 500)
    assert bsdf.albedo(0.7, 500, seed=1) != bsdf.albedo(0.7, 500)
    assert bsdf.albedo(2.0, 500) == 0


# ---------------------------------------------------------------- arrays


def test_scalars_lists_and_shapes():
    bsdf = aureole.load_dict({"type": "diffuse"})
    value = bsdf.eval((0, 0, 1), [0, 0.6, 0.8], 550)
    assert isinstance(value, float) and value == bsdf.eval(np.array([0, 0, 1]), np.float32([0, 0.6, 0.8]), np.int16(550))
    assert bsdf.eval((0, 0, 1), (0, 0, 1), [500]).shape == (1,)
    assert bsdf.eval(np.zeros((0, 3)), (0, 0, 1), 500).shape == (0,)
    assert bsdf.eval(np.zeros((0, 1, 3)), (0, 0, 1), np.full(5, 500.0)).shape == (0, 5)
    assert bsdf.sample(np.zeros((0, 3)), 500, (0, 0, 0)).wo.shape == (0, 3)
    up = np.broadcast_to((0.0, 0.0, 1.0), (4, 1, 3))
    assert bsdf.eval(up, up[0], np.full((2, 1, 6), 500.0)).shape == (2, 4, 6)
    s = bsdf.sample(up, np.full(6, 500), np.full((2, 4, 1, 3), 0.5))
    assert s.wo.shape == (2, 4, 6, 3) and s.pdf.shape == s.valid.shape == s.is_delta.shape == (2, 4, 6)
    assert bsdf.eval(up, up, 500).dtype == np.float64


def test_strides_and_types_change_nothing(any_bsdf, random):
    wi = directions(random, 6, 5).astype(np.float32).astype(np.float64)
    wo = directions(random, 6, 5, both_sides=True).astype(np.float32).astype(np.float64)
    nm = random.uniform(360, 830, (6, 5)).astype(np.float32).astype(np.float64)
    expected = any_bsdf.eval(wi, wo, nm)
    single = [a.astype(np.float32) for a in (wi, wo, nm)]
    assert np.array_equal(any_bsdf.eval(*single), expected)
    assert np.array_equal(any_bsdf.eval(wi, single[1], nm), expected)
    assert np.array_equal(any_bsdf.eval(single[0], wo, nm), expected)
    for change in (np.asfortranarray, lambda a: a[::-1, ::-1][::-1, ::-1], lambda a: np.repeat(a, 2, axis=1)[:, ::2],
                   lambda a: a.astype(">f8"), lambda a: a.astype(np.longdouble)):
        assert np.array_equal(any_bsdf.eval(change(wi), change(wo), change(nm)), expected)
    assert np.array_equal(any_bsdf.eval(wi[::-1], wo[::-1], nm[::-1]), expected[::-1])
    assert np.array_equal(any_bsdf.eval(wi.transpose(1, 0, 2), wo.transpose(1, 0, 2), nm.T), expected.T)
    record = np.zeros(30, np.dtype([("c", "u1"), ("w", "f8", 3)]))  # not aligned
    record["w"] = wi.reshape(-1, 3)
    assert np.array_equal(any_bsdf.eval(record["w"], wo.reshape(-1, 3), nm.ravel()), expected.ravel())


def test_texture_coordinates_broadcast(random):
    bsdf = aureole.load_string('<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf>')
    uv = random.random((50, 2))
    values = bsdf.eval((0, 0, 1), (0, 0, 1), np.array([[400], [500], [600]]), uv=uv) * np.pi
    expected = np.where((uv[:, 0] < 0.5) == (uv[:, 1] < 0.5), values[0, 0], 0.6 - values[0, 0])
    np.testing.assert_allclose(values, np.broadcast_to(expected, (3, 50)), rtol=1e-5)
    assert len(np.unique(values.round(5))) == 2


def test_nearly_unit_directions_are_normalised():
    bsdf = aureole.load_dict({"type": "diffuse"})
    assert bsdf.eval((0, 0, 1), (0, 0.6003, 0.8004), 500) == pytest.approx(0.5 / np.pi * 0.8, rel=1e-6)


SHAPES = hnp.mutually_broadcastable_shapes(num_shapes=4, max_dims=4, max_side=4, min_side=0)


@settings(max_examples=150, deadline=None)
@given(SHAPES, st.tuples(*[st.sampled_from(["f4", "f8"])] * 3), st.integers(0, 2**32 - 1))
def test_any_shapes(shapes, types, seed):
    random, bsdf = np.random.default_rng(seed), aureole.load_string(GOLD)
    wi, wo = directions(random, *shapes.input_shapes[0]).astype(types[0]), directions(random, *shapes.input_shapes[1]).astype(types[1])
    nm, uv = random.uniform(361, 829, shapes.input_shapes[2]).astype(types[2]), random.random((*shapes.input_shapes[3], 2))
    values = bsdf.eval(wi, wo, nm, uv=uv)
    assert values.shape == shapes.result_shape
    full = [np.broadcast_to(a, (*shapes.result_shape, 3)).reshape(-1, 3) for a in (wi, wo)]
    flat = np.broadcast_to(nm, shapes.result_shape).ravel()
    assert np.asarray(values).ravel().tolist() == [bsdf.eval(full[0][i], full[1][i], flat[i]) for i in range(flat.size)]


ANYTHING = st.one_of(st.none(), st.booleans(), st.floats(), st.text(max_size=3), st.lists(st.floats(), max_size=4), st.complex_numbers(),
                     hnp.arrays(st.one_of(hnp.floating_dtypes(), hnp.integer_dtypes(), hnp.boolean_dtypes(), hnp.byte_string_dtypes(max_len=2)),
                                hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3)))


@functools.lru_cache(maxsize=None)
def objects_for_anything():
    return tuple(aureole.load_string(text) for text in (LAYER, '<emitter type="constant"/>', '<texture type="checkerboard"/>'))


@settings(max_examples=300, deadline=None)
@given(ANYTHING, ANYTHING, ANYTHING, ANYTHING)
def test_anything_is_a_value_or_an_exception(a, b, c, d):
    bsdf, light, texture = objects_for_anything()
    up = (0, 0, 1)
    for call in (lambda: bsdf.eval(a, b, c, uv=d), lambda: bsdf.eval(up, up, c, uv=d), lambda: bsdf.sample(up, b, c),
                 lambda: bsdf.sample(a, 500, (0, 0, 0)), lambda: bsdf.albedo(a, b, samples=8), lambda: light.eval(a, b),
                 lambda: light.sample_direct(a, 500, b), lambda: texture.eval(a, uv=b), lambda: texture.eval_scalar(a), lambda: light.power(a)):
        try:
            call()
        except (aureole.Error, TypeError) as e:
            assert str(e)


# ---------------------------------------------------------------- bad input

UP = (0.0, 0.0, 1.0)


@pytest.mark.parametrize("arguments, error, message", [
    (dict(wi=(0, 0, 2)), aureole.Error, r"wi: expected unit vectors, got \(0, 0, 2\) of length 2$"),
    (dict(wi=[[UP], [(0, 0, np.nan)]]), aureole.Error, r"wi: .*nan\) at index \(1, 0\)$"),
    (dict(wo=[UP, UP, (np.inf, 0, 0)]), aureole.Error, r"wo: .*inf.* at index 2$"),
    (dict(wo=[UP] * 20 + [(1, 1, 1)]), aureole.Error, "wo: .* at index 20$"),
    (dict(wi=(0, 0)), aureole.Error, r"wi: expected the shape \(..., 3\), got \(2,\)"),
    (dict(wo=1.0), aureole.Error, r"wo: expected the shape \(..., 3\), got \(\)"),
    (dict(wavelength=[500, 830.5]), aureole.Error, "wavelength: expected 360 to 830 nm, .* got 830.5 at index 1$"),
    (dict(wavelength=[[500] * 9, [500] * 8 + [359]]), aureole.Error, r"wavelength: .* got 359 at index \(1, 8\)$"),
    (dict(wavelength=np.nan), aureole.Error, "wavelength: .* got nan$"),
    (dict(wavelength=0.55), aureole.Error, "wavelength: .* nm"),
    (dict(wi=[UP, UP], wo=[UP, UP, UP]), aureole.Error, r"do not broadcast.* wi \(2,\), wo \(3,\)$"),
    (dict(uv=(0.1, np.nan)), aureole.Error, "uv: expected finite"),
    (dict(uv=0.5), aureole.Error, r"uv: expected the shape \(..., 2\)"),
    (dict(mode="photons"), aureole.Error, 'mode: expected "radiance" or "importance", got "photons"'),
    (dict(seed=-1), aureole.Error, "seed: expected 0 to"),
    (dict(wi="up"), TypeError, "wi: expected real numbers, got str"),
    (dict(wi=[(0, 0, 1), (0, 1)]), TypeError, "wi: expected an array of real numbers, got a ragged list"),
    (dict(wi=np.array([0, 0, 1j])), TypeError, "wi: expected real numbers, got an array of complex128"),
    (dict(wavelength=True), TypeError, "wavelength: expected real numbers, got bool"),
    (dict(wavelength=None), TypeError, "wavelength: expected real numbers"),
    (dict(uv={}), TypeError, "uv: expected real numbers"),
])
@pytest.mark.parametrize("method", ["eval", "pdf"])
def test_bad_arguments(method, arguments, error, message):
    bsdf = aureole.load_dict({"type": "diffuse"})
    with pytest.raises(error, match=message):
        getattr(bsdf, method)(**{**dict(wi=UP, wo=UP, wavelength=500), **arguments})


@pytest.mark.parametrize("arguments, message", [
    (dict(u=(0, 0, 1.0)), r"u: expected numbers in \[0, 1\), got 1$"),
    (dict(u=[(0, 0, 0), (np.nan, 0, 0)]), r"u: .* got nan at index 1$"),
    (dict(u=0.5), r"u: expected the shape \(..., 3\)"),
    (dict(wi=(1, 1, 0)), "wi: expected unit vectors"),
    (dict(wavelength=1000), "wavelength: expected 360 to 830"),
])
def test_bad_arguments_of_sample(arguments, message):
    with pytest.raises(aureole.Error, match=message):
        aureole.load_dict({"type": "diffuse"}).sample(**{**dict(wi=UP, wavelength=500, u=(0, 0, 0)), **arguments})


@pytest.mark.parametrize("arguments, message", [
    (dict(theta=[0, 4.0]), "theta: expected angles from 0 to pi rad, got 4 at index 1"),
    (dict(phi=np.inf), "phi: expected finite"),
    (dict(samples=1), "samples: expected 8 to"),
    (dict(part="half"), 'part: expected "all", "reflect" or "transmit"'),
    (dict(wavelength=np.nan), "wavelength: "),
])
def test_bad_arguments_of_albedo(arguments, message):
    with pytest.raises(aureole.Error, match=message):
        aureole.load_dict({"type": "diffuse"}).albedo(**{**dict(theta=0, wavelength=500), **arguments})


def test_a_mesh_attribute_has_no_values_alone():
    xml = '<bsdf type="diffuse"><texture name="reflectance" type="mesh_attribute"><string name="name" value="vertex_c"/></texture></bsdf>'
    with pytest.raises(aureole.Error, match="mesh_attribute"):
        aureole.load_string(xml).eval(UP, UP, 500)


# ---------------------------------------------------------------- other objects


def test_attributes():
    bsdf = aureole.load_string('<bsdf type="twosided" id="metal">' + GOLD + "</bsdf>")
    assert (bsdf.id, bsdf.type, bsdf.family) == ("metal", "twosided", "bsdf")
    assert bsdf.lobes == ("glossy", "reflect")
    (child,) = bsdf.children
    assert child.type == "roughconductor" and child.parameters["material"] == "Au"
    assert child.parameters["alpha"] == pytest.approx(0.2)
    assert bsdf.parameters["bsdf"].type == "roughconductor"
    assert repr(child).startswith("Bsdf('roughconductor', material='Au', alpha=0.2")


def test_spectra_and_textures(random):
    spectrum = aureole.load_string('<bsdf type="diffuse"><spectrum name="reflectance" value="400:0.2, 600:0.6"/></bsdf>').parameters["reflectance"]
    assert spectrum == {"type": "spectrum", "value": [(400.0, 0.2), (600.0, 0.6)]}
    checks = aureole.load_string('<texture type="checkerboard"/>')
    uv = random.random((40, 2))
    np.testing.assert_allclose(checks.eval([[500]], uv=uv), checks.eval_scalar(uv)[None], rtol=1e-6)
    assert not checks.is_constant and checks.mean(500) == pytest.approx(0.3)


def test_emitters():
    point = aureole.load_string('<emitter type="point"><spectrum name="intensity" value="2"/><point name="position" value="1, 2, 3"/></emitter>')
    np.testing.assert_allclose(point.intensity(directions(np.random.default_rng(1), 9), 500), 2, rtol=1e-5)
    np.testing.assert_allclose(point.power(500), 8 * np.pi, rtol=1e-6)
    s = point.sample_direct([(1, 2, 1), (1, 2, 3)], 500, (0, 0))
    assert s.valid.tolist() == [True, False] and s.is_delta
    np.testing.assert_allclose(s.wo[0], (0, 0, 1)), np.testing.assert_allclose((s.radiance[0], s.distance[0]), (0.5, 2))
    with pytest.raises(aureole.Error, match="no radiance"):
        point.eval(UP, 500)
    sky = aureole.load_string('<emitter type="constant"><spectrum name="radiance" value="400:1, 600:3"/></emitter>')
    np.testing.assert_allclose(sky.eval(UP, [420, 500, 580]), [1.2, 2, 2.8], rtol=1e-4)
    s = sky.sample_direct((0, 0, 0), 500, np.random.default_rng(1).random((100, 2)))
    assert np.isinf(s.distance).all() and np.allclose(s.pdf, 1 / (4 * np.pi)) and np.allclose(s.radiance, 2)
    area = aureole.load_string('<emitter type="area"><spectrum name="radiance" value="3"/></emitter>')
    assert area.eval([UP, (0, 0, -1)], 500).tolist() == [3, 0]
    for call in (lambda: area.power(500), lambda: area.sample_direct(UP, 500, (0, 0)), lambda: sky.intensity(UP, 500)):
        with pytest.raises(aureole.Error):
            call()


def test_apertures():
    circle = aureole.load_string('<aperture type="circle"><string name="radius" value="2um"/></aperture>')
    assert circle.area == pytest.approx(np.pi * 4e-12)
    zero = 3.8317059702075125 / 2e-6
    values = circle.transform([(0, 0), (zero, 0), (0, zero)])
    np.testing.assert_allclose(values / circle.area, [1, 0, 0], atol=1e-9)
    assert (circle.fraction, circle.rotation, circle.is_randomly_rotated) == (1, 0, False)
    with pytest.raises(aureole.Error, match="q: expected finite"):
        circle.transform((np.nan, 0))


def test_the_shape_of_an_aperture():
    aperture = aureole.load_dict({"type": "ngon", "sides": 6, "radius": "4um"})
    shape = aperture.shape
    q = np.linspace(0, 3e6, 40).reshape(-1, 2)
    np.testing.assert_array_equal(shape.transform(q), aperture.transform(q))
    assert shape.area == aperture.area


def test_large_arrays_are_shared_out_and_stay_the_same():
    random = np.random.default_rng(3)
    bsdf = aureole.load_dict({"type": "roughconductor", "alpha": 0.2})
    n = 50_001
    z, phi = random.random((2, n)), 2 * np.pi * random.random((2, n))
    r = np.sqrt(1 - z * z)
    wi, wo = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    nm = 400 + 300 * random.random(n)
    whole = bsdf.eval(wi, wo, nm)
    pieces = np.concatenate([bsdf.eval(wi[i:i + 97], wo[i:i + 97], nm[i:i + 97]) for i in range(0, n, 97)])
    np.testing.assert_array_equal(whole, pieces)
    table = bsdf.eval(wi[:3000, None], wo[:3000, None], nm[:17])
    np.testing.assert_array_equal(table, np.stack([bsdf.eval(wi[:3000], wo[:3000], x) for x in nm[:17]], axis=-1))
    wo[40_000, 1] = np.nan
    with pytest.raises(aureole.Error, match="wo.*40000"):
        bsdf.eval(wi, wo, nm)
