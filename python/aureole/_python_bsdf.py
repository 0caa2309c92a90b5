# SPDX-License-Identifier: Apache-2.0
"""BSDFs that are written in Python: the base class, and the adapter between such a class and the renderer."""
from __future__ import annotations

import atexit
import inspect
import weakref
from typing import Any, Callable, Dict, FrozenSet, Optional, Set, Tuple

import numpy as np
import numpy.typing as npt

from ._arrays import _where, real
from ._aureole import Bsdf, python_bsdf
from ._errors import Error
from ._objects import BsdfSample, FloatArray, Lobe

_LOBES = ("diffuse", "glossy", "delta", "reflect", "transmit")


class PythonBsdf:
    """A BSDF written in Python: slow, and good for trying an idea.

    A derived class has `eval`; where it reflects on the side of wi only, that is enough. With `pdf` and `sample` of its own there is less
    noise. All methods take arrays of n rows and return arrays of n: in `Bsdf.eval` one call for all elements, in a render rows for the 8
    wavelengths of a path. Directions are unit vectors in the frame of the surface, z its normal, and point away from it; wi is given, wo is
    sampled. A method may have the further parameters `uv` (shape (n, 2)) and `mode` ("radiance", where light travels from wo to wi, or
    "importance"), which it gets by name. Methods are called by several threads, one at a time.

    Attributes
    ----------
    lobes : tuple of str
        Kinds of the lobes: diffuse, glossy or delta, and reflect or transmit. A BSDF without "transmit" is black where wi and wo are on
        different sides, whatever its methods return there.
    needs_tangent : bool
        Values change when the surface is turned about its normal.

    Examples
    --------
    >>> class Lambert(aureole.PythonBsdf):
    ...     lobes = ("diffuse", "reflect")
    ...     def eval(self, wi, wo, wavelength):
    ...         return np.where((wi[:, 2] > 0) & (wo[:, 2] > 0), 0.5 / np.pi * wo[:, 2], 0)
    >>> bsdf = aureole.as_bsdf(Lambert())
    >>> bool(abs(bsdf.albedo(0.3, 550) - 0.5) < 1e-9)
    True
    """

    lobes: Tuple[str, ...] = ("glossy", "reflect")
    needs_tangent: bool = True

    def eval(self, wi: FloatArray, wo: FloatArray, wavelength: FloatArray) -> npt.ArrayLike:
        """Value f |cos theta_o| [1/sr] without delta lobes, shape (n,), for wi, wo of shape (n, 3) and wavelengths [nm] of shape (n,)."""
        raise NotImplementedError(f"{type(self).__name__} needs the method eval(wi, wo, wavelength)")

    def pdf(self, wi: FloatArray, wo: FloatArray, wavelength: FloatArray) -> npt.ArrayLike:
        """Density [1/sr] with which `sample` draws wo, shape (n,). By default the density is proportional to the
        cosine, on both sides where light is transmitted."""
        if "transmit" in self.lobes:
            return np.asarray(np.abs(wo[:, 2]) / (2 * np.pi))
        return np.where(wi[:, 2] * wo[:, 2] > 0, np.abs(wo[:, 2]), 0) / np.pi

    def sample(self, wi: FloatArray, wavelength: FloatArray, u: FloatArray) -> Any:
        """Directions drawn for n random triples u in [0, 1) of shape (n, 3).

        Returns
        -------
        wo, a tuple (wo, value, pdf) or (wo, value, pdf, valid), an aureole.BsdfSample, or None
            Directions (n, 3); their values and densities (n,), for which `eval` and `pdf` are called where only wo is
            returned; and whether each row has a direction (n,), by default where pdf > 0. None: no row has one. Only
            a `BsdfSample` can state delta lobes (`lobe`) and the ratio of refractive indices (`eta`). A wo on a side
            that `lobes` leaves out counts as no direction.
        """
        radius, phi = np.sqrt(u[:, 1]), 2 * np.pi * u[:, 2]
        z = np.copysign(np.sqrt(1 - u[:, 1]), wi[:, 2])
        if "transmit" in self.lobes:
            z = np.where(u[:, 0] < 0.5, z, -z)
        return np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)


