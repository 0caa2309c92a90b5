# SPDX-License-Identifier: Apache-2.0
"""BSDFs written in Python, evaluated for `aureole.check` with many directions in each call."""
from __future__ import annotations

from typing import Any, Tuple

import numpy as np
import numpy.typing as npt

from ._errors import Error
from ._objects import Lobe
from ._python_bsdf import Adapter

Array = npt.NDArray[np.float64]


class _Lenient(Adapter):
    """An adapter that accepts invalid numbers, since the check is meant to find them."""

    def _numbers(self, method: str, what: str, value: Any, n: int) -> Array:
        array = np.asarray(value)
        if array.dtype.kind not in "fiu":
            raise TypeError(f"{self.name}.{method}: {what}: expected real numbers, got {array.dtype}")
        if array.shape not in ((), (1,), (n,)):
            raise Error(f"{self.name}.{method}: {what}: expected the shape ({n},), got {array.shape}")
        array = array.astype(np.float64, copy=False)
        return array if array.shape == (n,) else np.broadcast_to(array, (n,))


class Batch:
    """Called by C++ with n directions and the m wavelengths of a path; directions are sampled for the first
    wavelength."""

    def __init__(self, instance: Any) -> None:
        self.adapter = _Lenient(instance)
        self.lobes = self.adapter.lobes
        self._takes_uv = any("uv" in names for names in self.adapter._extra.values())

    def _rows(self, n: int, m: int, wavelengths: Array, *vectors: Array) -> Tuple[Array, ...]:
        """Returns each row of the vectors m times, the wavelengths n times, and texture coordinates."""
        uv = np.broadcast_to(np.array([0.31, 0.64]), (n * m, 2))
        return (*(np.repeat(v, m, axis=0) for v in vectors), np.tile(wavelengths, n), uv.copy() if self._takes_uv else uv)

    def eval_pdf(self, wi: Array, wo: Array, wavelengths: Array, mode: str) -> Tuple[Array, Array]:
        """Values and densities, (n, m)."""
        n, m = len(wi), len(wavelengths)
        i, o, nm, uv = self._rows(n, m, wavelengths, wi, wo)
        value, pdf = self.adapter.eval_pdf_rows(i, o, nm, uv, mode)
        return np.ascontiguousarray(value).reshape(n, m), np.ascontiguousarray(pdf).reshape(n, m)

    def sample(self, wi: Array, u: Array, wavelengths: Array, mode: str) -> Tuple[Array, Array, Array, Array]:
        """Returns sampled directions (n, 3), values and densities (n, m), and an array (n, 3) of validity, lobe and
        ratio of indices, as in a render (`Adapter.sample_hero`)."""
        n, m = len(wi), len(wavelengths)
        i, random, nm, uv = self._rows(n, m, wavelengths, wi, u)
        s = self.adapter.sample_rows(i, nm, random, uv, mode)
        assert s.valid is not None and s.lobe is not None and s.eta is not None
        wo = s.wo.reshape(n, m, 3)
        value, pdf = np.array(s.value).reshape(n, m), np.array(s.pdf).reshape(n, m)
        valid, lobe = s.valid.reshape(n, m), s.lobe.reshape(n, m)
        same = valid & (np.abs(wo - wo[:, :1]).max(-1) <= 1e-9) & (lobe == lobe[:, :1])
        first = lobe[:, 0].astype(np.int64)
        delta = (first & int(Lobe.delta)) != 0
        value[delta] = np.where(same[delta], value[delta], 0.0)
        pdf[delta] = np.where(same[delta], pdf[delta], 0.0)
        other = np.flatnonzero(~delta & ~same.all(1) & valid[:, 0])
        if other.size:
            value[other], pdf[other] = self.eval_pdf(wi[other], wo[other, 0], wavelengths, mode)
        # The side determines the lobe where a class does not state which of its lobes was sampled.
        same_side = wi[:, 2] * wo[:, 0, 2] > 0
        both = int(Lobe.reflect) | int(Lobe.transmit)
        unsaid = (first & both) == both
        first = np.where(unsaid, first & ~np.where(same_side, int(Lobe.transmit), int(Lobe.reflect)), first)
        about = np.stack([valid[:, 0], first, s.eta.reshape(n, m)[:, 0]], -1).astype(np.float64)
        return np.ascontiguousarray(wo[:, 0]), value, pdf, about
