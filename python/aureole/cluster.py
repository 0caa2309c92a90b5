# SPDX-License-Identifier: Apache-2.0
"""Rendering on several machines by Dask (`pip install aureole[cluster]`); docs/cluster.md has the recipes.

A picture is divided into parts, each a range of the job's units (tiles of 16 x 16 pixels times 16 samples). Workers render
parts, the caller adds them as they arrive. Sums are exact, so that the picture has the same bits as on one machine, for
any number of workers and any order.
"""

from __future__ import annotations

import dataclasses
import importlib
import os
import random
import statistics
import sys
import time
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple, Union

from . import _aureole
from ._arrays import file_path, integer, scalar, text as checked_text
from ._bars import RenderBar, Report
from ._cluster_command import Line
from ._cluster_pool import Pool, Tasks, Worker, dask_client, median_rate
from ._cluster_worker import FILE_MARK, Bundle, Job, Part, bundle as _bundle, render_part, sweep_row
from ._errors import Error
from ._image import Image
from ._scene import Scene

_SAMPLES_OF_A_UNIT = 256 * 16  # a tile of 16 x 16 pixels, 16 samples of each
_CHECKPOINT_S = 30.0
_PICTURE_S = 2.0
_LONGEST_PART_S = 600.0
_Units = Tuple[int, int]


def render(
    scene: Scene,
    client: Any,
    spp: Optional[int] = None,
    *,
    seed: Optional[int] = None,
    replicates: int = 1,
    adaptive: Optional[str] = None,
    part_seconds: float = 10.0,
    threads: int = 1,
    checkpoint: "str | os.PathLike[str] | None" = None,
    store: Optional[str] = None,
    verify: float = 0.0,
    on_picture: Optional[Callable[[Image], None]] = None,
    progress: Union[bool, Report] = True,
) -> Image:
    """Renders a picture on the workers of a Dask cluster: the same bits as `aureole.render` on one machine.

    Parameters
    ----------
    scene : Scene
        Its text and its files are sent to each worker once, by the hash of their content.
    client : dask.distributed.Client
    spp, seed, replicates, adaptive
        As for `aureole.render`. With `adaptive` one worker finds the densities first.
    part_seconds : float
        Time of a part on one worker, from 0.1 to 600 s; the first parts are shorter and measure the workers. Parts become
        longer by themselves where so many workers answer that adding their parts takes half of the caller's time.
    threads : int
        Threads of one part; 0 for all cores of the worker's machine. Start workers with one thread each (`--nthreads 1`), or one
        worker a machine with its cores here.
    checkpoint : path, optional
        A state file, or its URL for fsspec, written every 30 s and where the render is interrupted; where it exists, the render
        goes on from it. `aureole render --resume` and `aureole merge` read it as well.
    store : str, optional
        URL of a folder that this machine and the workers reach through fsspec ("s3://bucket/aureole", "file:///shared"): files of the
        scene are written there once, named by their hash, and workers read them there. Without it they travel through the
        scheduler.
    verify : float
        Fraction of the parts, chosen at random, that another worker renders again: where bits differ, Error.
    on_picture : callable, optional
        Called with the picture so far, at most every two seconds, from the calling thread.
    progress : bool or callable
        A bar with the time left, workers and failures, or a function of (units done, units, seconds, samples per second).

    Returns
    -------
    Image

    Notes
    -----
    Workers of another version, instruction set or mathematical library are not used, with a warning. Each part is checked: the hash
    of its bytes, the picture it belongs to, and that it has just the units asked for. A part that is lost, late or wrong is rendered
    again, by others where there are any; after three such parts a worker is not used any more.
    """
    client = dask_client(client)
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    spp = scene.sample_count if spp is None else integer("spp", spp, minimum=1, maximum=2**32)
    if seed is not None:
        seed = integer("seed", seed, minimum=0, maximum=2**64 - 1)
    if adaptive is not None:
        checked_text("adaptive", adaptive)
    if on_picture is not None and not callable(on_picture):
        raise TypeError(f"on_picture: expected a function, got {type(on_picture).__name__}")
    job = Job(
        spp,
        seed,
        integer("replicates", replicates, minimum=1, maximum=2**20),
        adaptive,
        integer("threads", threads, minimum=0, maximum=4096),
    )
    part_seconds = scalar("part_seconds", part_seconds, minimum=0.1, maximum=_LONGEST_PART_S)
    verify = scalar("verify", verify, minimum=0, maximum=1)
    kept = None if checkpoint is None else _Checkpoint(file_path("checkpoint", checkpoint))
    of = _bundle(scene, store=_store(store))
    sum_of_parts = _aureole.PartSum(_aureole.empty_picture(scene._open, spp, seed, job.replicates, adaptive))
    if kept is not None and (content := kept.read()) is not None:
        sum_of_parts.resume(content, kept.path)
    parts = _Parts(of, job, sum_of_parts, part_seconds, verify, kept, on_picture)
    parts.pool = Pool(client, of, parts)
    if isinstance(progress, Line):
        progress.remark = parts.remark
    with RenderBar(progress, parts.remark) as report:
        parts.report = report
        parts.finish()
    return Image._of(sum_of_parts.picture(), "finished")