def as_bsdf(bsdf: Any) -> Bsdf:
    """Returns the argument if it is a `Bsdf`, else a `Bsdf` that calls the methods of the argument, as of
    `PythonBsdf`."""
    return bsdf if isinstance(bsdf, Bsdf) else python_bsdf(bsdf)


class Adapter:
    """Called by C++: passes arrays to the methods of an object and checks the results.

    Messages name the class and the method.
    """

    def __init__(self, target: Any) -> None:
        self.target = target
        _living.add(self)
        self.name = type(target).__name__
        if isinstance(target, type):
            raise TypeError(f"expected an instance of the class {target.__name__}, got the class itself: write {target.__name__}()")
        self._extra: Dict[str, FrozenSet[str]] = {}
        for method in ("eval", "pdf", "sample"):
            if not callable(getattr(target, method, None)):
                raise TypeError(f"{self.name}: a BSDF needs the methods eval, pdf and sample (derive it from aureole.PythonBsdf for "
                                f"the last two); {method} is missing")
            self._extra[method] = _extra_parameters(getattr(target, method))
        self.flags = self._lobes(getattr(target, "lobes", PythonBsdf.lobes))
        self.lobes = int(self.flags)
        self.needs_tangent = bool(getattr(target, "needs_tangent", True))
        # Whether light is scattered between directions with equal and with different signs of z.
        self._reflects, self._transmits = "reflect" in _names(self.flags), "transmit" in _names(self.flags)

    def _lobes(self, names: Any) -> Lobe:
        flags = Lobe.none
        for name in (names,) if isinstance(names, str) else names:
            if name not in _LOBES:
                raise Error(f"{self.name}.lobes: {name!r} is not one of {', '.join(_LOBES)}")
            flags |= getattr(Lobe, name)
        given = _names(flags)
        if not ({"diffuse", "glossy", "delta"} & given and {"reflect", "transmit"} & given):
            raise Error(f"{self.name}.lobes: expected diffuse, glossy or delta, and reflect or transmit, got {tuple(sorted(given))}")
        return flags

    # ---------------------------------------------------------------- n rows

    def call(self, method: str, *arguments: Any, uv: FloatArray, mode: str) -> Any:
        """Returns the result of a method, unchecked."""
        further = {"uv": uv, "mode": mode}
        return getattr(self.target, method)(*arguments, **{k: further[k] for k in self._extra[method]})

    def _numbers(self, method: str, what: str, value: Any, n: int) -> FloatArray:
        """n finite numbers >= 0; one number is taken for all."""
        array = real(f"{self.name}.{method}: {what}", value, minimum=0)
        if array.shape != (n,):
            if array.shape != () and array.shape != (1,):
                raise Error(f"{self.name}.{method}: {what}: expected the shape ({n},), got {array.shape}")
            array = np.full(n, array.reshape(())[()])
        return array

    def _allowed(self, wi: FloatArray, wo: FloatArray) -> npt.NDArray[np.bool_]:
        side = wi[:, 2] * wo[:, 2]
        if self._reflects and self._transmits:
            return np.asarray((side > 0) | (side < 0))
        return np.asarray(side > 0 if self._reflects else side < 0)

    def _masked(self, method: str, what: str, wi: FloatArray, wo: FloatArray, wavelength: FloatArray, uv: FloatArray,
                mode: str, allowed: npt.NDArray[np.bool_]) -> FloatArray:
        values = self._numbers(method, what, self.call(method, wi, wo, wavelength, uv=uv, mode=mode), len(wi))
        return np.where(allowed, values, 0.0)

    def eval_rows(self, wi: FloatArray, wo: FloatArray, wavelength: FloatArray, uv: FloatArray, mode: str) -> FloatArray:
        return self._masked("eval", "values", wi, wo, wavelength, uv, mode, self._allowed(wi, wo))

    def pdf_rows(self, wi: FloatArray, wo: FloatArray, wavelength: FloatArray, uv: FloatArray, mode: str) -> FloatArray:
        return self._masked("pdf", "densities", wi, wo, wavelength, uv, mode, self._allowed(wi, wo))

    def eval_pdf_rows(self, wi: FloatArray, wo: FloatArray, wavelength: FloatArray, uv: FloatArray,
                      mode: str) -> Tuple[FloatArray, FloatArray]:
        allowed = self._allowed(wi, wo)
        return (self._masked("eval", "values", wi, wo, wavelength, uv, mode, allowed),
                self._masked("pdf", "densities", wi, wo, wavelength, uv, mode, allowed))

    def sample_rows(self, wi: FloatArray, wavelength: FloatArray, u: FloatArray, uv: FloatArray, mode: str) -> BsdfSample:
        """A sample with all arrays given and checked."""
        n, where = len(wi), f"{self.name}.sample"
        drawn = self.call("sample", wi, wavelength, u, uv=uv, mode=mode)
        if drawn is None:
            return BsdfSample(np.zeros((n, 3)), np.zeros(n), np.zeros(n), np.zeros(n, np.bool_), np.zeros(n, np.uint32), np.ones(n))
        valid: Any = None
        lobe: Any = None
        eta: Any = None
        value: Any = None
        pdf: Any = None
        if isinstance(drawn, BsdfSample):
            wo, value, pdf, valid, lobe, eta = drawn.wo, drawn.value, drawn.pdf, drawn.valid, drawn.lobe, drawn.eta
        elif not isinstance(drawn, tuple):
            wo = drawn
        elif len(drawn) in (3, 4):
            wo, value, pdf = drawn[:3]
            valid = drawn[3] if len(drawn) == 4 else None
        else:
            raise Error(f"{where}: expected wo, (wo, value, pdf) or (wo, value, pdf, valid), got {len(drawn)} parts")
        wo = np.asarray(wo)
        if wo.dtype.kind not in "fiu" or wo.shape != (n, 3):
            raise Error(f"{where}: wo: expected real numbers of the shape ({n}, 3), got {wo.dtype} of the shape {wo.shape}")
        wo = wo.astype(np.float64)
        if lobe is None:
            lobe = np.full(n, self.lobes, np.uint32)
        lobe = np.broadcast_to(np.asarray(lobe).astype(np.uint32), (n,))
        if valid is not None:
            valid = np.asarray(valid)
            if valid.dtype != np.bool_ or valid.shape != (n,):
                raise Error(f"{where}: valid: expected booleans of the shape ({n},), got {valid.dtype} of the shape {valid.shape}")
        # Entries that are not valid may hold any numbers.
        exists = np.ones(n, np.bool_) if valid is None else valid
        if valid is None and pdf is not None:
            exists = self._numbers("sample", "pdf", pdf, n) > 0
        if valid is not None or pdf is not None:
            wo = np.where(exists[:, None], wo, (0.0, 0.0, 1.0))
        length = np.sqrt(np.sum(wo * wo, axis=1))
        wrong = ~(np.abs(length - 1) <= 1e-3)
        if wrong.any():
            raise Error(f"{where}: wo: expected unit vectors, got {_vector_text(wo[wrong][0])} at index {int(np.argmax(wrong))}")
        wo = wo / length[:, None]
        exists = exists & self._allowed(wi, wo)
        if value is None or pdf is None:
            value, pdf = self.eval_pdf_rows(wi, wo, wavelength, uv, mode)
            exists = exists & (pdf > 0)
            value, pdf = np.where(exists, value, 0), np.where(exists, pdf, 0)  # these numbers were checked
        else:
            value = self._numbers("sample", "value", np.where(exists, value, 0), n)
            pdf = self._numbers("sample", "pdf", np.where(exists, pdf, 0), n)
        if (exists & ~(pdf > 0)).any():
            raise Error(f"{where}: pdf: expected positive numbers where a direction is valid, got 0 at index "
                        f"{int(np.argmax(exists & ~(pdf > 0)))}")
        eta = np.ones(n) if eta is None else np.where(exists, real(f"{where}: eta", eta, positive=True), 1.0)
        return BsdfSample(np.where(exists[:, None], wo, 0.0), value, pdf, exists, np.where(exists, lobe, 0).astype(np.uint32), eta)

    def sample_hero(self, wi: FloatArray, wavelength: FloatArray, u: FloatArray, uv: FloatArray,
                    mode: str) -> Optional[Tuple[FloatArray, FloatArray, FloatArray, int, float]]:
        """Returns the sample of the renderer: a direction for the first row's wavelength, and the values of the other
        wavelengths for it.

        Every row is sampled at its own wavelength with the same random numbers. Where all rows have one direction,
        their own values and densities are returned; else `eval` and `pdf` are called for the direction of the first
        row. A delta whose direction depends on the wavelength has no value at the wavelengths with other directions.
        """
        s = self.sample_rows(wi, wavelength, u, uv, mode)
        assert s.valid is not None and s.lobe is not None and s.eta is not None
        if not s.valid[0]:
            return None
        lobe, eta = int(s.lobe[0]), float(s.eta[0])
        same = s.valid & (np.abs(s.wo - s.wo[0]).max(axis=1) <= 1e-9) & (s.lobe == s.lobe[0])
        if lobe & int(Lobe.delta):
            return s.wo[0], np.where(same, s.value, 0.0), np.where(same, s.pdf, 0.0), lobe, eta
        if same.all():
            return s.wo[0], s.value, s.pdf, lobe, eta
        wo = np.repeat(s.wo[:1], len(wi), axis=0)
        value, pdf = self.eval_pdf_rows(wi, wo, wavelength, uv, mode)
        return s.wo[0], value, pdf, lobe, eta

    # ---------------------------------------------------------------- arrays of any shape

    def eval_array(self, wi: Any, wo: Any, wavelength: Any, uv: Any, mode: str) -> Any:
        return self._array(self.eval_rows, wi, wo, wavelength, uv, mode)

    def pdf_array(self, wi: Any, wo: Any, wavelength: Any, uv: Any, mode: str) -> Any:
        return self._array(self.pdf_rows, wi, wo, wavelength, uv, mode)

    def _array(self, method: Callable[..., FloatArray], wi: Any, wo: Any, wavelength: Any, uv: Any, mode: str) -> Any:
        rows = Rows(wi=_directions("wi", wi), wo=_directions("wo", wo), uv=_coordinates(uv), wavelength=_wavelengths(wavelength))
        values = method(rows["wi"], rows["wo"], rows["wavelength"], rows["uv"], mode) if rows.count else np.empty(0)
        return values.reshape(rows.shape)[()]

    def sample_array(self, wi: Any, wavelength: Any, u: Any, uv: Any, mode: str) -> BsdfSample:
        rows = Rows(wi=_directions("wi", wi), u=_random("u", u), uv=_coordinates(uv), wavelength=_wavelengths(wavelength))
        if not rows.count:
            empty = np.empty(rows.shape)
            return BsdfSample(np.empty((*rows.shape, 3)), empty, empty, empty.astype(np.bool_), empty.astype(np.uint32), empty)
        s = self.sample_rows(rows["wi"], rows["wavelength"], rows["u"], rows["uv"], mode)
        return BsdfSample(s.wo.reshape((*rows.shape, 3)), *(np.asarray(a).reshape(rows.shape)[()] for a in (s.value, s.pdf, s.valid, s.lobe, s.eta)))

    def albedo_array(self, theta: Any, wavelength: Any, phi: Any, uv: Any, mode: str, part: str, samples: int, seed: int,
                     return_error: bool) -> Any:
        """Implements `Bsdf.albedo`."""
        rows = Rows(theta=real("theta", theta, minimum=0, maximum=np.pi + 1e-6), phi=real("phi", phi), uv=_coordinates(uv),
                    wavelength=_wavelengths(wavelength))
        root = 1.2207440846057596
        points = np.arange(-(-samples // 8))[:, None] * np.array([1 / root, root**-2, root**-3])
        shifts = np.random.default_rng(seed).random((8, 3))
        u = (points + shifts[:, None]).reshape(-1, 3) % 1.0
        means = np.empty((rows.count, 8))
        for i in range(rows.count):
            t, p = rows["theta"][i], rows["phi"][i]
            wi = np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
            s = self.sample_rows(np.tile(wi, (len(u), 1)), np.full(len(u), rows["wavelength"][i]), u, np.tile(rows["uv"][i], (len(u), 1)), mode)
            weight = s.weight
            if part != "all":
                weight = np.where((s.wo[:, 2] * wi[2] >= 0) == (part == "reflect"), weight, 0)
            means[i] = weight.reshape(8, -1).mean(axis=1)
        mean = means.mean(axis=1).reshape(rows.shape)[()]
        error = (means.std(axis=1, ddof=1) / np.sqrt(8)).reshape(rows.shape)[()]
        return (mean, error) if return_error else mean


class Rows:
    """Arguments broadcast against each other and flattened to rows; vectors keep their last axis."""

    def __init__(self, **arguments: FloatArray) -> None:
        vectors = {"wi", "wo", "u", "uv"}
        shapes = {k: a.shape[:-1] if k in vectors else a.shape for k, a in arguments.items()}
        try:
            self.shape = np.broadcast_shapes(*shapes.values())
        except ValueError:
            text = ", ".join(f"{k} {s}" for k, s in shapes.items() if s)
            raise Error(f"the arguments do not broadcast together; their shapes, without the axis of components, are {text}") from None
        self.count = int(np.prod(self.shape, dtype=np.int64))
        self._rows = {k: np.ascontiguousarray(np.broadcast_to(a, self.shape + a.shape[len(shapes[k]):])).reshape(
            (self.count, *a.shape[len(shapes[k]):])) for k, a in arguments.items()}

    def __getitem__(self, name: str) -> FloatArray:
        return self._rows[name]


# A BSDF of a program's main module is part of a cycle that Python cannot see through C++: its class knows the module, whose variables hold
# the BSDF or a scene with it. The cycle is broken when the program ends, so that everything is freed.
_living: "weakref.WeakSet[Adapter]" = weakref.WeakSet()


@atexit.register
def _let_go() -> None:
    for adapter in list(_living):
        adapter.target = None


def _extra_parameters(method: Callable[..., Any]) -> FrozenSet[str]:
    """Which of `uv` and `mode` the method takes."""
    try:
        parameters = inspect.signature(method).parameters
    except (TypeError, ValueError):  # compiled functions
        return frozenset()
    return frozenset({"uv", "mode"} & set(parameters))


def _names(flags: Lobe) -> Set[str]:
    return {name for name in _LOBES if int(flags) & int(getattr(Lobe, name))}


def _vectors(name: str, value: Any, n: int) -> FloatArray:
    array = real(name, value)
    if array.ndim == 0 or array.shape[-1] != n:
        raise Error(f"{name}: expected the shape (..., {n}), got {array.shape}")
    return array


def _directions(name: str, value: Any) -> FloatArray:
    array = _vectors(name, value, 3)
    length = np.sqrt(np.sum(array * array, axis=-1))
    wrong = ~(np.abs(length - 1) <= 1e-3)
    if wrong.any():
        raise Error(f"{name}: expected unit vectors, got {_vector_text(array[wrong][0])} of length {length[wrong][0]:g}{_where(wrong)}")
    return np.asarray(array / length[..., None])


def _coordinates(value: Any) -> FloatArray:
    return _vectors("uv", (0.5, 0.5) if value is None else value, 2)


def _random(name: str, value: Any) -> FloatArray:
    array = _vectors(name, value, 3)
    wrong = ~((array >= 0) & (array < 1))
    if wrong.any():
        raise Error(f"{name}: expected numbers in [0, 1), got {array[wrong][0]:g}{_where(np.asarray(wrong.any(axis=-1)))}")
    return array


def _wavelengths(value: Any) -> FloatArray:
    return real("wavelength", value, positive=True, unit="nm")


def _vector_text(v: FloatArray) -> str:
    return "(" + ", ".join(f"{x:g}" for x in v) + ")"
