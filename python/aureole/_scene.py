# SPDX-License-Identifier: Apache-2.0
"""Scenes: loaded from files, text or dicts, with parameters that can be read and written by path."""
from __future__ import annotations

import os
import re
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _aureole
from ._dict import SceneText, Transform, object_text, other_families, plugins, relocated_error, relocated_note, scene_text, value_text
from ._arrays import file_path, real, shown, text as checked_text
from ._bars import LoadBar, LoadReport
from ._errors import Error, Problem, SceneError
from ._wording import in_python

_DICT_FILE = "<dict>"
_TEXT_FILE = "<string>"


class ParameterError(Error, KeyError):
    """A path that names no parameter of the scene."""

    __str__ = Error.__str__


class Scene:
    """A scene, ready to render, whose parameters can be read and written by path.

    Made by `load_file`, `load_string` or `load_dict`. A path is a chain of names joined by points: the id of an object
    (or its name or family, where it has no id), then names of parameters and nested objects. References are followed:
    a change of their object holds for all that refer to it. After a change meshes, their acceleration structure, textures and
    materials that it does not touch are kept. A render goes on with the scene as it was when it
    began, whatever changes meanwhile.

    Examples
    --------
    >>> scene = aureole.load_file("scene.xml")                        # doctest: +SKIP
    >>> scene["glass.bsdf.area_fraction"] = 0.4                       # doctest: +SKIP
    >>> scene.update({"lamp.emitter.radiance": 2.0, "sensor.fov": 30})  # several changes, one rebuild; doctest: +SKIP
    """

    def __init__(self, opened: _aureole.OpenScene, places: "Optional[List[str]]" = None) -> None:
        if not isinstance(opened, _aureole.OpenScene):
            raise TypeError(f"opened: scenes are made by load_file, load_string and load_dict, not of {type(opened).__name__}")
        self._open = opened
        self._places = places  # of a scene made of dicts: the entry that each line of its text came from

    def __reduce__(self) -> Any:
        raise TypeError("a Scene cannot be pickled or copied: pass the file, XML (Scene.xml) or dictionary it was made of and load it there; "
                        "pictures (aureole.Image) can be pickled")

    # -- parameters ----------------------------------------------------------------------------------------------

    def paths(self) -> List[str]:
        """Paths of all objects and parameters that the scene states, in its order."""
        return list(self._open.paths())

    def __iter__(self) -> Iterator[str]:
        return iter(self.paths())

    def __contains__(self, path: object) -> bool:
        try:
            return isinstance(path, str) and bool(self._open.value(checked_text("path", path))[0])
        except Error:
            return False

    def __len__(self) -> int:
        return len(self.paths())

    def __getitem__(self, path: str) -> Any:
        """The value at a path: a number, string, boolean, array (vector, rgb, spectrum as rows of nm and value), `Transform`
        or object. For a parameter that is not stated the default is returned, or None where there is no default."""
        _require_path(path)
        try:
            found, value = self._open.value(path)
            if found:
                return _value(value)
            family, kind = self._open.owner(path)
        except SceneError:
            raise
        except Error as e:
            raise ParameterError(str(e)) from None
        plugin = plugins().get((family, kind))
        parameter = plugin.parameters.get(path.rsplit(".", 1)[-1]) if plugin else None
        return _default(parameter[2], parameter[0]) if parameter else None

    def __setitem__(self, path: str, value: Any) -> None:
        """Changes a parameter or a nested object (given as a dict or a Python-written BSDF). All or nothing: where the new
        value is wrong, `SceneError` says why and the scene stays as it was."""
        self.update({path: value})

    def __delitem__(self, path: str) -> None:
        """Takes a parameter away, so that its default holds."""
        _require_path(path)
        if path not in self:
            raise ParameterError(f"nothing is stated at {path!r}")
        self._open.set([(path, "")], {})

    def update(self, changes: "Mapping[str, Any]", *, progress: "Union[bool, LoadReport]" = True) -> None:
        """Several changes at once, with one rebuild.

        Parameters
        ----------
        changes : mapping of str to values
        progress : bool or callable
            As for `load_file`.
        """
        if not isinstance(changes, Mapping):
            raise TypeError(f"changes: expected a dict of paths and values, got {type(changes).__name__}")
        texts: List[Tuple[str, str]] = []
        given: Dict[str, Any] = {}
        problems: List[Problem] = []
        for path, value in changes.items():
            _require_path(path)
            try:
                expected = self._expected(path)
                text = value_text(value, path, expected)
            except SceneError as e:
                problems += e.problems
                continue
            texts.append((path, text.text.replace("\n", "")))
            given.update(text.given)
        if problems:
            raise SceneError(problems)
        try:
            with LoadBar("the scene", progress, shows_time=False):  # a change may come many times in a second
                self._open.set(texts, given)
        except Error as e:
            error = self._in_words(e)
            raise SceneError([_of_change(p) for p in error.problems]) if isinstance(error, SceneError) else error from None

    def _in_words(self, error: Error) -> Error:
        """An error of the scene, with entries in place of lines if it was made of dicts."""
        return error if self._places is None else relocated_error(error, _DICT_FILE, self._places)

    def _expected(self, path: str) -> Optional[str]:
        """The type of a parameter in its plug-in's table."""
        try:
            self._open.value(path)
            parent = path.rsplit(".", 1)
            if len(parent) == 1:
                return None
            family, kind = self._open.owner(parent[0])
        except SceneError:
            raise
        except Error as e:
            raise ParameterError(str(e)) from None
        plugin = plugins().get((family, kind))
        parameter = plugin.parameters.get(parent[1]) if plugin else None
        return parameter[0] if parameter else None

    def parameters(self, prefix: str = "") -> Dict[str, Any]:
        """Stated parameters (not objects) by path, of the object `prefix` or of the whole scene."""
        if not isinstance(prefix, str):
            raise TypeError(f"prefix: expected a string, got {type(prefix).__name__}")
        result: Dict[str, Any] = {}
        for path in self.paths():
            if prefix and path != prefix and not path.startswith(prefix + "."):
                continue
            value = self[path]
            if not isinstance(value, _aureole.Object):
                result[path] = value
        return result

    def xml(self) -> str:
        """The scene as it is now, as the text of a scene file (Mitsuba 3's XML): references to files are absolute, and
        includes, defaults and names of older versions are gone. Raises `Error` where arrays or BSDFs of Python are in it."""
        return str(self._open.xml())

    # -- what is known of it ------------------------------------------------------------------------------------

    @property
    def notes(self) -> List[str]:
        """Notes of the scene reader: parameters without effect, replaced plug-ins, ..."""
        notes = list(self._open.notes)
        return notes if self._places is None else [relocated_note(note, _DICT_FILE, self._places) for note in notes]

    @property
    def size(self) -> Tuple[int, int]:
        """(width, height) of the picture in pixels."""
        w, h = self._open.size
        return int(w), int(h)

    @property
    def sample_count(self) -> int:
        """Default number of samples per pixel of `render`."""
        return int(self._open.sample_count)

    @property
    def wavelength_range(self) -> Tuple[float, float]:
        """Shortest and longest wavelength [nm] that the sensor sees."""
        a, b = self._open.wavelength_range
        return float(a), float(b)

    @property
    def bounds(self) -> "Optional[np.ndarray[Any, np.dtype[np.float64]]]":
        """Lower and upper corner of all shapes, shape (2, 3); None for a scene without shapes."""
        b = self._open.bounds
        return None if b is None else np.array(b, dtype=np.float64)

    @property
    def hash(self) -> int:
        """A hash of the scene's content, as in the header of pictures."""
        return int(self._open.hash)

    def __repr__(self) -> str:
        w, h = self.size
        file = os.path.basename(self._open.file)  # texts and dicts are taken for files of the working folder
        file = file if file in (_TEXT_FILE, _DICT_FILE) else self._open.file
        return f"<aureole.Scene {file}, {w} x {h} pixels, {self.sample_count} samples per pixel>"


