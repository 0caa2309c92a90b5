# SPDX-License-Identifier: Apache-2.0
"""Builds the wheel, installs it in a new virtual environment and compares its command with the program: wheel.py PROGRAM FOLDER.

The environment sees numpy and tqdm of the one that runs this script, and nothing else of it; nothing is downloaded. No environment
variable but PATH and HOME reaches what is installed.
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENE = """<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective"> <float name="fov" value="24"/>
    <film type="hdrfilm"> <integer name="width" value="64"/> <integer name="height" value="48"/> </film> </sensor>
  <shape type="rectangle"> <transform name="to_world"><translate z="1"/></transform>
    <bsdf type="correlated_scatterers">
      <string name="radius" value="5um"/> <float name="area_fraction" value="0.5"/>
    </bsdf> </shape>
  <shape type="sphere"> <point name="center" x="0" y="0" z="20"/> <float name="radius" value="0.05"/>
    <emitter type="area"> <float name="radiance" value="1000"/> </emitter> </shape>
</scene>
"""
# System libraries that PEP 600 and auditwheel's policy allow a wheel of this tag to need, without those for graphics.
SYSTEM_LIBRARIES = {"libc.so.6", "libm.so.6", "libgcc_s.so.1", "libstdc++.so.6", "libz.so.1", "ld-linux-x86-64.so.2"}


def build(folder: Path, table: Path) -> Path:
    start = time.monotonic()
    done = subprocess.run([ROOT / "tools/make_wheel.sh", folder], check=True, stdout=subprocess.PIPE, text=True,
                          env={**os.environ, "ZIP_LEVEL": "1", "UPSAMPLING_TABLE": str(table)})
    wheel = Path(done.stdout.strip())
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {time.monotonic() - start:.0f} s")
    return wheel


def install(wheel: Path, folder: Path) -> Path:
    """A new environment with the wheel. Returns the folder of its programs."""
    venv.create(folder, with_pip=False, symlinks=True)
    python = folder / "bin/python"
    subprocess.run([sys.executable, "-m", "pip", "--python", python, "install", "-q", "--disable-pip-version-check", "--no-index",
                    "--no-deps", wheel], check=True)
    import numpy
    import tqdm
    site = next((folder / "lib").glob("python*/site-packages"))
    for package in (numpy, tqdm):
        source = Path(package.__file__).parent
        for path in source.parent.glob(source.name + "*"):  # numpy.libs too
            if path.suffix != ".dist-info":
                (site / path.name).symlink_to(path)
    return folder / "bin"


def check_contents(wheel: Path, folder: Path) -> None:
    with zipfile.ZipFile(wheel) as z:
        names = z.namelist()
        z.extractall(folder)
    for expected in ("aureole/__init__.py", "aureole/py.typed", "aureole/_aureole.pyi"):
        assert expected in names, f"{expected} is missing in {wheel.name}"
    licences = {Path(n).name for n in names if ".dist-info/licenses/" in n}
    assert {"LICENSE", "LICENSE.hosek_wilkie", "LICENSE.kimera"} <= licences, f"licences: {licences}"
    assert "-manylinux_" in wheel.name, f"{wheel.name}: not a wheel for other machines"
    libraries = [folder / n for n in names if ".so" in Path(n).suffixes]
    own = {path.name for path in libraries}
    assert len(own) > 10, f"Debian's libraries are not in the wheel: {own}"
    for path in libraries:
        dynamic = subprocess.run(["readelf", "-d", path], check=True, stdout=subprocess.PIPE, text=True).stdout
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic))
        assert needed <= own | SYSTEM_LIBRARIES, f"{path.name} needs {needed - own - SYSTEM_LIBRARIES} of the machine"


def run(*command: object, **options: object) -> "subprocess.CompletedProcess[str]":
    environment = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}
    return subprocess.run([str(c) for c in command], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=300, **options)  # type: ignore[call-overload, no-any-return]


def picture(path: Path) -> bytes:
    """The file without the time that the render took."""
    data, n = re.subn(rb"(aureole:seconds\x00float\x00\x04\x00\x00\x00)....", rb"\1", path.read_bytes(), flags=re.DOTALL)
    assert n == 1, f"{path.name}: no time in the header"
    return data


def interrupted(program: Path, scene: Path, folder: Path) -> int:
    """The exit code of a render that is stopped by Ctrl-C."""
    state = folder / "long.state"
    process = subprocess.Popen([program, "render", scene, "-o", folder / "long.exr", "--spp", "1000000", "--restart", "--threads", "1"],
                               env={"PATH": "/usr/bin:/bin"}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        for _ in range(600):  # the first checkpoint comes soon after the begin
            if state.exists():
                break
            time.sleep(0.1)
        assert process.poll() is None, process.stdout.read().decode()  # type: ignore[union-attr]
        process.send_signal(signal.SIGINT)
        output = process.communicate(timeout=60)[0].decode()
    finally:
        process.kill()
    assert "Traceback" not in output, output
    return process.returncode


def main() -> None:
    program, folder = Path(sys.argv[1]), Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    wheel = build(folder, program.parents[1] / "upsampling_table.bin")
    check_contents(wheel, folder / "contents")
    bin = install(wheel, folder / "venv")
    command = bin / "aureole"

    imported = run(bin / "python", "-c", "import aureole; print(aureole.__version__, aureole.__file__)", cwd=folder)
    assert imported.returncode == 0, imported.stdout
    assert str(folder) in imported.stdout, imported.stdout
    for arguments in (["--version"], ["list"], ["--help"]):
        ours, theirs = run(command, *arguments), run(program, *arguments)
        assert ours.returncode == theirs.returncode == 0 and ours.stdout == theirs.stdout, f"{arguments}: {ours.stdout}"

    scene = folder / "scene.xml"
    scene.write_text(SCENE)
    for name, binary in (("wheel", command), ("program", program)):
        done = run(binary, "render", scene, "-o", folder / f"{name}.exr", "--spp", "4", "-q")
        assert done.returncode == 0, done.stdout
    assert picture(folder / "wheel.exr") == picture(folder / "program.exr"), "the command renders other pixels than the program"
    assert (folder / "wheel.png").read_bytes() == (folder / "program.png").read_bytes()

    missing = run(command, "render", "missing.xml")
    assert missing.returncode == 2 and "missing.xml" in missing.stdout, missing
    not_utf8 = subprocess.run([command, "info", b"\xff.xml"], stderr=subprocess.PIPE)
    assert not_utf8.returncode == 2 and b"UTF-8" in not_utf8.stderr and b"Traceback" not in not_utf8.stderr, not_utf8
    closed = run("bash", "-c", f"set -o pipefail; '{command}' docs | head -n 1 > /dev/null")
    assert "Traceback" not in closed.stdout and "rror" not in closed.stdout, closed.stdout
    code = interrupted(command, scene, folder)
    assert code == 1, f"exit code after Ctrl-C: {code}"
    shutil.rmtree(folder / "contents")
    print("same pixels, same exit codes")


if __name__ == "__main__":
    main()
