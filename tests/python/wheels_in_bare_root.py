#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs wheels in a bare Debian and uses them there: wheels_in_bare_root.py WHEELS FOLDER PROGRAM [SUITE].

WHEELS is a folder of wheels (`make wheels`), PROGRAM the program of this build. debootstrap makes a root file system of SUITE (bookworm) in FOLDER, with
nothing but the smallest Debian and its Python; it is kept for the next run. Interpreters of other versions that a wheel is for are
copied into it, from pyenv or as make_wheels.sh finds them. In the root, without a network, each wheel is installed by pip into a new environment,
with numpy and tqdm as PyPI has them for that version. Then

- the command renders scenes of all that the program can do, with the same pixels as PROGRAM on this machine,
- Python imports the package, renders, and finds that files of all kinds are inside,
- `aureole cluster` and `aureole denoise` say which package they need,
- on a processor without AVX2 (qemu-user, and a list of the processor's flags without them) both say so in a sentence.

It needs root, debootstrap, and for the last check qemu-user-static; a check that cannot be made is said. Not a part of `make test`.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))
from picture_hashes import pixel_hash  # noqa: E402

SMALL = ["-D", "width=48", "-D", "height=32"]
# A scene for each kind of file or model that a library inside the wheel serves.
SCENES = {
    "condensation": ["scenes/condensation/condensation.xml", *SMALL],
    "corona of discs": ["scenes/corona/spheres.xml", *SMALL],
    "diffraction": ["scenes/diffraction/razor.xml", *SMALL],
    "hair": ["scenes/hair/hair.xml", *SMALL],
    "lens": ["scenes/light/double_gauss.xml", *SMALL],
    "measured materials": ["scenes/measured/measured.xml", *SMALL],
    "medium of spheres": ["scenes/media/turbid.xml", *SMALL],
    "OpenVDB": ["cloud.xml"],
    "paint": ["scenes/paint/paint.xml", *SMALL],
    "splats": ["scenes/splats/street_view.xml", *SMALL],
    "volume of NRRD": ["scenes/volumes/orbital.xml", *SMALL],
}
CLOUD = """<scene version="3.0.0">
  <integrator type="volpath"/>
  <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world"><lookat origin="0, -5, 2" target="0, 0, 0.5" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film></sensor>
  <emitter type="constant"/>
  <shape type="sphere"><bsdf type="null"/><medium type="heterogeneous" name="interior">
    <volume type="vdbvolume" name="sigma_t"><string name="filename" value="tests/references/scenes/volumes/cloud.vdb"/>
      <transform name="to_world"><scale value="0.1"/></transform></volume></medium></shape>
</scene>
"""
PROGRAM = """
import tempfile, os
import numpy as np
import aureole, aureole.cluster, aureole.optics, aureole.pigment, aureole.plot, aureole.spectrum
image = aureole.render(aureole.load_file("/src/scenes/condensation/condensation.xml", width=32, height=24), 4, progress=False)
assert image.array.shape[:2] == (24, 32) and np.isfinite(image.array).all() and image.array.mean() > 0
folder = tempfile.mkdtemp()
image.save(os.path.join(folder, "a.exr"))
for ending in ("exr", "png", "jpg", "tif", "hdr"):
    if ending != "exr":
        aureole.convert(os.path.join(folder, "a.exr"), os.path.join(folder, "a." + ending))
    assert aureole.read_image(os.path.join(folder, "a." + ending)).array.shape[:2] == (24, 32), ending
assert aureole.optics.mie is not None and aureole.load_dict({"type": "diffuse"}).eval([0, 0, 1], [0, 0, 1], 550).size
print("aureole", aureole.__version__, "of CPython %d.%d" % __import__("sys").version_info[:2])
"""


