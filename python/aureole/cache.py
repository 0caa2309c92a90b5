# SPDX-License-Identifier: Apache-2.0
"""Tables that are kept for the next start: the folder in which slow tables of scenes are stored (docs/cache.md).

The folder is that of the environment variable ``AUREOLE_CACHE`` (a folder, or ``off``), or else ``$XDG_CACHE_HOME/aureole`` or
``~/.cache/aureole``, as for the command line.
"""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Union

from . import _aureole
from ._arrays import file_path, shown
from ._errors import Error
from ._results import Table


@dataclass(frozen=True)
class KeptTables(Table):
    """The kept tables, the last used first; lists of equal length."""

    file: List[str]
    #: Sizes of the files.
    bytes: List[int]
    #: Times of the last use, in seconds since 1970.
    used_s: List[int]
    #: Kinds of tables, such as "phase function"; empty for damaged files, which are computed again.
    table: List[str]
    #: The plug-ins for which they were made, such as "phase mie".
    made_for: List[str]
    #: The programs that have made them. Tables of other versions are not read, and are removed with time.
    build: List[str]
    #: Times that their computation took.
    seconds: List[float]

    def columns(self) -> Dict[str, Any]:
        return {"table": self.table, "made_for": self.made_for, "bytes": self.bytes, "seconds": self.seconds, "used_s": self.used_s,
                "file": self.file, "build": self.build}

    def _title(self) -> str:
        return f"{len(self.file)} table{'' if len(self.file) == 1 else 's'}, {sum(self.bytes) * 1e-6:.1f} MB"

    def __len__(self) -> int:
        return len(self.file)


def use(folder: "str | os.PathLike[str] | None") -> None:
    """Chooses the folder for scenes that this process loads from now on.

    Parameters
    ----------
    folder : path-like or None
        The folder, which need not exist; "off" for no cache; None for that of the environment.
    """
    _aureole.cache_use("" if folder is None else file_path("folder", folder))


def folder() -> Optional[str]:
    """The folder in use; None where the cache is off."""
    return _aureole.cache_folder()


def entries() -> KeptTables:
    """Lists the kept tables. Raises Error where the cache is off."""
    rows = _aureole.cache_entries()
    columns: List[List[Any]] = [list(column) for column in zip(*rows)] if rows else [[] for _ in range(7)]
    return KeptTables(*columns)


def size() -> int:
    """The size of all kept tables in bytes. Raises Error where the cache is off."""
    return sum(entries().bytes)


def clear() -> int:
    """Removes all kept tables and returns their number. Other files of the folder stay. Raises Error where the cache is off."""
    return _aureole.cache_clear()


def limit(bytes: Union[int, str, None] = None) -> int:
    """The upper bound of the size in bytes, after it was set, where `bytes` is given, for all programs that use the folder.

    Parameters
    ----------
    bytes : int or str, optional
        A number, or one with its unit, such as "500MB" or "2GB". The tables that were used longest ago are removed.

    Returns
    -------
    int
    """
    if bytes is not None:
        if isinstance(bytes, bool) or not isinstance(bytes, (int, str)):
            raise TypeError(f"bytes: expected a number or a text such as 500MB, got {shown(bytes)}")
        if isinstance(bytes, int) and bytes < 0:
            raise Error(f"bytes: must not be negative, got {bytes}")
        _aureole.cache_set_limit(str(bytes))
    return _aureole.cache_limit()


__all__ = ["KeptTables", "clear", "entries", "folder", "limit", "size", "use"]
