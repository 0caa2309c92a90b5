#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints how long large scenes take to load: with aureole's Python module and, where an interpreter has it, with Mitsuba 3.

Every load runs in a process of its own; the table gives the shortest time of the load call alone, and the processor
time of the whole process. Mitsuba's variant is scalar_spectral: like aureole it makes spectra of colours while loading.
"""
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parents[1]
HEAD = """<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0,0,10" target="0,0,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film></sensor>
<emitter type="constant"/><bsdf type="diffuse" id="grey"/>
"""
AUREOLE = """
import json, os, resource, sys, time
sys.path.insert(0, sys.argv[2])
import aureole
start = time.perf_counter(); scene = aureole.load_file(sys.argv[1]); wall = time.perf_counter() - start
usage = resource.getrusage(resource.RUSAGE_SELF)
print(json.dumps([wall, usage.ru_utime + usage.ru_stime]), flush=True); os._exit(0)
"""
MITSUBA = """
import json, os, resource, sys, time
import mitsuba
mitsuba.set_variant("scalar_spectral")
start = time.perf_counter(); scene = mitsuba.load_file(sys.argv[1]); wall = time.perf_counter() - start
usage = resource.getrusage(resource.RUSAGE_SELF)
print(json.dumps([wall, usage.ru_utime + usage.ru_stime]), flush=True); os._exit(0)
"""


SMALL = '<scale value="0.02"/>'


def place(scale=""):
    x, y, z = (random.uniform(-5, 5) for _ in range(3))
    return f'<transform name="to_world">{scale}<translate x="{x:.4f}" y="{y:.4f}" z="{z:.4f}"/></transform>'


def spheres(folder, count):
    return "".join(f'<shape type="sphere"><point name="center" x="{random.uniform(-5, 5):.4f}" '
                   f'y="{random.uniform(-5, 5):.4f}" z="{random.uniform(-5, 5):.4f}"/>'
                   f'<float name="radius" value="0.02"/><ref id="grey"/></shape>\n' for _ in range(count))


def lights(folder, count):
    return "".join(f'<shape type="rectangle">{place(SMALL)}<ref id="grey"/>'
                   f'<emitter type="area"><rgb name="radiance" value="1,1,1"/></emitter></shape>\n'
                   for _ in range(count))


def rough_plastics(folder, count):
    return "".join(f'<shape type="sphere">{place()}<bsdf type="roughplastic"><float name="alpha" value="{random.uniform(0.05, 0.5):.5f}"/>'
                   f'<rgb name="diffuse_reflectance" value="{random.uniform(0.1, 0.9):.4f},0.5,0.3"/></bsdf></shape>\n'
                   for _ in range(count))


def texture(folder, megabytes):
    side = int((megabytes * 1e6 / 12) ** 0.5)
    with open(folder / "large.pfm", "wb") as f:
        f.write(f"PF\n{side} {side}\n-1.0\n".encode())
        line = b"".join(random.randbytes(3) + b"\x3e" for _ in range(3 * side))  # from 0.125 to 0.5
        for _ in range(side):
            f.write(line)
    return ('<shape type="rectangle"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">'
            '<string name="filename" value="large.pfm"/></texture></bsdf></shape>')


SCENES = {"spheres": (spheres, 100_000), "lights": (lights, 10_000), "roughplastic": (rough_plastics, 200),
          "texture": (texture, 1000)}


def best(command, repeats):
    results = []
    for _ in range(repeats):
        r = subprocess.run(command, capture_output=True, text=True)
        if r.returncode != 0:
            sys.exit(r.stderr)
        results.append(json.loads(r.stdout.splitlines()[-1]))
    return [min(values) for values in zip(*results)]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--only", nargs="+", choices=SCENES, default=list(SCENES))
    p.add_argument("--repeats", type=int, default=3)
    p.add_argument("--module", type=Path, default=ROOT / "build/release/python", help="folder of aureole's Python module")
    p.add_argument("--python", default=sys.executable, help="an interpreter with numpy, for aureole")
    p.add_argument("--mitsuba", metavar="PYTHON", help="an interpreter with mitsuba 3.9.1")
    a = p.parse_args()
    random.seed(1)
    print("scene                     aureole: load s, processor s    Mitsuba: load s, processor s")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scene in a.only:
            make, size = SCENES[scene]
            file = folder / f"{scene}.xml"
            file.write_text(HEAD + make(folder, size) + "</scene>\n")
            ours = best([a.python, "-c", AUREOLE, str(file), str(a.module)], a.repeats)
            theirs = best([a.mitsuba, "-c", MITSUBA, str(file)], a.repeats) if a.mitsuba else None
            row = ["  ".join(f"{x:8.2f}" for x in t) if t else " " * 18 for t in (ours, theirs)]
            print(f"{scene:14} {size:8}   {row[0]:30}  {row[1]}", flush=True)


if __name__ == "__main__":
    main()
