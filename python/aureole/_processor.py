# SPDX-License-Identifier: Apache-2.0
"""Checks the processor before the compiled module is loaded, so that a processor without AVX2 causes a message
instead of a crash."""

import os
import sys


def require_processor() -> None:
    """Raises ImportError where this processor cannot run the compiled module. The command `aureole` ends with the sentence alone, and exit code 2."""
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as f:
            flags = next((line.split(":", 1)[1].split() for line in f if line.startswith("flags")), None)
    except OSError:
        return  # an unknown system: the module is tried
    missing = [name for name in ("avx2", "fma", "bmi2") if flags is not None and name not in flags]
    if not missing:
        return
    problem = f"aureole: this processor lacks {', '.join(missing)} (x86-64-v3), which this build needs"
    if os.path.basename(sys.argv[0] if sys.argv else "") == "aureole":
        sys.stderr.write(problem + "\n")
        raise SystemExit(2)
    raise ImportError(problem)
