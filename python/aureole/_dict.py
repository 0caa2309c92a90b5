# SPDX-License-Identifier: Apache-2.0
"""Scenes as nested dicts, as Mitsuba writes them: dicts become the elements of a scene file, one on each line, so that
messages of the scene reader about a line can be given for an entry of the dict."""
from __future__ import annotations

import hashlib
import math
import os
import re
from functools import lru_cache
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from . import _aureole
from ._arrays import real, scalar, shown
from ._errors import Error, Problem, SceneError
from ._wording import in_python

_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
#: Entries that state the kind of a dict instead of being a parameter.
_SPECIAL = ("type", "id", "family")
_SPECTRUM_TYPES = ("rgb", "spectrum")
#: A dict of this type has key frames, (time, transform) pairs, under "frames"; it is no plug-in.
_ANIMATION = "animation"
_ENTITIES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})


def quoteattr(text: str) -> str:
    """Returns the value of an XML attribute, in quotes. (`xml.sax.saxutils` has such a function, but takes as long to
    import as all of this package.)"""
    return f'"{text.translate(_ENTITIES)}"'


class Plugin(NamedTuple):
    """Documentation of a plug-in; `parameters` maps names to (type, unit, default, meaning)."""

    family: str
    name: str
    summary: str
    source: str
    parameters: Dict[str, Tuple[str, str, str, str]]


@lru_cache(maxsize=None)
def plugins() -> Dict[Tuple[str, str], Plugin]:
    """All plug-ins by (family, name)."""
    return {(family, name): Plugin(family, name, summary, source, {p[0]: tuple(p[1:]) for p in parameters})
            for family, name, summary, source, parameters in _aureole.plugins()}


@lru_cache(maxsize=None)
def families() -> List[str]:
    """Returns the families of plug-ins, which are the elements of scene files."""
    return sorted({family for family, _ in plugins()})


class SceneText(NamedTuple):
    """A scene made of dicts: its text, the entry from which each line was made, and the objects that it refers to by key."""

    text: str
    places: List[str]
    given: Dict[str, Any]


