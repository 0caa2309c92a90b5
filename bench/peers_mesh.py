# SPDX-License-Identifier: Apache-2.0
"""The part of peers.py that measures what a large mesh costs. docs/performance.md defines the quantities."""
import json
import os
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np

MITSUBA = Path(__file__).resolve().parent / "peers_mitsuba.py"
FORMATS = ("ply", "serialized")
ATTRIBUTES = (False, True)  # with normals and texture coordinates
STAGES = ("read", "pixel")
PROGRAMS = ("aureole", "Mitsuba")

# A process of a few MiB starts what is measured: a child's peak counts from before exec(), when it is still a copy of
# its parent. The child's own output comes first.
STARTER = """import json, os, sys, time
begin = time.perf_counter()
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(pid, 0)
print(json.dumps([time.perf_counter() - begin, usage.ru_maxrss / 1024, os.waitstatus_to_exitcode(status)]))
"""

SCENE = """<scene version="3.0.0">
{sensor}<emitter type="constant"/>
{shape}
</scene>
"""
SENSOR = """<integrator type="path"/>
<sensor type="perspective">
    <transform name="to_world"><lookat origin="0, -5, 4" target="0, 0, 0" up="0, 0, 1"/></transform>
    <sampler type="independent"><integer name="sample_count" value="1"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
</sensor>
"""


def torus(triangles):
    """A bumpy torus: vertices, normals, texture coordinates, indices. About as many triangles as asked for."""
    nv = max(3, round((triangles / 4) ** 0.5))
    nu = max(3, round(triangles / 2 / nv))
    u, v = np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1), indexing="ij")
    a, b = 2 * np.pi * u, 2 * np.pi * v
    r = 0.7 + 0.05 * np.sin(9 * a) * np.sin(7 * b) + 0.004 * np.sin(101 * a) * np.sin(83 * b)
    p = np.stack([(1.5 + r * np.cos(b)) * np.cos(a), (1.5 + r * np.cos(b)) * np.sin(a), r * np.sin(b)], axis=-1)
    n = np.cross(np.gradient(p, axis=0), np.gradient(p, axis=1))
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    i = np.arange(nu)[:, None] * (nv + 1) + np.arange(nv)
    corner = i, i + nv + 1, i + nv + 2, i + 1
    faces = np.stack([corner[k] for k in (0, 1, 2, 0, 2, 3)], axis=-1).reshape(-1, 3)
    return p.reshape(-1, 3), n.reshape(-1, 3), np.stack([u, v], axis=-1).reshape(-1, 2), faces


def write_ply(file, attributes, mesh):
    p, n, uv, faces = mesh
    names, columns = ["x", "y", "z"], [p]
    if attributes:
        names += ["nx", "ny", "nz", "u", "v"]
        columns += [n, uv]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(p)}",
              *(f"property float {name}" for name in names), f"element face {len(faces)}",
              "property list uchar int vertex_indices", "end_header", ""]
    lists = np.empty(len(faces), dtype=[("count", "u1"), ("vertices", "<i4", 3)])
    lists["count"], lists["vertices"] = 3, faces
    with open(file, "wb") as f:
        f.write("\n".join(header).encode())
        f.write(np.hstack(columns).astype("<f4").tobytes())
        f.write(lists.tobytes())


def write_serialized(file, attributes, mesh):
    """Version 4: a compressed mesh, then the table of where each mesh begins."""
    p, n, uv, faces = mesh
    flags = 0x1000 | (0x0003 if attributes else 0)  # single precision; normals, texture coordinates
    body = struct.pack("<I", flags) + b"mesh\0" + struct.pack("<QQ", len(p), len(faces))
    for column in (p, n, uv) if attributes else (p,):
        body += column.astype("<f4").tobytes()
    body += faces.astype("<u4").tobytes()
    with open(file, "wb") as f:
        f.write(struct.pack("<HH", 0x041C, 4) + zlib.compress(body) + struct.pack("<QI", 0, 1))


def describe(form, attributes):
    return form + (", normals and uv" if attributes else "")


def cases():
    return [(form, attributes) for attributes in ATTRIBUTES for form in FORMATS]


def stem_of(folder, name, form, attributes):
    return folder / f"{name}-{form}-{'full' if attributes else 'plain'}"


def write_files(folder, triangles):
    """For each case and size what a program is to read; returns the files' sizes in MiB and the number of triangles."""
    megabytes, large = {}, torus(triangles)
    for form, attributes in cases():
        for name, mesh in (("large", large), ("small", torus(32))):
            stem = stem_of(folder, name, form, attributes)
            file = stem.with_suffix("." + form)
            (write_ply if form == "ply" else write_serialized)(file, attributes, mesh)
            shape = f'<shape type="{form}">\n    <string name="filename" value="{file}"/>\n</shape>'
            Path(f"{stem}-pixel.xml").write_text(SCENE.format(sensor=SENSOR, shape=shape))
            # Reading alone. aureole reports a missing sensor after it has read everything and before it builds;
            # Mitsuba reads a file that is only a shape.
            Path(f"{stem}-read-aureole.xml").write_text(SCENE.format(sensor="", shape=shape))
            Path(f"{stem}-read-Mitsuba.xml").write_text(shape.replace("<shape", '<shape version="3.0.0"', 1))
            if name == "large":
                megabytes[form, attributes] = file.stat().st_size / 2**20
    return megabytes, len(large[3])


