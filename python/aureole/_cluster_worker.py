# SPDX-License-Identifier: Apache-2.0
"""Rendering on several machines: scenes that are sent to workers, and the functions that run on the workers."""

from __future__ import annotations

import atexit
import dataclasses
import hashlib
import importlib
import os
import platform
import shutil
import tempfile
import threading
import time
import xml.etree.ElementTree as ElementTree
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

from . import _aureole
from ._errors import Error
from ._image import Image
from ._scene import Scene, load_string

FILE_MARK = "aureole-file:"  # before the number of a file in the text of a scene that is sent


@dataclasses.dataclass(frozen=True)
class Bundle:
    """A scene that can be sent: its text, with files by the hash of their content instead of their place.

    Attributes
    ----------
    text : str
        The scene file; the value of a parameter that names a file is "aureole-file:NUMBER".
    files : tuple of (str, str, int)
        Path of each file on the machine where the bundle was made, the SHA-256 of its content, and its bytes.
    scene_hash : int
        `Scene.hash`, which the scene has on a worker as well.
    store : str
        URL of a folder that the caller and the workers reach through fsspec, with files named by their hash; empty without one.
    """

    text: str
    files: Tuple[Tuple[str, str, int], ...]
    scene_hash: int
    store: str = ""

    @property
    def key(self) -> str:
        """Changes with the text and the content of the files, not with their places."""
        digest = hashlib.sha256(self.text.encode())
        for path, content, _ in self.files:
            digest.update(content.encode() + os.path.basename(path).encode())
        return digest.hexdigest()[:32]


@dataclasses.dataclass(frozen=True)
class Job:
    """Options of a render that all parts share."""

    spp: int
    seed: Optional[int]
    replicates: int
    adaptive: Optional[str]
    threads: int


@dataclasses.dataclass(frozen=True)
class Part:
    """Result of a part: its compressed samples, the first invalid ones (x, y, sample, replicate), and its seconds."""

    packed: bytes
    invalid: List[Tuple[int, int, int, int]]
    seconds: float


@dataclasses.dataclass(frozen=True)
class Answer:
    """Answer of a worker that was asked to open a scene: "ready", "missing" with the hashes of files, "refused" with a sentence, or
    "unknown" from a worker that has lost the scene."""

    kind: str
    text: str = ""
    missing: Tuple[str, ...] = ()


def hash_of_file(path: str) -> str:
    """SHA-256 of a file's content."""
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def bundle(scene: Scene, extra: Tuple[str, ...] = (), store: str = "") -> Bundle:
    """The text and the files of a scene, and `extra` files behind them, for other machines. Throws Error for objects that exist in this
    program alone."""
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    files = list(scene._open.files)
    place = {path: number for number, path in enumerate(files)}
    root = ElementTree.fromstring(scene.xml())
    for element in root.iter():
        for name in ("value", "filename"):
            value = element.get(name)
            if value and os.path.isabs(value) and os.path.normpath(value) in place:
                element.set(name, f"{FILE_MARK}{place[os.path.normpath(value)]}")
    described = tuple((path, hash_of_file(path), os.path.getsize(path)) for path in (*files, *extra))
    return Bundle(ElementTree.tostring(root, encoding="unicode"), described, scene.hash, store)


def describe() -> Tuple[str, str]:
    """The version of this process's aureole, and what the bits of its numbers depend on: the processor's widest vectors (Embree chooses
    by them) and the mathematical library."""
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            flags = next((line.split() for line in file if line.startswith("flags")), [])
    except OSError:
        flags = []
    wide = {"avx512f", "avx512dq", "avx512cd", "avx512bw", "avx512vl"}
    vectors = "AVX-512" if wide <= set(flags) else "AVX2"
    return str(_aureole.__version__), " ".join((platform.machine(), vectors, *platform.libc_ver())).strip()


class _Shelf:
    """Files and scenes that this process has received. The last few scenes are kept, with their files in a temporary folder."""

    most = 4

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self._folder = ""
        self._scenes: "Dict[str, Tuple[Scene, Bundle, str]]" = {}

    def folder(self) -> str:
        """The folder of this process: below that of the Dask worker, which its nanny removes, also where the process is killed."""
        if not self._folder:
            try:
                parent: Optional[str] = importlib.import_module("distributed").get_worker().local_directory
            except (ImportError, ValueError, AttributeError):
                parent = None
            self._folder = tempfile.mkdtemp(prefix="aureole-cluster-", dir=parent)
            atexit.register(shutil.rmtree, self._folder, ignore_errors=True)
        return self._folder

    def file(self, digest: str) -> str:
        return os.path.join(self.folder(), digest)

    def scene(self, key: str) -> Optional[Tuple[Scene, Bundle, str]]:
        with self.lock:
            return self._scenes.get(key)

    def keep(self, of: Bundle, scene: Scene, folder: str) -> None:
        with self.lock:
            while len(self._scenes) >= self.most:
                _, _, old = self._scenes.pop(next(iter(self._scenes)))
                shutil.rmtree(old, ignore_errors=True)
            self._scenes[of.key] = (scene, of, folder)
            used = {digest for _, one, _ in self._scenes.values() for _, digest, _ in one.files}
            for name in os.listdir(self.folder()):
                if len(name) == 64 and name not in used:
                    os.remove(self.file(name))


shelf = _Shelf()