def _require_path(path: Any) -> None:
    checked_text("path", path)
    if not path:
        raise ParameterError('path: expected a chain of names such as "glass.bsdf.alpha", got an empty string')


def _value(value: Any) -> Any:
    if isinstance(value, tuple):
        kind, numbers = value
        if kind == "animation":  # key frames: times in seconds and transforms
            return [(time, _value(frame)) for time, frame in numbers]
        array = np.array(numbers, dtype=np.float64)
        return Transform(array) if kind == "transform" else array
    return value


def _default(text: str, kind: str) -> Any:
    """The default as the documentation states it, as a value where it is one."""
    if text in ("none", "required", ""):
        return None
    if kind == "boolean":
        return text == "true" if text in ("true", "false") else None
    if kind == "transform":
        return Transform() if text == "identity" else None
    try:
        number = float(text)
        return int(number) if kind == "integer" else number
    except ValueError:
        return text


def _of_change(p: Problem) -> Problem:
    """A problem of a new value: without a column, and in the words of Python."""
    return Problem(in_python(p.message), p.file) if p.file.startswith('["') else p


# A $name of a scene that equals one of these takes an underscore at its end as an argument.
PARAMETERS_OF_LOADING = ("integrator", "sampler", "path", "text", "progress")


def _defines(defines: Mapping[str, Any]) -> List[Tuple[str, str]]:
    texts = []
    for name, value in defines.items():
        if name.endswith("_") and name[:-1] in PARAMETERS_OF_LOADING:
            name = name[:-1]
        if isinstance(value, (bool, np.bool_)):
            texts.append((name, "true" if value else "false"))
        elif isinstance(value, (int, float, np.integer, np.floating)):
            texts.append((name, repr(value.item() if isinstance(value, np.generic) else value)))
        elif isinstance(value, (str, os.PathLike)):
            texts.append((name, checked_text(name, value) if isinstance(value, str) else file_path(name, value)))
        else:
            raise TypeError(f"{name}: expected a string, number or boolean, got {type(value).__name__}")
    return texts


