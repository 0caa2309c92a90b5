#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a hash of the pixels of many small pictures: a change of the code that must not change any picture prints the same lines.

    tools/picture_hashes.py BUILD > before.txt             # BUILD/bin holds aureole and aureole_fuzz
    tools/picture_hashes.py OTHER_BUILD --against before.txt

Renders all reference scenes (tests/references; those of the shared folder where it is there), every example of the plug-in
reference wrapped into a scene, the scenes of the repository made small, and the demo, with few samples. Bits depend on how the
compiler contracts a*b + c, which differs with inlining: compare builds that were configured with -DCMAKE_CXX_FLAGS=-ffp-contract=off.
With --against the exit status is 1 where a picture differs, is missing or new; the names are printed.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parent.parent
SHARED = Path(os.environ.get("AUREOLE_SHARED", ROOT.parent / "shared"))
LINES_PER_CHUNK = {0: 1, 1: 1, 2: 1, 3: 16, 4: 32, 5: 16}  # of OpenEXR's compressions


def pixel_hash(exr):
    """A hash of the channels' names and of the (compressed) pixels of a file of scan lines; other metadata holds times."""
    data = exr.read_bytes()
    at, attributes = 8, {}
    while data[at]:
        name_end = data.index(0, at)
        type_end = data.index(0, name_end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        attributes[data[at:name_end].decode()] = data[type_end + 5:type_end + 5 + size]
        at = type_end + 5 + size
    _, top, _, bottom = struct.unpack("<4i", attributes["dataWindow"])
    lines = LINES_PER_CHUNK[attributes["compression"][0]]
    chunks = (bottom - top + lines) // lines
    return hashlib.sha256(attributes["channels"] + attributes["dataWindow"] + data[at + 1 + 8 * chunks:]).hexdigest()[:16]


def pictures(build, folder):
    """Name -> arguments of `aureole render`."""
    jobs = {}
    for r in json.loads((ROOT / "tests/references/references.json").read_text()):
        scene = SHARED / r["scene"][7:] if r["scene"].startswith("shared:") else ROOT / r["scene"]
        if not scene.exists():
            print(f"{r['name']}: {scene} is not here; left out", file=sys.stderr)
            continue
        defines = [a for o in r["overrides"] for a in ("-D", o)]
        jobs["reference " + r["name"]] = [scene, "--spp", "4", "--sampler", "sobol", *defines]
    subprocess.run([build / "bin/aureole_fuzz", "--write-corpus", folder / "corpus"], check=True)
    for scene in sorted((folder / "corpus").iterdir()):
        jobs["corpus " + scene.name] = [scene / "scene.xml", "--spp", "16"]
    demo = [ROOT / "scenes/condensation/condensation.xml", "-D", "width=90", "-D", "height=60"]
    jobs["demo"] = [*demo, "--spp", "16"]
    jobs["demo adaptive"] = [*demo, "--spp", "32", "--adaptive", "display"]
    jobs["demo replicates"] = [*demo, "--spp", "16", "--replicates", "3", "--seed", "7"]
    return jobs


def render(build, folder, name, arguments):
    out = folder / (hashlib.sha256(name.encode()).hexdigest()[:16] + ".exr")
    run = subprocess.run([build / "bin/aureole", "render", *arguments, "-o", out, "--threads", "1", "--quiet", "--restart"],
                         capture_output=True, text=True, cwd=folder)
    if run.returncode == 0:
        return pixel_hash(out)
    return f"exit status {run.returncode}"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("--against", type=Path, help="what another build printed")
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    a = p.parse_args()
    build = a.build.resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        jobs = pictures(build, folder)
        with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
            hashes = dict(zip(jobs, pool.map(lambda name: render(build, folder, name, jobs[name]), jobs)))
    lines = [f"{value}  {name}" for name, value in hashes.items()]
    print("\n".join(lines))
    if a.against:
        before = a.against.read_text().splitlines()
        differing = sorted({line.split("  ", 1)[1] for line in set(before) ^ set(lines)})
        print(f"{len(differing)} of {len(lines)} pictures differ" + "".join("\n  " + d for d in differing), file=sys.stderr)
        sys.exit(1 if differing else 0)


if __name__ == "__main__":
    main()