class Writer:
    """Writes dicts as elements. Problems are collected, so that a user sees all of them at once."""

    def __init__(self) -> None:
        self.lines: List[str] = []
        self.places: List[str] = []
        self.given: Dict[str, Any] = {}
        self.problems: List[Problem] = []
        self._open: List[int] = []  # identities of the dicts being written, since a dict may contain itself

    def problem(self, place: str, message: str) -> None:
        self.problems.append(Problem(message, place))

    def line(self, place: str, text: str) -> None:
        if _NOT_XML.search(text):
            self.problem(place, "a name or string has characters that XML cannot hold")
            return
        self.lines.append(text)
        self.places.append(place)

    def finish(self) -> SceneText:
        if self.problems:
            raise SceneError(self.problems)
        return SceneText("\n".join(self.lines), self.places, self.given)

    # -- values ----------------------------------------------------------------------------------------------

    def entry(self, name: str, value: Any, place: str, expected: Optional[str]) -> None:
        """One parameter or child; `expected` is the type in the plug-in's table, or None where that is unknown."""
        label = f" name={quoteattr(name)}" if name else ""
        if isinstance(value, Mapping):
            self.mapping(name, value, place, expected)
        elif isinstance(value, (bool, np.bool_)):
            self.line(place, f'<boolean{label} value="{"true" if value else "false"}"/>')
        elif isinstance(value, (int, np.integer)):
            self.number(label, value, place)
        elif isinstance(value, (float, np.floating)):
            self.number(label, float(value), place)
        elif isinstance(value, (str, os.PathLike)):
            text = value if isinstance(value, str) else str(os.fspath(value))
            self.line(place, f"<string{label} value={_attribute(text)}/>")
        elif isinstance(value, (list, tuple, np.ndarray)) or hasattr(value, "__array__"):
            self.array(label, value, place, expected)
        elif value is None:
            self.problem(place, "None is no value; leave the entry out for the default")
        else:
            self.object(label, value, place)

    def number(self, label: str, value: Any, place: str) -> None:
        if isinstance(value, float):
            self.line(place, f'<float{label} value="{value!r}"/>')
        elif abs(int(value)) < 2**63:
            self.line(place, f'<integer{label} value="{int(value)}"/>')
        else:
            self.problem(place, f"the integer {shown(value)} is too large")

    def transform(self, label: str, matrix: Any, place: str) -> None:
        """An element for a matrix of shape (4, 4)."""
        values = _numbers(np.asarray(matrix, dtype=np.float64).ravel())
        self.line(place, f'<transform{label}><matrix value="{values}"/></transform>')

    def give(self, label: str, key: str, value: Any, place: str) -> None:
        """An element that stands for an object of this program."""
        self.given[key] = value
        self.line(place, f'<given{label} key="{key}"/>')

    def array(self, label: str, value: Any, place: str, expected: Optional[str]) -> None:
        try:
            numbers = np.asarray(value)
        except (ValueError, OverflowError, RecursionError):
            self.problem(place, "the list is ragged: expected numbers in a regular array")
            return
        if numbers.dtype.kind not in "fiub":
            self.problem(place, f"expected numbers, got an array of {numbers.dtype}")
            return
        if expected == "transform" or (expected is None and numbers.shape == (4, 4)):
            if numbers.shape != (4, 4):
                self.problem(place, f"a transform is a matrix of 4 x 4 numbers, got shape {numbers.shape}")
                return
            self.transform(label, numbers, place)
        elif expected != "array" and numbers.shape == (3,):
            if expected is not None and expected.split()[0] in ("spectrum", "texture"):
                self.line(place, f'<rgb{label} value="{_numbers(numbers)}"/>')
            else:
                self.line(place, f'<vector{label} value="{_numbers(numbers)}"/>')
        elif expected == "string" and numbers.ndim == 1:
            self.line(place, f'<string{label} value="{_numbers(numbers)}"/>')
        else:
            data = np.ascontiguousarray(numbers, dtype=np.float64)
            key = "array-" + hashlib.sha256(str(data.shape).encode() + data.tobytes()).hexdigest()
            self.give(label, key, _aureole.Array(data), place)

    def object(self, label: str, value: Any, place: str) -> None:
        matrix = getattr(value, "matrix", None)  # attribute of Mitsuba's transforms
        if matrix is not None and np.shape(matrix) == (4, 4):
            self.transform(label, matrix, place)
            return
        if isinstance(value, _aureole.Object):
            self.problem(place, f"this {type(value).__name__} belongs to another scene; give the dict that it is made of")
            return
        if all(callable(getattr(value, method, None)) for method in ("eval", "pdf", "sample")):
            try:
                wrapped = _aureole.python_bsdf(value)
            except (Error, TypeError, AttributeError) as e:
                self.problem(place, str(e))
                return
            self.give(label, f"python-{next(_serial)}", wrapped, place)
            return
        self.problem(place, f"{type(value).__name__} is no value of a scene: expected a number, string, boolean, list, "
                            "array, transform, dict or an object with eval, pdf and sample")

    # -- dicts -----------------------------------------------------------------------------------------------

    def mapping(self, name: str, value: Mapping[str, Any], place: str, expected: Optional[str]) -> None:
        if id(value) in self._open:
            self.problem(place, "the dict contains itself")
            return
        if len(self._open) > 200:
            self.problem(place, "dicts are nested more than 200 deep")
            return
        self._open.append(id(value))
        try:
            self._mapping(name, value, place, expected)
        finally:
            self._open.pop()

    def _mapping(self, name: str, value: Mapping[str, Any], place: str, expected: Optional[str]) -> None:
        label = f" name={quoteattr(name)}" if name else ""
        kind = value.get("type")
        if not isinstance(kind, str):
            self.problem(place, 'the dict has no "type", the name of a plug-in' if kind is None
                         else f'"type": expected a string, got {type(kind).__name__}')
            return
        if kind == "ref":
            target = value.get("id")
            if not isinstance(target, str):
                self.problem(place, 'a reference needs an "id", the name of another entry')
                return
            self.line(place, f"<ref{label} id={_attribute(target)}/>")
            return
        if kind in _SPECTRUM_TYPES and "value" in value:
            self.spectrum(kind, label, value, place)
            return
        if kind == _ANIMATION:
            self.animation(label, value, place)
            return
        family = self.family(kind, value, place, expected)
        if family is None:
            return
        known = plugins().get((family, kind))
        attributes = f" type={_attribute(kind)}{label}"
        identifier = value.get("id")
        if identifier is not None:
            if not isinstance(identifier, str):
                self.problem(f"{place}.id", f"expected a string, got {type(identifier).__name__}")
            else:
                attributes += f" id={_attribute(identifier)}"
        self.line(place, f"<{family}{attributes}>")
        for key, child in value.items():
            if key in _SPECIAL:
                continue
            if not isinstance(key, str) or not key:
                self.problem(place, f"names of parameters are strings, got {shown(key)}")
                continue
            parameter = known.parameters.get(key) if known else None
            if parameter is None and known and isinstance(child, Mapping):
                # A child under a name that the user chose, of one of the families that the plug-in accepts.
                accepted = " ".join(p[0] for p in known.parameters.values())
                self.mapping(key, child, f"{place}.{key}", accepted)
            else:
                self.entry(key, child, f"{place}.{key}", parameter[0] if parameter else None)
        self.line(place, f"</{family}>")

    def animation(self, label: str, value: Mapping[str, Any], place: str) -> None:
        """Key frames: `<animation>` with a `<transform time="...">` for each."""
        extra = [k for k in value if k not in ("type", "frames")]
        frames = value.get("frames")
        if extra or not isinstance(frames, (list, tuple)) or not frames:
            self.problem(place, f'a dict of type "{_ANIMATION}" has no entry {shown(extra[0])}' if extra else
                         'expected "frames", a list of (time in s, transform) pairs')
            return
        lines = []
        for i, frame in enumerate(frames):
            at = f"{place}.frames[{i}]"
            if not isinstance(frame, (list, tuple)) or len(frame) != 2:
                self.problem(at, f"expected a pair of a time in s and a transform, got {shown(frame)}")
                return
            time, transform = frame
            if isinstance(time, (bool, np.bool_)) or not isinstance(time, (int, float, np.integer, np.floating)) or not math.isfinite(time):
                self.problem(at, f"expected a time in s, got {shown(time)}")
                return
            matrix = getattr(transform, "matrix", transform)
            try:
                numbers = np.asarray(matrix, dtype=np.float64)
            except (TypeError, ValueError, OverflowError, RecursionError):
                numbers = np.empty(0)
            if numbers.shape != (4, 4):
                self.problem(at, f"expected a Transform or a matrix of 4 x 4 numbers, got {shown(transform)}")
                return
            lines.append((at, f'<transform time="{_number(float(time))}"><matrix value="{_numbers(numbers.ravel())}"/></transform>'))
        self.line(place, f"<animation{label}>")
        for at, line in lines:
            self.line(at, line)
        self.line(place, "</animation>")

    def spectrum(self, kind: str, label: str, value: Mapping[str, Any], place: str) -> None:
        known = ("type", "value", "id") + (("unit",) if kind == "spectrum" else ())
        extra = [k for k in value if k not in known]
        if extra:
            self.problem(place, f'a dict of type "{kind}" has no entry "{extra[0]}"')
            return
        if "unit" in value:
            if not isinstance(value["unit"], str):
                self.problem(f"{place}.unit", f"expected a string, got {type(value['unit']).__name__}")
                return
            label += f" unit={_attribute(value['unit'])}"
        if kind == "spectrum" and isinstance(value["value"], str):
            self.line(place, f"<spectrum{label} value={_attribute(value['value'])}/>")
            return
        try:
            numbers = np.asarray(value["value"], dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            self.problem(f"{place}.value", "expected numbers" if kind == "rgb" else
                         "expected a number or (wavelength in nm, value) pairs")
            return
        if kind == "rgb" and numbers.shape in ((3,), (1,), ()):
            self.line(place, f'<rgb{label} value="{_numbers(np.broadcast_to(numbers.ravel(), 3))}"/>')
        elif kind == "spectrum" and numbers.ndim == 0:
            self.line(place, f'<spectrum{label} value="{_number(float(numbers))}"/>')
        elif kind == "spectrum" and numbers.ndim == 2 and numbers.shape[1] == 2 and len(numbers) > 0:
            pairs = ", ".join(f"{_number(nm)}:{_number(v)}" for nm, v in numbers)
            self.line(place, f'<spectrum{label} value="{pairs}"/>')
        else:
            self.problem(f"{place}.value", "expected three numbers" if kind == "rgb" else
                         f"expected a number or (wavelength in nm, value) pairs, got shape {numbers.shape}")

    def family(self, kind: str, value: Mapping[str, Any], place: str, expected: Optional[str]) -> Optional[str]:
        """The family of a plug-in of that name; names that several families have are decided by the expected family."""
        given = value.get("family")
        if given is not None:
            if isinstance(given, str) and given in families():
                return str(given)
            self.problem(place, f'"family": expected one of {", ".join(families())}, got {shown(given)}')
            return None
        found = [family for family in families() if (family, kind) in plugins()]
        if len(found) > 1 and expected:
            words = re.findall(r"[a-z]+", expected)
            found = [family for family in found if family in words] or found
        if not found:  # an alias, or a name about which the reader gives the better error
            words = re.findall(r"[a-z]+", expected or "")
            found = [family for family in families() if family in words] or _alias_families(kind)
        if not found:
            self.problem(place, f'unknown type "{kind}"{_aureole.did_you_mean(kind, [n for _, n in plugins()])}')
            return None
        return sorted(found, key=_preference)[0]


def other_families(kind: Any) -> List[str]:
    """Returns the families that have a plug-in of this type, the preferred one first, if there are several; else
    nothing. For messages about a dict that does not state its family."""
    found = [family for family in families() if (family, kind) in plugins()] if isinstance(kind, str) else []
    return sorted(found, key=_preference) if len(found) > 1 else []


_serial = iter(range(1, 2**62))


def _preference(family: str) -> int:
    order = ("shape", "bsdf", "emitter", "sensor", "integrator", "texture", "film", "sampler", "rfilter")
    return order.index(family) if family in order else len(order)


def _alias_families(kind: str) -> List[str]:
    return [family for family in families() if _aureole.is_alias(family, kind)]


def _number(value: float) -> str:
    return repr(float(value))


def _numbers(values: Any) -> str:
    return ", ".join(_number(v) for v in values)


def _attribute(text: str) -> str:
    # A dollar sign is escaped, since $name would be a parameter of the scene file; line ends would become
    # blanks.
    text = text.replace("\\$", "$").replace("$", "\\$")
    return quoteattr(text)


class Transform:
    """A 4 x 4 transform of a scene, from an object's coordinates to those around it.

    Transforms are chained with ``@``, the right one acting first, as matrices are.

    Parameters
    ----------
    matrix : array_like of shape (4, 4), optional
        The identity where it is left out.

    Examples
    --------
    >>> t = Transform.translate([0, 0, 1]) @ Transform.rotate([0, 1, 0], 30)
    """

    def __init__(self, matrix: Any = None) -> None:
        m = np.eye(4) if matrix is None else real("matrix", matrix).copy()
        if m.shape != (4, 4):
            raise Error(f"matrix: expected shape (4, 4), got {m.shape}")
        self.matrix = m

    @staticmethod
    def translate(offset: Any) -> "Transform":
        """Moves by `offset`, three numbers."""
        m = np.eye(4)
        m[:3, 3] = _vector("offset", offset)
        return Transform(m)

    @staticmethod
    def scale(factor: Any) -> "Transform":
        """Scales by one number or three."""
        m = np.eye(4)
        f = real("factor", factor)
        m[[0, 1, 2], [0, 1, 2]] = f if f.ndim == 0 else _vector("factor", f)
        return Transform(m)

    @staticmethod
    def rotate(axis: Any, angle: float) -> "Transform":
        """Rotates about `axis` by `angle` in degrees, counter-clockwise as seen from its tip."""
        a = _vector("axis", axis)
        length = float(np.linalg.norm(a))
        if not length > 0:
            raise Error("axis: expected a vector that is not zero")
        x, y, z = a / length
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        t = math.radians(scalar("angle", angle, unit="degrees"))
        m = np.eye(4)
        m[:3, :3] += math.sin(t) * k + (1 - math.cos(t)) * (k @ k)
        return Transform(m)

    @staticmethod
    def look_at(origin: Any, target: Any, up: Any = (0, 1, 0)) -> "Transform":
        """Returns the transform of a sensor or spot at `origin` that faces `target`: z along the view, y near `up`."""
        o, t, u = _vector("origin", origin), _vector("target", target), _vector("up", up)
        d = t - o
        if not np.linalg.norm(d) > 0:
            raise Error("target: expected a point apart from the origin")
        d /= np.linalg.norm(d)
        left = np.cross(u, d)
        if not np.linalg.norm(left) > 0:
            raise Error("up: expected a vector that is not along the view")
        left /= np.linalg.norm(left)
        m = np.eye(4)
        m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = left, np.cross(d, left), d, o
        return Transform(m)

    def __matmul__(self, other: "Transform") -> "Transform":
        if not isinstance(other, Transform):
            return NotImplemented
        return Transform(self.matrix @ other.matrix)

    def inverse(self) -> "Transform":
        """Returns the inverse transform. Raises Error where there is none."""
        try:
            return Transform(np.linalg.inv(self.matrix))
        except np.linalg.LinAlgError:
            raise Error("the transform has no inverse") from None

    def __repr__(self) -> str:
        return f"Transform({np.array2string(self.matrix, separator=', ')})"


def _vector(name: str, value: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    v = real(name, value)
    if v.shape != (3,):
        raise Error(f"{name}: expected three finite numbers, got an array of shape {v.shape}")
    return v


def scene_text(scene: Mapping[str, Any]) -> SceneText:
    """The text of a scene given as a dict of type "scene"."""
    writer = Writer()
    writer.line("the dict", '<scene version="3.0.0">')
    for key, value in scene.items():
        if key == "type":
            continue
        if not isinstance(key, str) or not key:
            writer.problem("the dict", f"names of entries are strings, got {shown(key)}")
        elif isinstance(value, Mapping):
            entry = dict(value)
            if not isinstance(entry.get("type"), str) or entry["type"] not in ("ref",) + _SPECTRUM_TYPES:
                entry.setdefault("id", key)
            writer.mapping("", entry, key, None)
        elif callable(getattr(value, "eval", None)):  # a BSDF written in Python, for references
            writer.object(f" id={_attribute(key)}", value, key)
        else:
            writer.entry(key, value, key, None)
    writer.line("the dict", "</scene>")
    return writer.finish()


def object_text(description: Mapping[str, Any], family: Optional[str] = None) -> SceneText:
    """The text of a scene that holds one object and the objects to which it refers."""
    writer = Writer()
    writer.line("the dict", '<scene version="3.0.0">')
    writer.mapping("", description, "the dict", family)
    writer.line("the dict", "</scene>")
    return writer.finish()


def value_text(value: Any, path: str, expected: Optional[str]) -> SceneText:
    """One element without a name, for a parameter of a scene."""
    writer = Writer()
    writer.entry("", value, path, expected)
    return writer.finish()


def relocated_error(error: Error, file: str, places: List[str]) -> Error:
    """The error with entries of the dict in place of lines and elements of the text."""
    if not isinstance(error, SceneError):
        return Error(relocated_note(str(error), file, places)) if type(error) is Error else error
    moved: List[Problem] = []
    for p in error.problems:
        here = _moved(p, file, places)
        if here not in moved:
            moved.append(here)
    return SceneError(moved)


def relocated_note(note: str, file: str, places: List[str]) -> str:
    """A note with entries of the dict in place of lines and elements of the text."""
    return str(_moved(Problem.parse(note), file, places))


def _moved(p: Problem, file: str, places: List[str]) -> Problem:
    pattern = re.compile(re.escape(file) + r":(\d+):(\d+)")
    name: Callable[[Any], str] = lambda m: places[int(m[1]) - 1] if 1 <= int(m[1]) <= len(places) else m[0]
    message = in_python(pattern.sub(name, p.message))
    if p.file != file or not 1 <= p.line <= len(places):
        return Problem(message, p.file, p.line, p.column)
    return Problem(message, places[p.line - 1])
