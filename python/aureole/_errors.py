# SPDX-License-Identifier: Apache-2.0
"""Exceptions of the package. Everything that a caller can do wrong ends in one of them or in a TypeError, never in an abort."""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Iterable

_PLACE = re.compile(r"(?P<file>.+?):(?P<line>\d+):(?:(?P<column>\d+):)? (?P<message>.*)", re.DOTALL)


class Error(ValueError):
    """Wrong input. The message names the argument or the position in a file, and the expected value."""


@dataclass(frozen=True)
class Problem:
    """One problem of a scene.

    Attributes
    ----------
    message : str
        The problem, with the nearest valid name where there is one.
    file : str
        The file, or the path of the entry in a scene made from dicts; empty where unknown.
    line, column : int
        The position in the file, from 1; 0 where unknown.
    """

    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    @classmethod
    def parse(cls, text: str) -> "Problem":
        """The problem that a message of the form ``file:line:column: message`` describes."""
        m = _PLACE.fullmatch(text)
        if not m:
            return cls(text)
        return cls(m["message"], m["file"], int(m["line"]), int(m["column"] or 0))

    def __str__(self) -> str:
        place = ":".join([self.file] + [str(n) for n in (self.line, self.column) if n])
        return f"{place}: {self.message}" if self.file else self.message


class SceneError(Error):
    """A scene with problems; `problems` holds all of them, in the order of the file.

    Attributes
    ----------
    problems : list of Problem
    """

    def __init__(self, problems: "Iterable[str | Problem]"):
        self.problems = [p if isinstance(p, Problem) else Problem.parse(p) for p in problems]
        super().__init__("\n".join(str(p) for p in self.problems))
