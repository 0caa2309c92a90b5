# SPDX-License-Identifier: Apache-2.0
"""Bars of progress in terminals and notebooks, with and without ipywidgets: of renders, of loading and of tables."""

from __future__ import annotations

import threading
import warnings
from typing import Any, Callable, List, Optional, Union

#: Called with the units of work done, all of them, seconds so far and samples per second.
Report = Callable[[int, int, float, float], None]
#: Called with what is loaded or the object whose tables are made, and the part of the tables that is done; None while a file is read.
LoadReport = Callable[[str, Optional[float]], None]

_WAIT_S = 1.0  # before a bar of loading is shown
_STEP_S = 0.5


def new_bar(**options: Any) -> Any:
    """A bar of tqdm, which knows terminals and notebooks."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a notebook without ipywidgets shows a bar of text without a warning
        from tqdm.auto import tqdm
    return tqdm(leave=False, dynamic_ncols=True, **options)


class RenderBar:
    """A bar of a render while it is entered. `remark` is shown behind the speed."""

    def __init__(self, progress: Union[bool, Report], remark: Optional[Callable[[], str]] = None, unit: str = "tile") -> None:
        if not isinstance(progress, bool) and not callable(progress):
            raise TypeError(f"progress: expected True, False or a function, got {type(progress).__name__}")
        self._progress, self._remark, self._unit = progress, remark, unit
        self._bar: Any = None

    def __enter__(self) -> Optional[Report]:
        if not isinstance(self._progress, bool):
            return self._progress
        if not self._progress:
            return None
        return self._update

    def _update(self, done: int, units: int, seconds: float, rate: float) -> None:
        if self._bar is None:
            self._bar = new_bar(total=units, unit=self._unit, delay=0.5)
        words = [f"{rate * 1e-6:.2f} Msamples/s"] if rate > 0 else []
        words += [self._remark()] if self._remark is not None else []
        self._bar.set_postfix_str(", ".join(words), refresh=False)
        self._bar.update(done - self._bar.n)

    def __exit__(self, *exception: Any) -> None:
        if self._bar is not None:
            self._bar.close()


class _Entered(threading.local):
    def __init__(self) -> None:
        self.bars: List["LoadBar"] = []


_entered = _Entered()


class LoadBar:
    """A bar while it is entered, of what takes more than a second: the time of reading `name`, then the part of each object's tables.

    The compiled module reports tables to the last bar that the loading thread has entered. Without `shows_time` there is no bar but for tables: a
    single object reads little, and a thread that waits for the first second would cost more than a small object.
    """

    def __init__(self, name: str, progress: Union[bool, LoadReport] = True, shows_time: bool = True) -> None:
        if not isinstance(progress, bool) and not callable(progress):
            raise TypeError(f"progress: expected True, False or a function, got {type(progress).__name__}")
        self._name, self._progress, self._shows_time = name, progress, shows_time
        self._bar: Any = None
        self._object: Optional[str] = None  # whose tables are shown
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._thread: Optional[threading.Thread] = None

    def __enter__(self) -> LoadBar:
        if not isinstance(self._progress, bool):
            self._progress(self._name, None)  # may raise: nothing is entered yet
        elif self._progress and self._shows_time:
            self._thread = threading.Thread(target=self._watch, daemon=True)
            self._thread.start()
        _entered.bars.append(self)
        return self

    def __exit__(self, *exception: Any) -> None:
        _entered.bars.remove(self)
        self._over.set()
        if self._thread is not None:
            self._thread.join()
        if self._bar is not None:
            self._bar.close()

    def _watch(self) -> None:
        """Shows the time while no tables are reported."""
        if self._over.wait(_WAIT_S):
            return
        while True:
            with self._lock:
                if self._bar is None:
                    self._bar = new_bar(desc=f"loading {self._name}", bar_format="{desc} {elapsed}")
                if self._object is None:
                    self._bar.refresh()
            if self._over.wait(_STEP_S):
                return

    def tables(self, name: str, part: float) -> None:
        """Shows the part of an object's tables that is done."""
        if not self._progress:
            return
        if not isinstance(self._progress, bool):
            self._progress(name, part)
            return
        with self._lock:
            if self._object != name:
                if self._bar is not None:
                    self._bar.close()
                self._bar = new_bar(total=1.0, desc=f"tables of {name}", bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")
                self._object = name
            self._bar.n = min(1.0, part)
            self._bar.refresh()


def show_tables(name: str, part: float) -> None:
    """Called by the compiled module in the thread that loads, from the first second on, several times in a second."""
    if _entered.bars:
        _entered.bars[-1].tables(name, part)
