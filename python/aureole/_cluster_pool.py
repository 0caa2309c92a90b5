# SPDX-License-Identifier: Apache-2.0
"""Tasks on the workers of a Dask cluster: given out, looked at, given out again.

The caller's thread runs one loop. Nothing in it waits: states of tasks are read from the client's memory, results and the list of workers
are fetched by coroutines on the client's own event loop, each with a deadline. A task that is late is given to another worker as well, and
the first answer counts, so that a lost message, worker or scheduler costs time and never the end.
"""

from __future__ import annotations

import asyncio
import collections
import concurrent.futures
import dataclasses
import importlib
import itertools
import os
import statistics
import time
import warnings
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

from ._cluster_worker import Answer, Bundle, describe, hash_of_file, open_scene, receive
from ._errors import Error

TICK_S = 0.02  # interval between two checks of the tasks
LOOK_S = 1.0  # interval between two updates of the list of workers
ANSWER_S = 30.0  # for the list of workers
FETCH_S = 120.0  # for the result of a task that has ended
OPEN_S = 1800.0  # for loading a scene, which may make tables
PATIENCE_S = 120.0  # without any worker that could work
PIECE_BYTES = 4 << 20  # largest piece in which a file is sent
MOST_FAULTS = 3  # of a worker, until it is not used any more
COPIES = 2  # of a task at a time


@dataclasses.dataclass(eq=False)
class Worker:
    """A worker of the cluster as the caller sees it. `phase` is "new", "opening", "sending", "ready" or "refused"."""

    address: str
    threads: int
    phase: str = "new"
    rate: Optional[float] = None  # units of work per second of one task
    faults: int = 0
    opened: int = 0
    pieces: "List[Tuple[str, str, int, int]]" = dataclasses.field(default_factory=list)  # path, hash, offset, size of its file
    asked: "List[Asked]" = dataclasses.field(default_factory=list)


@dataclasses.dataclass(eq=False)
class Asked:
    """A task that a worker was asked for."""

    worker: Worker
    task: Any  # None for those that open scenes and send files
    future: Any
    begun: float
    deadline: float
    fetch: "Optional[concurrent.futures.Future[Any]]" = None
    is_late: bool = False


class Tasks:
    """Work of a `Pool`: subclasses have the tasks of a render or of a sweep. A task is any hashable object."""

    def next(self, worker: Worker) -> Any:
        """A task for this worker that nobody works on, or None."""
        raise NotImplementedError

    def call(self, task: Any) -> Tuple[Any, ...]:
        """The function that a worker runs, and its arguments."""
        raise NotImplementedError

    def seconds(self, task: Any, worker: Worker) -> Optional[float]:
        """The expected time of a task on a worker, or None as long as nothing is known."""
        raise NotImplementedError

    def arrived(self, task: Any, worker: Worker, value: Any) -> Optional[str]:
        """Takes a result. Returns None, or what is wrong with it."""
        raise NotImplementedError

    def put_back(self, task: Any) -> None:
        """A task that was lost or is late. It may be put back twice, or be done meanwhile."""
        raise NotImplementedError

    def is_done(self, task: Any) -> bool:
        raise NotImplementedError

    def unfinished(self) -> bool:
        raise NotImplementedError

    def tell(self) -> None:
        """Called often, for reports, checkpoints and pictures."""

    def kept(self) -> str:
        """The end of the sentence of an Error: where the work that is done can be found."""
        return ""


def dask_client(client: Any) -> Any:
    """The client, checked."""
    try:
        distributed = importlib.import_module("distributed")
    except ImportError:
        raise Error("rendering on a cluster needs Dask: pip install aureole[cluster]") from None
    if not isinstance(client, distributed.Client):
        raise TypeError(f"client: expected a dask.distributed.Client, got {type(client).__name__}")
    if client.asynchronous:
        raise Error("client: expected a synchronous Client, got an asynchronous one")
    return client


