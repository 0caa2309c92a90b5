#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The installed aureole_optics, used as docs/optics.md says: package_test.py PAGE BUILD_FOLDER CMAKE CXX.

Installs the library into BUILD_FOLDER/optics-package, writes the page's CMakeLists.txt and program there, builds and runs them, and
compares with the output that the page shows. Neither the program nor the tests of the library may load a library of the renderer, nor
may the archive want a symbol of one."""
import re
import shutil
import subprocess
import sys
from pathlib import Path

page, build, cmake, compiler = sys.argv[1:]
folder = Path(build) / "optics-package"
# All that is loaded: the C and C++ runtime, the three libraries that the page names, and GoogleTest.
LOADED = re.compile(r"(linux-vdso|ld-linux\S*|lib(c|m|stdc\+\+|gcc_s|pthread|kissfft-float|polyclipping|cerf|gtest|gtest_main))\.so")
FOREIGN = re.compile(r"\b(tbb::|rtc[A-Z]|embree|Imf|png_|jpeg_|TIFF|cv::|pugi::|fmt::|nlohmann)")


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def block(language):
    """The first code block of the page in this language."""
    found = re.search(rf"^```{language}\n(.*?)^```$", Path(page).read_text(encoding="utf-8"), re.M | re.S)
    return found[1] if found else sys.exit(f"{page} has no block of {language}")


def check_libraries(program):
    names = [Path(line.split()[0]).name for line in run("ldd", program).splitlines()]
    if foreign := [name for name in names if not LOADED.match(name)]:
        sys.exit(f"{program} loads {', '.join(foreign)}")


shutil.rmtree(folder, ignore_errors=True)
source = folder / "source"
source.mkdir(parents=True)
run(cmake, "--install", build, "--component", "optics", "--prefix", folder / "installed")
(source / "CMakeLists.txt").write_text(block("cmake"), encoding="utf-8")
(source / "layer.cpp").write_text(block("cpp"), encoding="utf-8")
run(cmake, "-S", source, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={folder / 'installed'}", f"-DCMAKE_CXX_COMPILER={compiler}")
run(cmake, "--build", folder / "build")
printed, expected = run(folder / "build" / "layer"), block("text")
if printed != expected:
    sys.exit(f"{page} shows\n{expected}but its program prints\n{printed}")
check_libraries(folder / "build" / "layer")
check_libraries(Path(build) / "bin" / "aureole_optics_tests")
if foreign := [s for s in run("nm", "-Cu", folder / "installed" / "lib" / "libaureole_optics.a").splitlines() if FOREIGN.search(s)]:
    sys.exit("the archive wants\n" + "\n".join(foreign))