class _Checkpoint:
    """A state file, here or at a URL of fsspec. A file here is replaced whole."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._file: Any = None
        if "://" in path:
            self._system, self._place = importlib.import_module("fsspec").core.url_to_fs(path)
            self._file = self._system

    def read(self) -> Optional[bytes]:
        if self._file is not None:
            return bytes(self._system.cat_file(self._place)) if self._system.exists(self._place) else None
        if not os.path.exists(self.path):
            return None
        with open(self.path, "rb") as file:
            return file.read()

    def write(self, content: bytes) -> None:
        if self._file is not None:
            self._system.pipe_file(self._place, content)
        else:
            _aureole.write_file(self.path, content)


class _Missing:
    """Ranges of units that were not handed out yet."""

    def __init__(self, count: int, done: Sequence[_Units]) -> None:
        self._ranges: List[_Units] = []
        at = 0
        for begin, end in sorted(done):
            if begin > at:
                self._ranges.append((at, begin))
            at = max(at, end)
        if at < count:
            self._ranges.append((at, count))

    def take(self, units: int) -> Optional[_Units]:
        if not self._ranges:
            return None
        begin, end = self._ranges[0]
        cut = min(end, begin + max(1, units))
        if cut == end:
            self._ranges.pop(0)
        else:
            self._ranges[0] = (cut, end)
        return begin, cut

    def count(self) -> int:
        return sum(end - begin for begin, end in self._ranges)


def part_units(rate: float, missing: int, slots: int, part_seconds: float, add_s: float) -> int:
    """Units of the next part of a worker.

    Parameters
    ----------
    rate : float
        Units that the worker renders in a second.
    missing : int
        Units that nobody has yet.
    slots : int
        Parts that are rendered at a time.
    part_seconds : float
        The wanted time of a part. It is longer where parts that take `add_s` seconds to be added would keep the caller busy for more than
        half of its time, and shorter at the end, such that all workers end together (guided self-scheduling, Polychronopoulos & Kuck 1987).
    """
    seconds = min(_LONGEST_PART_S, max(part_seconds, 2 * add_s * max(1, slots)))
    fair = missing / (2 * max(1, slots))
    return int(max(1, min(rate * seconds, max(fair, rate * min(1.0, seconds)))))


class _Parts(Tasks):
    """The parts of a picture: handed out in order, checked, verified and added. A task is (begin, end, copy), copy 1 of those that a second
    worker renders for comparison."""

    pool: Pool

    def __init__(
        self,
        of: Bundle,
        job: Job,
        sum_of_parts: Any,
        part_seconds: float,
        verify: float,
        checkpoint: Optional[_Checkpoint],
        on_picture: Optional[Callable[[Image], None]],
    ) -> None:
        self._of, self._job, self._sum, self._verify = of, job, sum_of_parts, verify
        self._part_seconds, self._checkpoint, self._on_picture = part_seconds, checkpoint, on_picture
        self.report: Optional[Report] = None
        self._units = int(sum_of_parts.units)
        self._missing = _Missing(self._units, sum_of_parts.done)
        self._again: Dict[Tuple[int, int, int], None] = {}
        self._done_tasks: Set[Tuple[int, int, int]] = set()
        self._unverified: Dict[_Units, Tuple[str, Part]] = {}
        self._done = self._done_before = self._units - self._missing.count()
        self._add_s = 0.0  # that adding a part takes
        self._verified = 0  # parts
        self._needs_densities = bool(self._sum.is_adaptive and not self._sum.has_densities)
        self._start: Optional[bytes] = None
        self._pilot: Optional[Tuple[int, int, int]] = None
        self._begun = self._saved = self._shown = time.monotonic()
        self._is_changed = False
        if self._sum.has_densities:
            self._start = self._sum.start()

    def finish(self) -> None:
        try:
            self.pool.run()
        except _WrongBits as e:
            raise Error(str(e)) from None
        except BaseException:
            self._save()
            raise
        if self._verify > 0 and self._verified == 0 and self._done > self._done_before:
            warnings.warn("no part was verified: that needs two workers, and parts enough", stacklevel=3)
        if self._unverified:  # no second worker was there
            warnings.warn(f"{len(self._unverified)} parts could not be verified: only one worker was left", stacklevel=3)
            for (begin, end), (_, part) in list(self._unverified.items()):
                self._add((begin, end, 0), part)
        self._save()
        self.tell(is_last=True)

    # -- Tasks

    def unfinished(self) -> bool:
        left = self._missing.count() + len([t for t in self._again if t not in self._done_tasks])
        is_all_here = self._done + sum(end - begin for begin, end in self._unverified) == self._units
        if is_all_here and self._unverified and len(self.pool.ready()) < 2:
            return False
        return left > 0 or self._done < self._units

    def next(self, worker: Worker) -> Any:
        if self._needs_densities and self._pilot is not None and self._pilot not in self._again:
            return None  # one worker finds them
        for task in list(self._again):
            if task in self._done_tasks:
                del self._again[task]
            elif task[2] == 0 or self._unverified[task[:2]][0] != worker.address:
                del self._again[task]
                return task
        units = self._missing.take(1 if self._needs_densities else self._size(worker))
        if units is None:
            return None
        if self._needs_densities:
            self._pilot = (*units, 0)
        return (*units, 0)

    def call(self, task: Any) -> Tuple[Any, ...]:
        return render_part, self._of.key, self._job, (task[0], task[1]), self._start

    def seconds(self, task: Any, worker: Worker) -> Optional[float]:
        rate = worker.rate if worker.rate is not None else median_rate(self.pool.ready())
        return None if rate is None or self._needs_densities else (task[1] - task[0]) / rate

    def is_done(self, task: Any) -> bool:
        return task in self._done_tasks

    def put_back(self, task: Any) -> None:
        if task not in self._done_tasks:
            self._again[task] = None

    def arrived(self, task: Any, worker: Worker, value: Any) -> Optional[str]:
        if task in self._done_tasks:
            return None
        if not isinstance(value, Part) or not isinstance(value.packed, bytes):
            return "it is no part of a picture"
        units = (task[0], task[1])
        try:
            if task[2] == 1:
                return self._compare(task, worker, value)
            begun = time.perf_counter()
            if self._verify > 0 and not self._needs_densities and len(self.pool.ready()) > 1 and random.random() < self._verify:
                self._sum.check(value.packed, *units)
                self._unverified[units] = (worker.address, value)
                self._again[(*units, 1)] = None
                self._done_tasks.add(task)
            else:
                self._add(task, value)
                self._add_s += 0.2 * (time.perf_counter() - begun - self._add_s)
        except (Error, TypeError, ValueError) as e:
            return str(e)
        if not self._needs_densities:
            rate = (units[1] - units[0]) / max(1e-3, float(value.seconds))
            worker.rate = rate if worker.rate is None else 0.5 * (rate + worker.rate)
        else:
            self._start, self._needs_densities = self._sum.start(), False
        return None

    def _compare(self, task: Any, worker: Worker, value: Part) -> Optional[str]:
        units = (task[0], task[1])
        address, first = self._unverified[units]
        if not self._sum.same_samples(first.packed, value.packed):
            raise _WrongBits(
                f"the workers {address} and {worker.address} rendered different bits of the units {units[0]} to {units[1] - 1}: one of "
                "them computes wrongly, and parts of it may be in the sum already. Render again without it"
                + (f", and without the checkpoint {self._checkpoint.path}" if self._checkpoint else "")
            )
        self._done_tasks.add(task)
        self._verified += 1
        del self._unverified[units]
        self._add((*units, 0), first)
        return None

    def _add(self, task: Any, part: Part) -> None:
        self._sum.add(part.packed, task[0], task[1], [tuple(sample) for sample in part.invalid])
        self._unverified.pop((task[0], task[1]), None)
        self._done_tasks.add(task)
        self._done += task[1] - task[0]
        self._is_changed = True

    def kept(self) -> str:
        return f"; what is done is in {self._checkpoint.path}" if self._checkpoint and self._done else ""

    def _size(self, worker: Worker) -> int:
        """Units of the next part of a worker: of the wanted time, and at the end such that all end together."""
        if worker.rate is None:
            return max(1, self._units // 1000)
        return part_units(worker.rate, self._missing.count(), self.pool.slots(), self._part_seconds, self._add_s)

    # -- what is told and kept

    def remark(self) -> str:
        """Workers and failures, for the bar."""
        workers, failures = len(self.pool.ready()), self.pool.failures
        return f"{workers} worker{'' if workers == 1 else 's'}" + (f", {failures} failures" if failures else "")

    def tell(self, is_last: bool = False) -> None:
        now = time.monotonic()
        seconds = max(1e-9, now - self._begun)
        if self.report is not None:
            self.report(self._done, self._units, seconds, (self._done - self._done_before) * _SAMPLES_OF_A_UNIT / seconds)
        if self._on_picture is not None and self._is_changed and (is_last or now - self._shown > _PICTURE_S):
            self._on_picture(Image._of(self._sum.picture(), "finished" if is_last else "interrupted"))
            self._shown, self._is_changed = time.monotonic(), False
        if now - self._saved > _CHECKPOINT_S:
            self._save()

    def _save(self) -> None:
        if self._checkpoint is not None and self._done > 0:
            self._checkpoint.write(self._sum.state())
        self._saved = time.monotonic()


class _WrongBits(RuntimeError):
    """Two workers disagree. This ends the render without a checkpoint, as an Error; an Error of a single part only asks for it again."""


@dataclasses.dataclass(frozen=True)
class SweepResult:
    """One row of a sweep: the edits, the picture or what `measure` returned, and the problem of a row that failed."""

    edits: Dict[str, Any]
    value: Any
    problem: Optional[str] = None


def sweep(
    scene: Scene,
    client: Any,
    table: Sequence[Mapping[str, Any]],
    spp: Optional[int] = None,
    *,
    seed: Optional[int] = None,
    threads: int = 1,
    store: Optional[str] = None,
    measure: Optional[Callable[[Image], Any]] = None,
    progress: Union[bool, Report] = True,
) -> List[SweepResult]:
    """Renders a scene with each row of edits, one row a task.

    Parameters
    ----------
    scene : Scene
    client : dask.distributed.Client
    table : sequence of dict
        Paths of parameters and their values, as `Scene.update` takes them. Files that values name travel as well.
    spp, seed, threads
        As for `aureole.render`.
    store
        As for `render`.
    measure : callable, optional
        Called with each picture on the worker; what it returns travels instead of the picture.
    progress
        As for `render`.

    Returns
    -------
    list of SweepResult
        In the order of the table. A row that fails has its problem, and costs no other row.

    Examples
    --------
    >>> rows = aureole.cluster.sweep(scene, client, [{"glass.bsdf.alpha": a} for a in (0.05, 0.1)], 64)  # doctest: +SKIP
    """
    client = dask_client(client)
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene (from load_file, load_string or load_dict), got {type(scene).__name__}")
    rows = []
    for number, row in enumerate(table):
        if not isinstance(row, Mapping):
            raise TypeError(f"table[{number}]: expected a dict of paths and values, got {type(row).__name__}")
        rows.append(dict(row))
    if measure is not None and not callable(measure):
        raise TypeError(f"measure: expected a function, got {type(measure).__name__}")
    extra = tuple(sorted({file for row in rows for path, value in row.items() if (file := _file_of(scene, path, value))}))
    of = _bundle(scene, extra, _store(store))
    place = {path: f"{FILE_MARK}{len(of.files) - len(extra) + number}" for number, path in enumerate(extra)}
    sent = [{path: place.get(_file_of(scene, path, value), value) for path, value in row.items()} for row in rows]
    tasks = _Rows(
        of,
        rows,
        sent,
        (
            None if spp is None else integer("spp", spp, minimum=1, maximum=2**32),
            None if seed is None else integer("seed", seed, minimum=0, maximum=2**64 - 1),
            integer("threads", threads, minimum=0, maximum=4096),
            measure,
        ),
    )
    tasks.pool = Pool(client, of, tasks)
    with RenderBar(progress, tasks.remark, "row") as report:
        tasks.report = report
        tasks.pool.run()
        tasks.tell()
    return [result for result in tasks.results if result is not None]


def _file_of(scene: Scene, path: str, value: Any) -> str:
    """The file that an edit names, or an empty string."""
    if not isinstance(value, (str, os.PathLike)) or not isinstance(path, str):
        return ""
    try:
        expected = scene._expected(path)
    except Error:  # the row itself says so later
        return ""
    name = os.path.abspath(os.fspath(value))
    return name if expected == "file" and isinstance(name, str) and os.path.isfile(name) else ""


class _Rows(Tasks):
    """The rows of a sweep. A task is the number of a row."""

    pool: Pool

    def __init__(self, of: Bundle, rows: List[Dict[str, Any]], sent: List[Dict[str, Any]], options: Tuple[Any, ...]) -> None:
        self._of, self._rows, self._sent, self._options = of, rows, sent, options
        self.results: List[Optional[SweepResult]] = [None] * len(rows)
        self._waiting = list(range(len(rows)))
        self._given: Dict[int, float] = {}
        self._spent: List[float] = []
        self._done = 0
        self._begun = time.monotonic()
        self.report: Optional[Report] = None

    def unfinished(self) -> bool:
        return self._done < len(self._rows)

    def next(self, worker: Worker) -> Any:
        while self._waiting:
            row = self._waiting.pop(0)
            if self.results[row] is None:
                self._given[row] = time.monotonic()
                return row
        return None

    def call(self, task: Any) -> Tuple[Any, ...]:
        return (sweep_row, self._of.key, self._sent[task], *self._options)

    def seconds(self, task: Any, worker: Worker) -> Optional[float]:
        return 2 * statistics.median(self._spent) if len(self._spent) >= 3 else None

    def is_done(self, task: Any) -> bool:
        return self.results[task] is not None

    def put_back(self, task: Any) -> None:
        if self.results[task] is None and task not in self._waiting:
            self._waiting.insert(0, task)

    def arrived(self, task: Any, worker: Worker, value: Any) -> Optional[str]:
        if not isinstance(value, tuple) or len(value) != 2 or not isinstance(value[0], bool):
            return "it is no row of a sweep"
        if self.results[task] is None:
            is_good, content = value
            self.results[task] = SweepResult(self._rows[task], content if is_good else None, None if is_good else str(content))
            self._done += 1
            self._spent.append(time.monotonic() - self._given[task])
        return None

    def remark(self) -> str:
        """Workers and failures, for the bar."""
        return f"{len(self.pool.ready())} workers" + (f", {self.pool.failures} failures" if self.pool.failures else "")

    def tell(self) -> None:
        if self.report is not None:
            self.report(self._done, len(self._rows), time.monotonic() - self._begun, 0.0)


def _store(store: Optional[str]) -> str:
    if store is None:
        return ""
    if "://" not in checked_text("store", store):
        raise Error(f'store: expected a URL such as "s3://bucket/folder" or "file:///shared/folder", got {store!r}')
    return store.rstrip("/")


def bundle(scene: Scene) -> Bundle:
    """A scene with the hashes of its files, as it is sent.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Bundle

    Raises
    ------
    Error
        For objects that exist in this program alone: arrays and BSDFs of Python.
    """
    return _bundle(scene)


__all__ = ["Bundle", "SweepResult", "bundle", "render", "sweep"]

if __name__ == "__main__":
    from ._cluster_command import main

    sys.exit(main())
