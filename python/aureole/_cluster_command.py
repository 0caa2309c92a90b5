# SPDX-License-Identifier: Apache-2.0
"""`aureole cluster`, also `python -m aureole.cluster`: rendering on the workers of a Dask cluster from the command line."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import sys
import threading
import time
from typing import Any, Callable, Iterator, Optional, Sequence

from ._command_faces import defines_of, exit_code_of
from ._errors import Error


def main(words: Optional[Sequence[str]] = None) -> int:
    """Runs the command with `words`, by default the process's arguments, and returns its exit code."""
    parser = argparse.ArgumentParser(prog="aureole cluster", description="Render on the workers of a Dask cluster (docs/cluster.md).")
    commands = parser.add_subparsers(required=True, metavar="render")
    command = commands.add_parser("render", help="render a scene file to an EXR and a PNG")
    command.add_argument("scene", help="scene file")
    command.add_argument("-o", "--output", help="EXR to write (default: the scene's name, in the working folder)")
    where = command.add_mutually_exclusive_group(required=True)
    where.add_argument(
        "--scheduler", metavar="ADDRESS", help="Dask scheduler, tcp://HOST:8786, or the file that it wrote (--scheduler-file)"
    )
    where.add_argument("--local", type=int, metavar="N", help="N workers on this machine, of one thread each")
    command.add_argument("--wait", type=int, default=1, metavar="N", help="wait for N workers, ten minutes at most (default 1)")
    command.add_argument("-D", "--define", action="append", default=[], metavar="NAME=VALUE", help="set a $name of the scene")
    command.add_argument("--spp", type=int, help="samples per pixel (default: the scene's)")
    command.add_argument("--seed", type=int, help="seed of the samples (default: the scene's)")
    command.add_argument("--replicates", type=int, default=1, help="independent renderings; stores their mean and its variance")
    command.add_argument("--adaptive", choices=["none", "absolute", "display", "relative"], help="as for aureole render")
    command.add_argument("--threads", type=int, default=1, help="threads of one part (default 1)")
    command.add_argument("--part-seconds", type=float, default=10.0, help="time of a part on its worker (default 10)")
    command.add_argument("--store", metavar="URL", help="folder that all reach through fsspec, for the scene's files")
    command.add_argument("--verify", type=float, default=0.0, help="fraction of the parts that a second worker renders again (default 0)")
    command.add_argument("--restart", action="store_true", help="discard the checkpoint of an earlier render")
    command.add_argument("--cache", help="folder that keeps slow tables for the next start, or off (default: AUREOLE_CACHE, or ~/.cache/aureole)")
    command.add_argument("-q", "--quiet", action="store_true", help="no progress line, no notes")
    arguments = parser.parse_args(words)
    return exit_code_of(_render, arguments, "interrupted; the same command goes on from the checkpoint")


def _render(a: Any) -> int:
    from . import cache, cluster
    from ._scene import load_file

    output = a.output or os.path.splitext(os.path.basename(a.scene))[0] + ".exr"
    if not output.lower().endswith(".exr"):
        raise Error(f"-o {output}: the output is an .exr file (a .png is written beside it)")
    for name, number in (("--local", a.local), ("--wait", a.wait)):
        if number is not None and not 1 <= number <= 100000:
            raise Error(f"{name} {number}: expected a number of workers from 1 to 100000")
    defines = defines_of(a.define)
    if a.cache is not None:
        cache.use(a.cache)
    scene = load_file(a.scene, **defines)
    if not a.quiet:
        for note in scene.notes:
            print(f"note: {note}", file=sys.stderr)
    state = os.path.splitext(output)[0] + ".state"
    if a.restart and os.path.exists(state):
        os.remove(state)
    with _client(a) as client, Line(a.quiet) as line:
        image = cluster.render(
            scene,
            client,
            a.spp,
            seed=a.seed,
            replicates=a.replicates,
            adaptive=a.adaptive,
            part_seconds=a.part_seconds,
            threads=a.threads,
            checkpoint=state,
            store=a.store,
            verify=a.verify,
            progress=line,
        )
    image.save(output)
    image.save(os.path.splitext(output)[0] + ".png")
    if os.path.exists(state):
        os.remove(state)
    print(output)
    return 0


@contextlib.contextmanager
def _client(a: Any) -> Iterator[Any]:
    try:
        distributed = importlib.import_module("distributed")
    except ImportError:
        raise Error("rendering on a cluster needs Dask: pip install aureole[cluster]") from None
    with contextlib.ExitStack() as stack:
        if a.local is not None:
            local = stack.enter_context(
                distributed.LocalCluster(n_workers=a.local, threads_per_worker=1, processes=True, dashboard_address=":0")
            )
            client = stack.enter_context(distributed.Client(local))
        elif os.path.exists(a.scheduler):
            with _told(f"waiting for the scheduler of {a.scheduler}, two minutes at most", a.quiet):
                client = stack.enter_context(distributed.Client(scheduler_file=a.scheduler, timeout=120))
        else:
            try:
                with _told(f"waiting for the scheduler {a.scheduler}, two minutes at most", a.quiet):
                    client = stack.enter_context(distributed.Client(a.scheduler, timeout=120))
            except (OSError, ValueError) as e:
                raise Error(f"--scheduler {a.scheduler}: {e}") from None
        try:
            with _told(f"waiting for workers ({a.local or a.wait}), ten minutes at most", a.quiet):
                client.wait_for_workers(a.local or a.wait, timeout=600)
        except Exception as e:  # Dask's kind of TimeoutError differs with its version
            raise Error(f"the workers are not there: {e}") from None
        yield client


@contextlib.contextmanager
def _told(text: str, is_quiet: bool, after_s: float = 3.0) -> Iterator[None]:
    """Prints a note unless the block ends within `after_s`."""
    timer = threading.Timer(after_s, lambda: is_quiet or print(f"note: {text}", file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


class Line:
    """One line on the terminal while it is entered: part done, speed, time left, workers, failures."""

    def __init__(self, is_quiet: bool) -> None:
        self._is_quiet, self._shown = is_quiet or not sys.stderr.isatty(), 0.0
        self.remark: Callable[[], str] = str

    def __enter__(self) -> Line:
        return self

    def __exit__(self, *_: Any) -> None:
        if self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def __call__(self, done: int, units: int, seconds: float, rate: float) -> None:
        if self._is_quiet or time.monotonic() - self._shown < 0.5:
            return
        self._shown = time.monotonic()
        left = f"{seconds * (units - done) / done:.0f} s left" if done and rate > 0 else "measuring the workers"
        print(
            f"\r{100 * done / max(1, units):5.1f} %  {rate * 1e-6:.2f} Msamples/s  {left}  {self.remark()}\033[K",
            end="",
            file=sys.stderr,
            flush=True,
        )
