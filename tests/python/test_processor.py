# SPDX-License-Identifier: Apache-2.0
"""A processor that cannot run the module gets a sentence, before the module is loaded."""
from __future__ import annotations

import builtins
import io
import subprocess
import sys
from pathlib import Path
from typing import Any, Optional

import pytest

from aureole._processor import require_processor

CPUINFO = "processor\t: 0\nvendor_id\t: GenuineIntel\nflags\t\t: fpu sse sse2 avx {}\nbugs\t\t: spectre_v1 avx2 fma bmi2\n"


def fake_cpuinfo(monkeypatch: pytest.MonkeyPatch, text: Optional[str]) -> None:
    real_open = builtins.open

    def fake(path: Any, *args: Any, **kwargs: Any) -> Any:
        if path != "/proc/cpuinfo":
            return real_open(path, *args, **kwargs)
        if text is None:
            raise FileNotFoundError(path)
        return io.StringIO(text)

    monkeypatch.setattr(builtins, "open", fake)


@pytest.mark.parametrize("flags, missing", [("fma bmi2", "avx2"), ("avx2 bmi2", "fma"), ("avx2 fma", "bmi2"), ("", "avx2, fma, bmi2"),
                                            ("avx512f avx2x fma bmi2", "avx2")])
def test_old_processor(monkeypatch: pytest.MonkeyPatch, flags: str, missing: str) -> None:
    fake_cpuinfo(monkeypatch, CPUINFO.format(flags))
    with pytest.raises(ImportError, match=f"this processor lacks {missing} \\(x86-64-v3\\), which this build needs"):
        require_processor()


@pytest.mark.parametrize("text", [CPUINFO.format("avx2 fma bmi1 bmi2"), "", None])
def test_able_or_unknown_processor(monkeypatch: pytest.MonkeyPatch, text: Optional[str]) -> None:
    fake_cpuinfo(monkeypatch, text)
    require_processor()


def test_the_module_is_not_loaded() -> None:
    program = ("import builtins, io, sys\n"
               "real = builtins.open\n"
               "builtins.open = lambda p, *a, **k: io.StringIO('flags : sse2') if p == '/proc/cpuinfo' else real(p, *a, **k)\n"
               "try:\n    import aureole\n"
               "except ImportError as e:\n    print(e, 'aureole._aureole' in sys.modules)\n")
    done = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout == ("aureole: this processor lacks avx2, fma, bmi2 (x86-64-v3), which this build needs False\n")


def test_the_command_says_so_without_a_traceback(tmp_path: Path) -> None:
    command = tmp_path / "aureole"  # as pip writes it
    command.write_text("import builtins, io, sys\n"
                       "real = builtins.open\n"
                       "builtins.open = lambda p, *a, **k: io.StringIO('flags : sse2') if p == '/proc/cpuinfo' else real(p, *a, **k)\n"
                       "from aureole._command import main\n"
                       "sys.exit(main())\n")
    done = subprocess.run([sys.executable, command, "--version"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "aureole: this processor lacks avx2, fma, bmi2 (x86-64-v3), which this build needs\n"
