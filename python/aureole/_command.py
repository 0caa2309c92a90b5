# SPDX-License-Identifier: Apache-2.0
"""The command ``aureole`` that the package installs."""
import importlib
import signal
import sys


def main() -> int:
    """Runs the command line of the program with the process's arguments and returns its exit code."""
    from ._aureole import run_command_line

    # The signal handlers of a program: Python catches SIGINT, which the program's own handlers replace where
    # a render can be stopped, and ignores SIGPIPE.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    arguments = sys.argv[1:]
    for argument in arguments:
        if any("\udc80" <= c <= "\udcff" for c in argument):
            print(f"error: {argument!a}: expected an argument in UTF-8", file=sys.stderr)
            return 2
    if arguments[:1] in (["cluster"], ["denoise"]):
        signal.signal(signal.SIGINT, signal.default_int_handler)
        return int(importlib.import_module(f"aureole._{arguments[0]}_command").main(arguments[1:]))
    return run_command_line(["aureole", *arguments])


if __name__ == "__main__":
    sys.exit(main())
