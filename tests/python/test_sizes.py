# SPDX-License-Identifier: Apache-2.0
"""Distributions of radii against the closed forms of their moments."""
from __future__ import annotations

import numpy as np
import pytest

import aureole
from aureole import optics


def check(d, effective_radius, effective_variance):
    assert d.weight.sum() == pytest.approx(1)
    assert (np.diff(d.radius) > 0).all()
    assert d.effective_radius == pytest.approx(effective_radius, rel=1e-3)
    assert d.effective_variance == pytest.approx(effective_variance, rel=1e-2)
    mean = [(d.weight * d.radius**k).sum() for k in (2, 3)]
    assert mean[1] / mean[0] == pytest.approx(effective_radius, rel=5e-3)
    assert d.mean_area == pytest.approx(np.pi * mean[0], rel=5e-3)
    assert d.mean_volume == pytest.approx(4 / 3 * np.pi * mean[1], rel=5e-3)


def test_log_normal():
    """Moments exp(k mu + k^2 s^2/2)."""
    s = 0.4
    check(optics.size_distribution("log_normal", 2e-6, spread=s), 2e-6 * np.exp(2.5 * s * s), np.exp(s * s) - 1)
    one = optics.size_distribution("log_normal", 2e-6)
    assert one.radius == pytest.approx([2e-6]) and one.effective_variance == pytest.approx(0, abs=1e-12)


def test_gamma():
    check(optics.size_distribution("gamma", 5e-6, effective_variance=0.1), 5e-6, 0.1)


def test_modified_gamma():
    """With gamma = 1 a gamma distribution: effective radius (alpha + 3)/alpha times the mode, variance 1/(alpha + 3)."""
    check(optics.size_distribution("modified_gamma", 4e-6, alpha=6, gamma=1), 6e-6, 1 / 9)


@pytest.mark.parametrize("arguments, message", [
    (("normal", 1e-6), "kind"), (("gamma", -1e-6), "radius"), (("gamma", [1e-6]), "radius"), (("gamma", np.nan), "radius")])
def test_bad_input(arguments, message):
    with pytest.raises(aureole.Error, match=message):
        optics.size_distribution(*arguments)
    with pytest.raises(aureole.Error, match="spread"):
        optics.size_distribution("log_normal", 1e-6, spread=2)