def run_child(command):
    """Output, seconds and peak of resident memory in MiB of a fresh process, and its exit status."""
    r = subprocess.run([sys.executable, "-I", "-S", "-c", STARTER, *map(str, command)], capture_output=True, text=True)
    if r.returncode != 0:
        sys.exit(f"cannot start {command[0]}:\n{r.stderr}")
    *output, last = r.stdout.splitlines()
    seconds, peak, status = json.loads(last)
    return output, r.stderr, seconds, peak, status


def measure(a, program, stage, stem, folder):
    """Seconds and peak in MiB of one stage."""
    scene = f"{stem}-pixel.xml" if stage == "pixel" else f"{stem}-read-{program}.xml"
    if program == "aureole":
        render = ["render", scene, "-o", folder / "pixel.exr", "--spp", "1", "--threads", str(a.threads), "-q",
                  "--restart"]
        command = [a.aureole, *(render if stage == "pixel" else ["info", scene])]
    else:
        command = [sys.executable, MITSUBA, "load", str(a.threads), scene, *(["render"] if stage == "pixel" else [])]
    output, errors, seconds, peak, status = run_child(command)
    if program == "Mitsuba" and status == 0:
        # Without the start of Python and Mitsuba, which aureole's figure has less of and which is no part of the mesh.
        seconds = json.loads(output[-1])["seconds"]
    no_sensor = program == "aureole" and stage == "read"
    if (status, no_sensor) not in ((0, False), (2, True)) or (no_sensor and "no <sensor>" not in errors):
        sys.exit(f"{program}, {os.path.basename(scene)}: exit status {status}\n{errors}")
    return seconds, peak


def items(a):
    each = [("mesh", program, stage) for program in PROGRAMS for stage in STAGES]
    sizes = [(kind, max(1, size)) for kind in each for size in (a.triangles, a.triangles // 10)]
    return sizes * (len(cases()) * a.repeats)


def run(a, folder, progress, conditions):
    megabytes, triangles = write_files(folder, a.triangles)
    least = {}
    # Mitsuba compiles once and keeps the result on disc.
    for form, attributes in cases():
        measure(a, "Mitsuba", "pixel", stem_of(folder, "small", form, attributes), folder)
    for repeat in range(a.repeats):
        for form, attributes in cases():
            for name in ("large", "small"):
                for stage in STAGES:
                    for program in PROGRAMS:
                        stem = stem_of(folder, name, form, attributes)
                        begin = time.perf_counter()
                        seconds, peak = measure(a, program, stage, stem, folder)
                        key = form, attributes, name, stage, program
                        old = least.get(key, (seconds, peak))
                        least[key] = min(old[0], seconds), min(old[1], peak)
                        size = a.triangles if name == "large" else max(1, a.triangles // 10)
                        progress.step(("mesh", program, stage), size, time.perf_counter() - begin,
                                      f"{name} mesh, {describe(form, attributes)}, {program}, {stage}, "
                                      f"run {repeat + 1}")

    rows = []
    for form, attributes in cases():
        row = [describe(form, attributes), f"{megabytes[form, attributes]:.1f}"]
        for stage, index, digits in (("read", 0, 3), ("pixel", 0, 3), ("pixel", 1, 0)):
            mine, other = (least[form, attributes, "large", stage, p][index]
                           - least[form, attributes, "small", stage, p][index] for p in PROGRAMS)
            ratio = f"**{other / mine:.2f}**" if mine > 0 and other > 0 else "-"
            row += [f"{mine:.{digits}f}", f"{other:.{digits}f}", ratio]
        rows.append(f"| {' | '.join(row)} |")
    base = {p: [min(least[f, w, "small", "pixel", p][i] for f, w in cases()) for i in (0, 1)] for p in PROGRAMS}
    columns = [f"{what}, {p}" if p != "ratio" else p for what in ("read (s)", "first pixel (s)", "peak (MiB)")
               for p in (*PROGRAMS, "ratio")]
    return "\n".join([f"### A mesh of {triangles:,} triangles", "",
                      f"Best of {a.repeats}; {conditions}", "",
                      f"| file | MiB | {' | '.join(columns)} |", "|---" * (2 + len(columns)) + "|", *rows, "",
                      "- taken off: a mesh of 32 triangles to its first pixel, "
                      + ", ".join(f"{p} {base[p][0]:.3f} s and {base[p][1]:.0f} MiB" for p in PROGRAMS)])
