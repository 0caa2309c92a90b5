# SPDX-License-Identifier: Apache-2.0
"""The command ``aureole`` that the package installs."""
import signal
import sys


def main() -> int:
    """Runs the command line of the program with the process's arguments and returns its exit code."""
    from ._aureole import run_command_line

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # the program sets its own handlers
    return run_command_line(["aureole", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