class Pool:
    """Runs `Tasks` on the workers of a client."""

    def __init__(self, client: Any, of: Bundle, tasks: Tasks) -> None:
        self._client, self._of, self._tasks = client, of, tasks
        self._expected = describe()
        self._workers: Dict[str, Worker] = {}
        self._refused: List[str] = []
        self._look: "Optional[concurrent.futures.Future[Any]]" = None
        self._looked = self._began_look = -1e9
        self._last_hope = time.monotonic()
        self._names = itertools.count()
        self._live: "collections.Counter[Any]" = collections.Counter()  # copies of tasks that are not late
        self._searches, self._no_search_before = 0, 0.0
        self.failures = 0  # tasks that were lost, late or wrong

    # -- what tasks ask

    def ready(self) -> List[Worker]:
        """Workers that render."""
        return [w for w in self._workers.values() if w.phase == "ready"]

    def slots(self) -> int:
        """Tasks that run at a time."""
        return sum(w.threads for w in self.ready())

    # -- the loop

    def run(self) -> None:
        """Until all tasks are done. Throws Error where no worker is left that could do them."""
        if self._of.store:
            store_files(self._of)
        try:
            while self._tasks.unfinished():
                self._look_at_workers()
                self._searches = 0
                if self._client.status == "running":
                    for worker in list(self._workers.values()):
                        self._hand_out(worker)
                if not self._collect():
                    time.sleep(TICK_S)
                self._require_hope()
                self._tasks.tell()
        finally:
            for worker in self._workers.values():
                for asked in worker.asked:
                    self._release(asked)
            if self._look is not None:
                self._look.cancel()

    def _on_loop(self, coroutine: Any) -> "concurrent.futures.Future[Any]":
        return asyncio.run_coroutine_threadsafe(coroutine, self._client.loop.asyncio_loop)

    def _look_at_workers(self) -> None:
        now = time.monotonic()
        if self._look is None:
            if now - self._looked >= LOOK_S and self._client.status == "running":
                self._look, self._began_look = self._on_loop(_threads_of_workers(self._client)), now
            elif self._client.status in ("closed", "closing"):
                raise Error("the client has lost the scheduler of the cluster" + self._tasks.kept())
            return
        if not self._look.done():
            if now - self._began_look > ANSWER_S:
                self._look.cancel()
                self._look, self._looked = None, now
            return
        look, self._look, self._looked = self._look, None, now
        try:
            found: Dict[str, int] = look.result()
        except (Exception, concurrent.futures.CancelledError):  # the scheduler is away; Dask has many kinds of errors for that
            return
        for address, threads in found.items():
            if address not in self._workers:
                self._workers[address] = Worker(address, max(1, int(threads)))
        for address in [a for a in self._workers if a not in found]:
            self._forget(self._workers.pop(address))

    def _forget(self, worker: Worker) -> None:
        """A worker that has left: others get its tasks."""
        for asked in list(worker.asked):
            self._drop(asked, lost=True)

    def _require_hope(self) -> None:
        now = time.monotonic()
        if any(w.phase != "refused" for w in self._workers.values()):
            self._last_hope = now
        elif self._workers:
            raise Error("no worker of the cluster can render: " + "; ".join(self._refused[-3:]) + self._tasks.kept())
        elif now - self._last_hope > PATIENCE_S:
            raise Error(f"the cluster has had no worker for {PATIENCE_S:.0f} s" + self._tasks.kept())

    # -- giving out

    def _hand_out(self, worker: Worker) -> None:
        if worker.phase == "new":
            worker.opened += 1
            if worker.opened > 5:
                self._refuse(worker, "the files of the scene do not stay there")
            elif self._ask(worker, None, OPEN_S, open_scene, self._of, self._expected):
                worker.phase = "opening"
        elif worker.phase == "sending" and not worker.asked:
            self._send_piece(worker)
        elif worker.phase == "ready":
            # Two tasks a thread, so that a worker does not wait for the next one.
            while len(worker.asked) < 2 * worker.threads:
                task = self._tasks.next(worker)
                if task is None:
                    task = self._late_task(worker)
                if task is None or not self._ask_task(worker, task):
                    return

    def _ask_task(self, worker: Worker, task: Any) -> bool:
        expected = self._tasks.seconds(task, worker)
        queue = 1 + len(worker.asked) // worker.threads
        limit = OPEN_S if expected is None else 60.0 + 5 * queue * expected
        if self._ask(worker, task, limit, *self._tasks.call(task)):
            return True
        self._tasks.put_back(task)
        return False

    def _ask(self, worker: Worker, task: Any, limit: float, function: Callable[..., Any], *arguments: Any) -> bool:
        key = f"aureole-{self._of.key[:8]}-{os.getpid()}-{id(self):x}-{next(self._names)}"
        try:
            future = self._client.submit(
                function, *arguments, workers=[worker.address], allow_other_workers=False, pure=False, retries=0, key=key
            )
        except Exception:  # the connection is lost now; the next update of the list of workers shows it
            return False
        now = time.monotonic()
        worker.asked.append(Asked(worker, task, future, now, now + limit))
        if task is not None:
            self._live[task] += 1
        return True

    def _late_task(self, worker: Worker) -> Any:
        """A task that takes much longer than it should, or that a much slower worker has just begun, for a worker that has nothing to do."""
        now = time.monotonic()
        if len(worker.asked) >= worker.threads or self._searches >= 8 or now < self._no_search_before:
            return None
        self._searches += 1
        best, least = None, 0.0
        for asked in self._asked():
            if asked.task is None or asked.worker is worker or asked.fetch is not None or self._tasks.is_done(asked.task):
                continue
            here, there = self._tasks.seconds(asked.task, worker), self._tasks.seconds(asked.task, asked.worker)
            if here is None or self._live[asked.task] >= COPIES:
                continue
            left = max(0.0, (there if there is not None else here) - (now - asked.begun))
            gain = max(left, now - asked.begun) - (1.5 * here + 1.0)
            if gain > least:
                best, least = asked.task, gain
        if best is None:
            self._no_search_before = now + 0.2
        return best

    def _asked(self) -> "List[Asked]":
        return [asked for worker in self._workers.values() for asked in worker.asked]

    def _send_piece(self, worker: Worker) -> None:
        if not worker.pieces:
            worker.phase = "new"
            return
        path, digest, offset, size = worker.pieces[0]
        try:
            with open(path, "rb") as file:
                file.seek(offset)
                content = file.read(PIECE_BYTES)
        except OSError as e:
            raise Error(f"{path}: cannot be sent to the workers: {e.strerror or e}") from None
        self._ask(worker, None, OPEN_S, receive, digest, offset, size, content)

    # -- taking in

    def _collect(self) -> bool:
        """Looks at all tasks. Returns whether something has ended."""
        has_ended = False
        now = time.monotonic()
        for asked in self._asked():
            if asked not in asked.worker.asked:  # dropped in this round
                continue
            if asked.task is not None and self._tasks.is_done(asked.task):
                self._drop(asked, lost=False)
            elif asked.fetch is not None:
                if asked.fetch.done():
                    self._take(asked)
                    has_ended = True
                elif now > asked.deadline:
                    self._drop(asked, lost=True)
            else:
                status = asked.future.status
                if status in ("finished", "error"):
                    asked.fetch, asked.deadline = self._on_loop(_result(self._client, asked.future)), now + FETCH_S
                elif status != "pending":
                    # The scheduler has lost what it knew, perhaps because it was started again.
                    self._drop(asked, lost=True)
                elif now > asked.deadline and not asked.is_late:
                    self._late(asked)
        return has_ended

    def _late(self, asked: Asked) -> None:
        """Others are asked as well; the first answer counts."""
        asked.is_late = True
        self.failures += 1
        if asked.task is None:
            self._refuse(asked.worker, "it does not answer")
            return
        self._live[asked.task] -= 1
        if self._live[asked.task] <= 0:
            self._tasks.put_back(asked.task)
        self._fault(asked.worker, "its part was not ready in time")

    def _take(self, asked: Asked) -> None:
        worker = asked.worker
        assert asked.fetch is not None
        try:
            value = asked.fetch.result(0)
        except (Exception, concurrent.futures.CancelledError) as e:
            if asked.future.status != "error":  # the result was lost on its way
                self._drop(asked, lost=True)
                return
            self._drop(asked, lost=True)
            if isinstance(e, (Error, ImportError, AttributeError, MemoryError)) or worker.phase != "ready":
                self._refuse(worker, str(e) or type(e).__name__)
            else:
                self._fault(worker, f"{type(e).__name__}: {e}")
            return
        if asked.task is None:
            self._drop(asked, lost=False)
            self._answered(worker, value)
        elif isinstance(value, Answer):  # it has lost the scene
            self._drop(asked, lost=True)
            if worker.phase == "ready":
                worker.phase = "new"
        else:
            problem = self._tasks.arrived(asked.task, worker, value)
            self._drop(asked, lost=problem is not None)
            if problem is None:
                worker.opened = 0
                worker.faults -= 1 if asked.is_late else 0
            else:
                self._fault(worker, problem)

    def _answered(self, worker: Worker, value: Any) -> None:
        """The answer to `open_scene` or `receive`."""
        if isinstance(value, Answer) and value.kind == "ready":
            worker.phase = "ready"
        elif isinstance(value, Answer) and value.kind == "missing":
            wanted = {digest: (path, size) for path, digest, size in self._of.files if digest in value.missing}
            worker.pieces = [
                (path, digest, offset, size) for digest, (path, size) in wanted.items() for offset in range(0, max(1, size), PIECE_BYTES)
            ]
            worker.phase = "sending"
        elif isinstance(value, Answer) and value.kind == "refused":
            self._refuse(worker, value.text)
        elif value in ("more", "whole") and worker.phase == "sending" and worker.pieces:
            _, digest, _, _ = worker.pieces.pop(0)
            if value == "whole":
                worker.pieces = [piece for piece in worker.pieces if piece[1] != digest]
        elif value == "damaged" and worker.pieces:
            path, digest, _, _ = worker.pieces[0]
            if hash_of_file(path) != digest:
                raise Error(f"{path}: was changed while the scene was rendered" + self._tasks.kept())
            worker.phase = "new"
        else:
            self._refuse(worker, "it answers what was not asked")

    def _drop(self, asked: Asked, lost: bool) -> None:
        """Forgets that a worker was asked; a lost task is given to others, unless another one has it."""
        worker = asked.worker
        worker.asked.remove(asked)
        self._release(asked)
        if asked.task is not None and not asked.is_late:
            self._live[asked.task] -= 1
            if self._live[asked.task] <= 0:
                del self._live[asked.task]
        if not lost:
            return
        self.failures += 1
        if asked.task is None:
            if worker.phase in ("opening", "sending"):
                worker.phase = "new"
        elif not self._tasks.is_done(asked.task) and self._live[asked.task] <= 0:
            self._tasks.put_back(asked.task)

    def _release(self, asked: Asked) -> None:
        if asked.fetch is not None:
            asked.fetch.cancel()
        try:
            asked.future.release()
        except Exception:  # a client that is closed
            pass

    def _fault(self, worker: Worker, problem: str) -> None:
        worker.faults += 1
        if worker.faults >= MOST_FAULTS:
            self._refuse(worker, f"{MOST_FAULTS} of its parts were late, lost or wrong, the last one because {problem}")

    def _refuse(self, worker: Worker, why: str) -> None:
        if worker.phase == "refused":
            return
        worker.phase = "refused"
        for asked in list(worker.asked):
            self._drop(asked, lost=True)
        self._refused.append(f"{worker.address}: {why}")
        warnings.warn(f"the worker {worker.address} is not used: {why}", stacklevel=6)


async def _threads_of_workers(client: Any) -> Dict[str, int]:
    threads: Dict[str, int] = await client.scheduler.ncores()
    return threads


async def _result(client: Any, future: Any) -> Any:
    return await client.gather(future, asynchronous=True)


def store_files(of: Bundle) -> None:
    """Writes the files of a bundle into its store, each once, named by its hash."""
    fsspec = importlib.import_module("fsspec")
    for path, digest, _ in of.files:
        url = f"{of.store}/{digest}"
        system, place = fsspec.core.url_to_fs(url)
        if system.exists(place):
            continue
        system.makedirs(os.path.dirname(place), exist_ok=True)
        temporary = f"{place}.{os.getpid()}.tmp"
        system.put_file(path, temporary)
        system.mv(temporary, place)


def median_rate(workers: Sequence[Worker]) -> Optional[float]:
    """Units per second of a worker in the middle."""
    known = [w.rate for w in workers if w.rate is not None]
    return statistics.median(known) if known else None