def open_scene(of: Bundle, expected: Tuple[str, str]) -> Answer:
    """Loads a scene on a worker, or says which files are missing or why this worker cannot render it."""
    ours = describe()
    if ours != expected:
        return Answer(
            "refused",
            f"it has aureole {ours[0]} ({ours[1]}), here is {expected[0]} ({expected[1]}); pictures have the same bits "
            "with the same ones only",
        )
    with shelf.lock:
        if shelf.scene(of.key):
            return Answer("ready")
        wanted = {digest for _, digest, _ in of.files}
        missing = tuple(sorted(digest for digest in wanted if not os.path.exists(shelf.file(digest))))
        if missing and of.store:
            for digest in missing:
                _fetch(of.store, digest)
        elif missing:
            return Answer("missing", missing=missing)
        folder = tempfile.mkdtemp(prefix="scene-", dir=shelf.folder())
        try:
            scene = unpack(of, folder)
        except Error as e:
            shutil.rmtree(folder, ignore_errors=True)
            return Answer("refused", str(e))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        shelf.keep(of, scene, folder)
        return Answer("ready")


def _fetch(store: str, digest: str) -> None:
    """A file from the store, checked by its hash."""
    temporary = f"{shelf.file(digest)}.{os.getpid()}"
    with importlib.import_module("fsspec").open(f"{store}/{digest}", "rb") as source, open(temporary, "wb") as target:
        shutil.copyfileobj(source, target, 1 << 22)
    if hash_of_file(temporary) != digest:
        os.remove(temporary)
        raise Error(f"{store}/{digest}: has another content than its name says")
    os.replace(temporary, shelf.file(digest))


def receive(digest: str, offset: int, size: int, content: bytes) -> str:
    """Writes a piece of a file on a worker. The last piece is answered by "whole" or, where the hash is wrong, "damaged"."""
    with shelf.lock:
        final = shelf.file(digest)
        if os.path.exists(final):
            return "whole"
        partial = final + ".part"
        with open(partial, "r+b" if os.path.exists(partial) else "w+b") as file:
            file.seek(offset)
            file.write(content)
        if offset + len(content) < size:
            return "more"
        if os.path.getsize(partial) != size or hash_of_file(partial) != digest:
            os.remove(partial)
            return "damaged"
        os.replace(partial, final)
        return "whole"


def unpack(of: Bundle, folder: str) -> Scene:
    """Links the files below `folder`, in the tree in which they lay, so that files find their neighbours, and loads the scene."""
    placed = places(of, folder)
    for (_, digest, _), target in zip(of.files, placed):
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if os.path.exists(target):
            continue
        try:
            os.link(shelf.file(digest), target)
        except OSError:
            shutil.copyfile(shelf.file(digest), target)
    root = ElementTree.fromstring(of.text)
    for element in root.iter():
        for name in ("value", "filename"):
            value = element.get(name)
            if value and value.startswith(FILE_MARK):
                element.set(name, placed[int(value[len(FILE_MARK) :])])
    scene: Scene = load_string(ElementTree.tostring(root, encoding="unicode"), path=os.path.join(folder, "scene.xml"))
    if scene.hash != of.scene_hash:
        raise Error(
            "the scene has another hash there than where it comes from: a file that it needs did not travel, or the program differs"
        )
    return scene


def places(of: Bundle, folder: str) -> List[str]:
    """Where the files of a bundle lie below `folder`."""
    return [os.path.join(folder, path.lstrip(os.sep)) for path, _, _ in of.files]


def render_part(key: str, job: Job, units: Tuple[int, int], start: Optional[bytes]) -> Any:
    """A part on a worker; an Answer where the worker has lost the scene, as one that was started again has."""
    found = shelf.scene(key)
    if found is None:
        return Answer("unknown")
    scene = found[0]
    begun = time.perf_counter()
    first = None
    if start is not None:
        empty = _aureole.empty_picture(scene._open, job.spp, job.seed, job.replicates, job.adaptive)
        first = _aureole.PartSum(empty).unpacked(start)
    done, _ = _aureole.render(scene._open, 0, job.spp, job.seed, job.threads, job.replicates, 0.0, job.adaptive, first, None, units)
    packed = _aureole.packed_part(done)
    return Part(packed, [(int(x), int(y), int(s), int(r)) for x, y, s, r in done.invalid], time.perf_counter() - begun)


def sweep_row(
    key: str, edits: Mapping[str, Any], spp: Optional[int], seed: Optional[int], threads: int, measure: Optional[Callable[[Image], Any]]
) -> Any:
    """A row of a sweep on a worker: (True, its picture or figures) or (False, the problem)."""
    from ._render import render

    found = shelf.scene(key)
    if found is None:
        return Answer("unknown")
    base, of, folder = found
    placed = places(of, folder)
    own = {
        path: placed[int(value[len(FILE_MARK) :])] if isinstance(value, str) and value.startswith(FILE_MARK) else value
        for path, value in edits.items()
    }
    try:
        scene = load_string(base.xml(), path=os.path.join(folder, "scene.xml"))
        scene.update(own)
        image = render(scene, spp, seed=seed, threads=threads, progress=False)
        return True, image if measure is None else measure(image)
    except Exception as e:  # also those of `measure`, which is the caller's
        return False, f"{type(e).__name__}: {e}" if not isinstance(e, Error) else str(e)