def load_file(path: "str | os.PathLike[str]", *, integrator: str = "", sampler: str = "", progress: "Union[bool, LoadReport]" = True,
              **defines: Any) -> Scene:
    """Loads a scene file (Mitsuba's XML, versions 0.6 to 3).

    Parameters
    ----------
    path : path-like
    integrator, sampler : str, optional
        Plug-ins that replace the scene's, as on the command line.
    progress : bool or callable
        A bar where loading takes more than a second, or a function of (name, part): part of the tables of that object that is done, in the
        range from 0 to 1, or None before.
    **defines
        Values for the $names of the file. A $name that equals the name of an argument ("integrator") takes an
        underscore at its end ("integrator_").

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        With every problem of the scene, each with file, line and column.
    """
    file = file_path("path", path)
    checked_text("integrator", integrator), checked_text("sampler", sampler)
    with LoadBar(os.path.basename(file), progress):
        return Scene(_aureole.OpenScene.load_file(file, _defines(defines), {}, integrator, sampler))


def load_string(text: str, *, path: "str | os.PathLike[str] | None" = None, integrator: str = "", sampler: str = "",
                progress: "Union[bool, LoadReport]" = True, **defines: Any) -> Any:
    """Loads a scene, or a single object such as ``<bsdf type="diffuse"/>``, from XML text.

    Parameters
    ----------
    text : str
    path : path-like, optional
        The file in whose place the text is read: other files are searched for beside it. By default they are searched
        for in the working folder.
    integrator, sampler, progress, **defines
        As for `load_file`.

    Returns
    -------
    Scene, Bsdf, Bssrdf, Emitter, Medium, Phase, Aperture, Texture or Object
    """
    checked_text("text", text), checked_text("integrator", integrator), checked_text("sampler", sampler)
    file = file_path("path", path) if path is not None else _TEXT_FILE
    is_scene = _root_tag(text) in ("scene", "")
    with LoadBar(os.path.basename(file), progress, shows_time=is_scene):
        if is_scene:
            return Scene(_aureole.OpenScene.load_string(text, file, _defines(defines), {}, integrator, sampler))
        return _object(SceneText(f'<scene version="3.0.0">{text}</scene>', [], {}), file, (360.0, 830.0))


