# SPDX-License-Identifier: Apache-2.0
"""aureole.optics.PlaneStack against closed forms: shapes, arguments and errors; its physics is tested in C++."""
import numpy as np
import pytest

import aureole
from aureole.optics import PlaneStack, StackLayer


def test_two_streams_are_kubelka_and_munk_at_every_wavelength():
    sigma_s, thickness, ground = np.array([0.3, 0.9, 2.0]), np.array([[0.1], [3.0]]), 0.5
    stack = PlaneStack([StackLayer(thickness, 0.1, sigma_s, g=0.4)], substrate=ground, streams=2, delta_m=False)
    k, s = 2 * 0.1, sigma_s * (1 - 0.75 * 0.4)
    a = 1 + k / s
    b = np.sqrt(a * a - 1)
    coth = b / np.tanh(b * s * thickness)
    assert stack.shape == (2, 3)
    np.testing.assert_allclose(stack.fluxes().reflectance, (1 - ground * (a - coth)) / (a - ground + coth), rtol=1e-12)
    fields = stack.fields(0, [0, 0.05])
    assert fields.flux_down.shape == (2, 3, 2)
    np.testing.assert_allclose(fields.absorption_down, np.broadcast_to(k, (2, 3, 2)), rtol=1e-9)
    np.testing.assert_allclose(fields.backscatter_up, np.broadcast_to(s[:, None], (2, 3, 2)), rtol=1e-9)


def test_phase_functions_by_number_moments_and_table_agree():
    l, mu = np.arange(200), -np.cos(np.linspace(0, np.pi, 4001))
    p = (1 - 0.36) / (1 + 0.36 - 1.2 * mu) ** 1.5
    results = [PlaneStack([StackLayer(1, 0.1, 0.9, **phase)], streams=16).radiance([0.3, -0.8], [0, 1, 3], cosine=0.6)
               for phase in ({"g": 0.6}, {"moments": 0.6 ** l}, {"table": (mu, p)})]
    assert results[0].shape == (2, 3)
    np.testing.assert_allclose(results[1], results[0], rtol=1e-9)
    np.testing.assert_allclose(results[2], results[0], rtol=1e-4)


def test_half_space_and_interfaces():
    # 0.259919: discrete ordinates and adding-doubling programs.
    assert PlaneStack([StackLayer(np.inf, 0.1, 0.9, index=1.5)], streams=64).fluxes(1).reflectance == pytest.approx(0.259919, abs=1e-6)
    rough = PlaneStack([StackLayer(1, 0, 1, index=[1.2, 1.5], interface="ggx", alpha=0.3)], bottom_interface="beckmann", streams=8)
    for light in ({"cosine": 0.4}, {"from_below": True}):
        np.testing.assert_allclose(rough.fluxes(**light).absorptance, 0, atol=1e-9)


LAYER = StackLayer(1, 0.1, 0.9)


@pytest.mark.parametrize("call, message", [
    (lambda: PlaneStack([]), "layers: expected at least one"),
    (lambda: PlaneStack([LAYER], streams=3), "streams: expected an even number"),
    (lambda: PlaneStack([LAYER], substrate=2), "substrate: expected at most 1"),
    (lambda: PlaneStack([LAYER, StackLayer(-1)]), r"layers\[1\].thickness: expected at least 0"),
    (lambda: PlaneStack([StackLayer(1, interface="rough")]), r"layers\[0\].interface: expected 'smooth'"),
    (lambda: PlaneStack([StackLayer(1, index=1.5, interface="ggx", alpha=0.01)]), "roughness of the interface above layer 0"),
    (lambda: PlaneStack([StackLayer(1, moments=[0.5])]), "first moment of a phase function must be 1"),
    (lambda: PlaneStack([StackLayer([1, 2]), StackLayer([1, 2, 3])]), "broadcasting"),
    (lambda: PlaneStack([LAYER]).fluxes(0), "cosine: expected a number in"),
    (lambda: PlaneStack([LAYER], substrate=0).fluxes(from_below=True), "substrate"),
    (lambda: PlaneStack([LAYER]).fields(1, 0), "layer: expected one of 0 to 0"),
    (lambda: PlaneStack([LAYER]).fields(0, 2), "depth in layer 0"),
])
def test_errors(call, message):
    with pytest.raises(aureole.Error, match=message):
        call()
