#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares aureole with Mitsuba 3 on this machine: noise against time, and what a large mesh costs.

Writes its tables into docs/performance.md, whose section "Against Mitsuba" defines what they say. Python with
mitsuba 3.9.1, numpy and OpenEXR is taken where this script runs in one, else made in build/peers-venv. Mitsuba's
LLVM variants need LLVM's shared library: DRJIT_LIBLLVM_PATH, or the newest found that works.
"""
import argparse
import glob
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / "docs" / "performance.md"
MITSUBA = "3.9.1"
PARTS = ("cbox", "matpreview", "fog", "fog_chromatic", "milk", "smoke", "sparse_cloud", "mesh")


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), help="which parts; others stay as written")
    p.add_argument("--spp", nargs="+", type=int, default=[64, 256], help="samples per pixel (default: 64 256)")
    p.add_argument("--replicates", type=int, default=8, help="seeds of each program and sampler (default: 8)")
    p.add_argument("--height", type=int, default=256, help="height of the pictures in pixels (default: 256; media 3/8 of it)")
    p.add_argument("--threads", type=int, default=0, help="threads (default: all cores)")
    p.add_argument("--eradiate", metavar="PYTHON", help="an interpreter with eradiate-mitsuba 0.5.0, to render the grids with it too")
    p.add_argument("--scalar", action="store_true", help="Mitsuba's scalar_spectral too (slow)")
    p.add_argument("--triangles", type=int, default=1_000_000, help="size of the mesh (default: 1000000)")
    p.add_argument("--repeats", type=int, default=3, help="runs of each measurement of the mesh (default: 3)")
    p.add_argument("--no-write", action="store_true", help="print only, leave docs/performance.md as it is")
    p.add_argument("--aureole", type=Path, default=ROOT / "build/release/bin/aureole", help="the program")
    a = p.parse_args()
    cores = len(os.sched_getaffinity(0))
    a.threads = a.threads or cores
    a.only = [part for part in PARTS if part in a.only]
    a.aureole = a.aureole.resolve()
    if not 1 <= a.threads <= cores:
        p.error(f"--threads {a.threads}: this machine lends {cores} cores")
    if a.replicates < 2:
        p.error("--replicates: a variance needs two or more")
    if min(a.spp + [a.height, a.repeats]) < 1:
        p.error("--spp, --height and --repeats must be positive")
    if a.triangles < 1000:
        p.error("--triangles: at least 1000")
    if not a.aureole.is_file():
        p.error(f"there is no {a.aureole}: make build")
    return a


def fits(python):
    """Whether an interpreter has everything, Mitsuba in the version that is compared."""
    code = "import mitsuba, numpy, OpenEXR; print(mitsuba.__version__)"
    try:
        r = subprocess.run([python, "-c", code], capture_output=True, text=True)
    except OSError:
        return False
    return r.returncode == 0 and r.stdout.strip() == MITSUBA


def enter_environment():
    """Runs this script again with an interpreter that has Mitsuba, unless this one has."""
    if fits(sys.executable):
        return
    venv = ROOT / "build" / "peers-venv"
    python = str(venv / "bin" / "python")
    if not fits(python):
        print(f"making a Python environment with Mitsuba {MITSUBA} in {venv}", file=sys.stderr)
        packages = [f"mitsuba=={MITSUBA}", "numpy", "OpenEXR"]
        for command in ([sys.executable, "-m", "venv", str(venv)],
                        [python, "-m", "pip", "install", "-q", *packages]):
            if subprocess.run(command).returncode != 0:
                sys.exit(f"failed: {' '.join(command)}\n(Debian's package for the first step is python3-venv; the "
                         f"second needs the network. Or run bench/peers.py with a Python that has "
                         f"{', '.join(packages)}.)")
        if not fits(python):
            sys.exit(f"{python} cannot import mitsuba {MITSUBA}, numpy and OpenEXR; remove {venv} to try again")
    os.execv(python, [python, __file__, *sys.argv[1:]])


def version_of(library):
    """libLLVM.so.19.1, libLLVM-19.so: (19, 1), (19,)."""
    found = re.search(r"libLLVM(?:\.so\.|-)(\d+(?:\.\d+)*)", os.path.basename(os.path.realpath(library)))
    return tuple(map(int, found[1].split("."))) if found else ()


def find_llvm():
    """Sets DRJIT_LIBLLVM_PATH to a library with which Mitsuba compiles; returns LLVM's version."""
    given = os.environ.get("DRJIT_LIBLLVM_PATH")
    patterns = ("/usr/lib/*/libLLVM*.so*", "/usr/lib64/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*",
                "/usr/local/lib/libLLVM*.so*")
    paths = [given] if given else {os.path.realpath(path) for pattern in patterns for path in glob.glob(pattern)}
    problem = ""
    for path in sorted(paths, key=version_of, reverse=True):
        r = subprocess.run([sys.executable, ROOT / "bench/peers_mitsuba.py", "check"], capture_output=True, text=True,
                           env=dict(os.environ, DRJIT_LIBLLVM_PATH=path))
        if r.returncode == 0:
            os.environ["DRJIT_LIBLLVM_PATH"] = path
            return r.stdout.strip()
        problem += f"\n{path}: {(r.stderr.strip().splitlines() or ['crashed'])[-1]}"
    sys.exit("Mitsuba's LLVM variants need the shared library of LLVM, and " +
             (f"none works:{problem}" if problem else "there is none") +
             "\nInstall it (Debian: apt-get install libllvm19, or another version) or set DRJIT_LIBLLVM_PATH to the "
             "file.")