def load_dict(description: Mapping[str, Any], *, family: Optional[str] = None, integrator: str = "",
              sampler: str = "", wavelengths: "Tuple[float, float]" = (360.0, 830.0),
              progress: "Union[bool, LoadReport]" = True) -> Any:
    """Loads a scene, or a single object, from nested dicts as Mitsuba has them.

    Each dict has a "type", the name of a plug-in (or "scene", "ref", "rgb", "spectrum"). Other entries are parameters:
    numbers, strings, booleans, three numbers (vectors; colours where a spectrum is expected), spectra ({"type": "spectrum",
    "value": [(400, 0.2), (700, 0.5)]} in nm, another "unit" beside it, or the text of a scene file), `Transform` or matrices of
    4 x 4, key frames ({"type": "animation", "frames": [(0.0, Transform()), (0.02, Transform.rotate([0, 0, 1], 90))]}, times in s),
    nested dicts, BSDFs written in Python (objects with eval, pdf and sample), and arrays, for the pixels of a
    texture ("bitmap" with "data") or the vertices of a mesh ("mesh" with "vertices" and "faces").

    Parameters
    ----------
    description : dict
    family : str, optional
        Of an object whose type several families have ("rectangle": shape or aperture).
    integrator, sampler : str, optional
        Plug-ins that replace the scene's.
    wavelengths : (float, float)
        Range [nm] for which a single object is made; the sensor of a scene states the range of the scene.
    progress : bool or callable
        As for `load_file`.

    Returns
    -------
    Scene, Bsdf, Bssrdf, Emitter, Medium, Phase, Aperture, Texture or Object

    Examples
    --------
    >>> bsdf = aureole.load_dict({"type": "roughconductor", "material": "Au", "alpha": 0.1})
    """
    if not isinstance(description, Mapping):
        raise TypeError(f"description: expected a dict, got {type(description).__name__}")
    checked_text("integrator", integrator), checked_text("sampler", sampler)
    if family is not None:
        checked_text("family", family)
    kind = description.get("type")
    if isinstance(kind, str) and kind == "scene":
        text = scene_text(description)
        try:
            with LoadBar("the scene", progress, shows_time=False):  # a change may come many times in a second
                return Scene(_aureole.OpenScene.load_string(text.text, _DICT_FILE, [], text.given, integrator, sampler), text.places)
        except Error as e:
            raise relocated_error(e, _DICT_FILE, text.places) from None
    text = object_text(description, family)
    ends = _range(wavelengths)
    try:
        with LoadBar(f"the {kind}", progress, shows_time=False):
            return _object(text, _DICT_FILE, ends)
    except Error as e:
        error = relocated_error(e, _DICT_FILE, text.places)
        found = [] if family is not None or "family" in description else other_families(kind)
        if found and isinstance(error, SceneError):
            choices = " or ".join(f'family="{other}"' for other in found[1:])
            error = SceneError([*error.problems, Problem(
                f'"{kind}" was taken for the family "{found[0]}"; {choices} reads it as another', "the dict")])
        raise error from None


def _range(wavelengths: "Tuple[float, float]") -> "Tuple[float, float]":
    ends = real("wavelengths", wavelengths, positive=True, unit="nm")
    if ends.shape != (2,) or not ends[0] < ends[1]:
        raise Error(f"wavelengths: expected two increasing wavelengths in nm, got {shown(wavelengths)}")
    return float(ends[0]), float(ends[1])


def _object(text: SceneText, file: str, wavelengths: "Tuple[float, float]") -> Any:
    return _aureole.load_object(text.text, file, wavelengths[0], wavelengths[1], text.given)


def _root_tag(text: str) -> str:
    """The name of the first element, or an empty string."""
    at = 0
    while True:
        at = text.find("<", at)
        if at < 0:
            return ""
        end = {"<!--": "-->", "<?": "?>"}.get("<!--" if text.startswith("<!--", at) else text[at:at + 2])
        if end is None:
            m = re.compile(r"<([A-Za-z_][\w.-]*)").match(text, at)
            if m:
                return m[1]
            at += 1
        else:
            at = text.find(end, at)
            if at < 0:
                return ""


__all__ = ["Scene", "ParameterError", "load_file", "load_string", "load_dict"]