class Bare:
    """A root file system in `folder`; `run` runs a command in it, with /proc, without a network, and without anything of the environment."""

    def __init__(self, folder: Path, suite: str) -> None:
        self.folder = folder
        stamp = folder / "made-by-debootstrap"
        if not stamp.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            subprocess.run(["debootstrap", "--variant=minbase", "--include=python3,python3-venv", suite, folder], check=True, stdout=subprocess.DEVNULL)
            stamp.write_text(suite + "\n")
        for name in ("scenes", "tests/references/scenes"):
            shutil.rmtree(folder / "src" / name, ignore_errors=True)
            shutil.copytree(ROOT / name, folder / "src" / name, symlinks=True)
        (folder / "src/cloud.xml").write_text(CLOUD)

    def run(self, *command: object, cpuinfo: "Path | None" = None) -> "subprocess.CompletedProcess[str]":
        mount = f"mount --bind {cpuinfo} {self.folder}/proc/cpuinfo; " if cpuinfo else ""
        shell = f'{mount}exec chroot "$0" /usr/bin/env -i PATH=/usr/bin:/bin HOME=/root LANG=C.UTF-8 "$@"'
        return subprocess.run(["unshare", "--net", "--mount", "--pid", "--fork", f"--mount-proc={self.folder}/proc", "sh", "-c", shell, self.folder,
                               *map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=900)

    def checked(self, *command: object) -> str:
        done = self.run(*command)
        assert done.returncode == 0, f"{command}: exit code {done.returncode}\n{done.stdout}"
        return done.stdout


def interpreter_of(version: str) -> "Path | None":
    """An interpreter of this machine with the version, such as "3.9"."""
    given = os.environ.get("PYTHON_" + version.replace(".", "_"))
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for candidate in [given, *sorted(map(str, pyenv.glob(f"{version}.*/bin/python{version}"))), f"/usr/bin/python{version}"]:
        if candidate and Path(candidate).exists():
            return Path(candidate)
    return None


def copied_into(bare: Bare, interpreter: Path) -> str:
    """Copies an interpreter with its standard library, and the shared libraries of this machine that it needs and the root lacks. Returns its path there."""
    prefix = Path(subprocess.run([interpreter, "-c", "import sys; print(sys.base_prefix)"], check=True, stdout=subprocess.PIPE, text=True).stdout.strip())
    target = bare.folder / str(prefix).lstrip("/")
    if not target.exists():
        def unneeded(folder: str, names: "list[str]") -> "list[str]":
            return [n for n in names if n in ("test", "tests", "idlelib", "__pycache__", "site-packages", "share") or n.endswith(".a")]

        shutil.copytree(prefix, target, symlinks=True, ignore=unneeded)
        (target / "lib" / interpreter.name / "site-packages").mkdir(exist_ok=True)
    libraries = subprocess.run(["ldd", *(prefix / "lib").glob("python3*/lib-dynload/*.so"), interpreter], stdout=subprocess.PIPE, text=True).stdout
    for path in set(re.findall(r"=> (/\S+)", libraries)):
        here, there = Path(path), bare.folder / path.lstrip("/")
        if not there.exists() and not here.resolve().is_relative_to(prefix):
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(here.resolve(), there)
    return str(interpreter)


def wheels_of_dependencies(interpreter: Path, folder: Path) -> None:
    """numpy and tqdm for an interpreter's version, of PyPI."""
    version = re.search(r"python(\d\.\d+)$", interpreter.name).group(1)
    subprocess.run([sys.executable, "-m", "pip", "download", "-q", "--disable-pip-version-check", "--only-binary", ":all:", "--python-version", version,
                    "--platform", "manylinux_2_28_x86_64", "--platform", "manylinux_2_27_x86_64", "--platform", "manylinux_2_17_x86_64",
                    "--platform", "manylinux2014_x86_64", "-d", folder, "numpy", "tqdm"], check=True)


def hashes_of_program(program: Path, scenes: Path, folder: Path) -> "dict[str, str]":
    found = {}
    for name, arguments in SCENES.items():
        out = folder / "program.exr"
        subprocess.run([program, "render", scenes / arguments[0], *arguments[1:], "--spp", "4", "-o", out, "-q", "--restart"], check=True)
        found[name] = pixel_hash(out)
    return found


def check_wheel(bare: Bare, wheel: Path, version: str, python: str, dependencies: Path, expected: "dict[str, str]") -> None:
    place = f"/opt/aureole-{version}"
    for name in (place, "/wheels"):
        shutil.rmtree(bare.folder / name.lstrip("/"), ignore_errors=True)
    shutil.copytree(dependencies, bare.folder / "wheels")
    shutil.copy(wheel, bare.folder / "wheels")
    bare.checked(python, "-m", "venv", place)
    bare.checked(f"{place}/bin/python", "-m", "pip", "install", "-q", "--no-index", "--find-links", "/wheels", "aureole")
    command = f"{place}/bin/aureole"
    assert re.fullmatch(r"aureole \d+\.\d+\.\d+.*\n", bare.checked(command, "--version")), "aureole --version"
    print("  " + bare.checked(f"{place}/bin/python", "-c", PROGRAM).strip(), flush=True)
    for name, arguments in SCENES.items():
        bare.checked(command, "render", f"/src/{arguments[0]}", *arguments[1:], "--spp", "4", "-o", "/tmp/wheel.exr", "-q", "--restart")
        found = pixel_hash(bare.folder / "tmp/wheel.exr")
        assert found == expected[name], f"{name}: the wheel renders other pixels than the program"
    print(f"  {len(SCENES)} scenes have the pixels of the program", flush=True)
    for words, package in ((["cluster", "render", "/src/scenes/condensation/condensation.xml", "--local", "1"], "Dask"),
                           (["denoise", "/tmp/wheel.exr", "-o", "/tmp/clean.exr"], "pyoidn")):
        done = bare.run(command, *words)
        assert done.returncode == 2 and package in done.stdout and "Traceback" not in done.stdout, f"{words}: {done.returncode}\n{done.stdout}"
    check_old_processor(bare, place)


def check_old_processor(bare: Bare, place: str) -> None:
    """A processor without AVX2, FMA and BMI2: qemu emulates it, and /proc/cpuinfo, which qemu passes on from this machine, has its flags."""
    qemu = shutil.which("qemu-x86_64-static") or shutil.which("qemu-x86_64")
    flags = bare.folder / "tmp/cpuinfo"
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    flags.write_text("\n".join(" ".join(w for w in line.split(" ") if w not in ("avx2", "fma", "bmi2")) for line in lines) + "\n")
    emulator: "list[object]" = []
    if qemu is None or b"dynamically" in subprocess.run(["file", "-L", qemu], stdout=subprocess.PIPE).stdout:
        print("  without AVX2: qemu-user-static is not installed; the list of flags alone")
    else:
        shutil.copy(qemu, bare.folder / "tmp/qemu")
        emulator = ["/tmp/qemu", "-cpu", "SandyBridge"]
    python = f"{place}/bin/python"
    imported = bare.run(*emulator, python, "-c", "import aureole", cpuinfo=flags)
    sentence = "this processor lacks avx2, fma, bmi2"
    assert imported.returncode == 1 and f"ImportError: aureole: {sentence}" in imported.stdout, imported.stdout
    command = bare.run(*emulator, python, f"{place}/bin/aureole", "--version", cpuinfo=flags)
    assert command.returncode == 2 and sentence in command.stdout and "Traceback" not in command.stdout, command.stdout
    print("  without AVX2: " + command.stdout.strip().splitlines()[-1], flush=True)


def main() -> None:
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    wheels, folder, program = (Path(word).resolve() for word in sys.argv[1:4])
    if os.geteuid() != 0:
        sys.exit("wheels_in_bare_root.py makes a root file system: it needs root")
    if shutil.which("debootstrap") is None:
        sys.exit("there is no debootstrap: apt-get install debootstrap qemu-user-static")
    found = sorted(wheels.glob("aureole-*.whl"))
    if not found:
        sys.exit(f"{wheels}: there are no wheels (make wheels)")
    suite = sys.argv[4] if len(sys.argv) == 5 else "bookworm"
    bare = Bare(folder / suite, suite)
    own = bare.checked("/usr/bin/python3", "-c", "import sys; print('%d.%d' % sys.version_info[:2])").strip()
    with tempfile.TemporaryDirectory() as temporary:
        expected = hashes_of_program(program, bare.folder / "src", Path(temporary))
        for wheel in found:
            minor = int(re.search(r"-cp3(\d+)-", wheel.name).group(1))
            versions = [f"3.{minor}"] if "-abi3-" not in wheel.name else [f"3.{n}" for n in range(minor, minor + 4)]
            for version in versions:
                interpreter = Path("/usr/bin/python3") if version == own else interpreter_of(version)
                if interpreter is None:
                    print(f"{wheel.name}: there is no CPython {version} on this machine to test it with")
                    continue
                print(f"{wheel.name} ({wheel.stat().st_size / 1e6:.1f} MB) with CPython {version}", flush=True)
                python = str(interpreter) if version == own else copied_into(bare, interpreter)
                dependencies = Path(temporary) / version
                wheels_of_dependencies(Path(f"python{version}"), dependencies)
                check_wheel(bare, wheel, version, python, dependencies, expected)
    print("the wheels work in a bare root")


if __name__ == "__main__":
    main()
