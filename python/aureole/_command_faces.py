# SPDX-License-Identifier: Apache-2.0
"""Parts of the commands that are written in Python (`aureole denoise`, `aureole cluster`): their $names, notes and exit codes."""

from __future__ import annotations

import sys
import warnings
from typing import Any, Callable, Dict, Sequence

from ._errors import Error
from ._scene import PARAMETERS_OF_LOADING


def defines_of(words: Sequence[str]) -> Dict[str, Any]:
    """The values of a scene's $names, written NAME=VALUE, as keyword arguments of `load_file`.

    Raises
    ------
    Error
        For a word that is not NAME=VALUE.
    """
    defines = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not name or not equals:
            raise Error(f"-D {word}: expected NAME=VALUE")
        defines[name + "_" if name in PARAMETERS_OF_LOADING else name] = value
    return defines


def exit_code_of(command: Callable[[Any], int], arguments: Any, interrupted: str) -> int:
    """Runs a command; prints warnings as notes, errors, and the sentence `interrupted` for Ctrl-C. Returns the exit code."""
    warnings.showwarning = lambda message, *_, **__: print(f"note: {message}", file=sys.stderr)
    try:
        return command(arguments)
    except (Error, OSError) as e:
        print(f"error: {e}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(interrupted, file=sys.stderr)
        return 130
