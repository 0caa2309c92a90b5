# SPDX-License-Identifier: Apache-2.0
"""The package and programs that use it under `mypy --strict`; wrong uses are reported where, and only where, they are marked."""
from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import List, Set, Tuple

import aureole

PROGRAMS = Path(__file__).parent / "typing"


def mypy(folder: Path, *arguments: str) -> List[str]:
    path = f"{Path(aureole.__file__).parents[1]}:{PROGRAMS}"
    program = ("import os, sys; os.environ['MYPYPATH'] = sys.argv.pop(1); from mypy.__main__ import console_entry; console_entry()")
    done = subprocess.run([sys.executable, "-c", program, path, "--strict", "--config-file", str(PROGRAMS / "mypy.ini"),
                           "--show-error-codes", "--no-error-summary", "--cache-dir", os.devnull, *arguments],
                          cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode in (0, 1), done.stdout
    return [line for line in done.stdout.splitlines() if ": note:" not in line]


def test_types(tmp_path: Path) -> None:
    expected: Set[Tuple[int, str]] = set()
    for number, line in enumerate((PROGRAMS / "wrong.py").read_text().splitlines(), 1):
        if m := re.search(r"# error: ([\w-]+)$", line):
            expected.add((number, m[1]))
    reported: Set[Tuple[int, str]] = set()
    # One run for all, since most of its time goes into the types of numpy.
    for line in mypy(tmp_path, "-p", "aureole", "-m", "right", "-m", "wrong"):
        m = re.fullmatch(r".*wrong\.py:(\d+): error: .*\[([\w-]+)\]", line)
        assert m, line
        reported.add((int(m[1]), m[2]))
    assert expected and reported == expected