def choose_processors(threads):
    """Binds this process and its children to as many cores as there are threads, one of each pair of siblings first, so
    that no program can use more (Embree's builders and helper threads count too)."""
    def rank(cpu):
        try:
            siblings = Path(f"/sys/devices/system/cpu/cpu{cpu}/topology/thread_siblings_list").read_text()
            return re.split("[,-]", siblings.strip()).index(str(cpu)), cpu
        except (OSError, ValueError):
            return 0, cpu
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0), key=rank)[:threads])


class Progress:
    """Progress and the estimated time left. Work of one kind takes time in proportion to its size."""

    def __init__(self, items):
        self.left, self.rates, self.all = {}, {}, [0.0, 0.0]
        for kind, size in items:
            self.left[kind] = self.left.get(kind, 0) + size
        self.count, self.done, self.printed = len(items), 0, 0.0
        self.line = sys.stderr.isatty()

    def step(self, kind, size, seconds, text):
        self.left[kind] -= size
        for total in (self.rates.setdefault(kind, [0.0, 0.0]), self.all):
            total[0] += seconds
            total[1] += size
        self.done += 1
        left = 0
        for other, amount in self.left.items():
            spent, work = self.rates.get(other, self.all)
            left += amount * spent / work
        now = time.monotonic()
        if self.line or now - self.printed > 10 or self.done == self.count:
            self.printed = now
            minutes, s = divmod(round(left), 60)
            text = f"[{self.done}/{self.count}] {text}: {seconds:.2f} s;  {minutes // 60}:{minutes % 60:02}:{s:02} left"
            print(f"\r{text}\033[K" if self.line else text, end="" if self.line else "\n", file=sys.stderr, flush=True)
            if self.line and self.done == self.count:
                print(file=sys.stderr)


def processor():
    names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    return names[0].strip() if names else "unknown processor"


def updated(document, tables):
    """The document with the parts that were measured replaced between its markers; other parts stay."""
    begin, end = "<!-- peers -->", "<!-- /peers -->"
    if document.count(begin) != 1 or document.count(end) != 1 or document.index(begin) > document.index(end):
        sys.exit(f"{DOCUMENT}: expected one {begin} before one {end}")
    before, rest = document.split(begin)
    old, after = rest.split(end)
    pieces = re.split(r"<!-- peers (\w+) -->\n", old)
    parts = dict(zip(pieces[1::2], (text.strip() for text in pieces[2::2]))) | tables
    text = "".join(f"<!-- peers {part} -->\n{parts[part]}\n\n" for part in PARTS if part in parts)
    return f"{before}{begin}\n{text.rstrip()}\n{end}{after}"


def write(tables):
    text = updated(DOCUMENT.read_text(), tables)
    handle, temporary = tempfile.mkstemp(dir=DOCUMENT.parent, prefix=".performance-")
    try:
        with os.fdopen(handle, "w") as f:
            f.write(text)
        os.chmod(temporary, DOCUMENT.stat().st_mode)
        os.replace(temporary, DOCUMENT)
    except BaseException:
        os.unlink(temporary)
        raise


def measure(a):
    import peers_efficiency
    import peers_mesh

    llvm = find_llvm()
    choose_processors(a.threads)
    load = os.getloadavg()[0]
    if load > 0.3:
        print(f"note: the machine is not quiet (load average {load:.2f})", file=sys.stderr)
    version = subprocess.run([a.aureole, "--version"], capture_output=True, text=True).stdout.split()
    threads = f"{a.threads} thread{'s' * (a.threads > 1)}"
    conditions = (f"{threads}, {processor()}; aureole {version[-1] if version else '?'}, Mitsuba {MITSUBA} with "
                  f"LLVM {llvm}.")
    with tempfile.TemporaryDirectory(prefix="aureole-peers-") as folder:
        folder = Path(folder)
        scenes = [s for s in peers_efficiency.find_scenes(a, folder) if s.name in a.only]
        items = [i for s in scenes for i in peers_efficiency.items(a, s)]
        if "mesh" in a.only:
            items += peers_mesh.items(a)
        progress = Progress(items)
        tables = {}
        for scene in scenes:
            tables[scene.name] = peers_efficiency.run(a, scene, folder, progress, conditions)
            print(f"\n{tables[scene.name]}\n", flush=True)
        if "mesh" in a.only:
            tables["mesh"] = peers_mesh.run(a, folder, progress, conditions)
            print(f"\n{tables['mesh']}\n", flush=True)
    return tables


def main():
    a = arguments()
    enter_environment()

    def stop(*_):
        raise KeyboardInterrupt
    signal.signal(signal.SIGTERM, stop)
    try:
        tables = measure(a)
        if a.no_write or not tables:
            print(f"{DOCUMENT} is as it was", file=sys.stderr)
            return
        write(tables)
        print(f"written: {', '.join(tables)} in {DOCUMENT}", file=sys.stderr)
    except KeyboardInterrupt:
        print(f"\ninterrupted: {DOCUMENT} is as it was", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
