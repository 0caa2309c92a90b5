#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a hash of every picture and of one replayed pixel for each integrator, scene and limit of paths: a change of the transport code
that must not change any picture prints the same lines.

    tools/walk_hashes.py BUILD > before.txt                # BUILD/bin/aureole is run
    tools/walk_hashes.py OTHER_BUILD --against before.txt

tools/picture_hashes.py covers the plug-ins; this script covers what integrators do: `path`, `ptracer`, `bdpt`, and `direct` with two
numbers of samples, in scenes of surfaces, nested glass, media, subsurface scattering, masks, receivers and diffracting edges, each with
several limits. Bits depend on how the compiler contracts a*b + c: compare builds that were configured with
-DCMAKE_CXX_FLAGS=-ffp-contract=off. With --against the exit status is 1 where a line differs; the names are printed.
"""
import argparse
import concurrent.futures
import hashlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from picture_hashes import pixel_hash

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

ROOT = Path(__file__).resolve().parent.parent
SIZE = 16

SENSOR = """<sensor type="perspective"><float name="fov" value="45"/>
    <transform name="to_world"><lookat origin="0, 0.2, 3.4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="$spp"/></sampler></sensor>"""
ROOM = """<shape type="rectangle"><transform name="to_world"><translate z="-1"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.7, 0.6"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform>
        <bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="1"/></transform>
        <bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="90"/><translate x="-1"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.1, 0.1"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="-90"/><translate x="1"/></transform>
        <bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.1, 0.5, 0.1"/></bsdf></shape>"""
LAMP = """<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><scale value="0.3"/><translate y="0.98"/></transform>
        <emitter type="area"><rgb name="radiance" value="12, 10, 8"/></emitter></shape>"""
MEDIUM = """<medium name="interior" type="homogeneous"><rgb name="sigma_t" value="0.8, 0.6, 0.4"/><float name="albedo" value="0.8"/>
        <phase type="hg"><float name="g" value="0.3"/></phase></medium>"""
SCENES = {
    "room": SENSOR + ROOM + LAMP + """<shape type="sphere"><point name="center" x="0.3" y="-0.5" z="0.2"/><float name="radius" value="0.4"/>
        <bsdf type="dielectric"/></shape><emitter type="point"><point name="position" x="-0.6" y="0.3" z="0.5"/><spectrum name="intensity" value="1"/></emitter>""",
    "sky": SENSOR + """<shape type="sphere"><float name="radius" value="0.6"/><bsdf type="roughdielectric"/></shape>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/><translate y="-1"/></transform></shape>
        <emitter type="constant"><spectrum name="radiance" value="400:1, 700:0.4"/></emitter>
        <emitter type="directional"><vector name="direction" value="1, -2, -1"/><spectrum name="irradiance" value="2"/></emitter>""",
    "nested": SENSOR + ROOM + LAMP + """<shape type="sphere"><float name="radius" value="0.7"/><integer name="priority" value="2"/>
        <bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf></shape>
        <shape type="cube"><transform name="to_world"><scale value="0.5"/><translate x="0.4"/></transform><integer name="priority" value="1"/>
        <bsdf type="dielectric"><float name="int_ior" value="1.33"/></bsdf>""" + MEDIUM + "</shape>",
    "fog": SENSOR + ROOM + LAMP + """<shape type="cube"><transform name="to_world"><scale value="0.98"/></transform><bsdf type="null"/>""" + MEDIUM
        + """</shape><emitter type="spot"><transform name="to_world"><lookat origin="0.5, 0.7, 0.6" target="0, -1, 0" up="1, 0, 0"/></transform>
        <spectrum name="intensity" value="9"/></emitter>""",
    "mask": SENSOR + ROOM + LAMP + """<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><translate z="0.4"/></transform>
        <bsdf type="mask"><float name="opacity" value="0.4"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf></shape>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><scale value="0.4"/><translate y="0.5"/></transform>
        <bsdf type="thindielectric"/></shape>""",
    "receiver": ROOM + """<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-0.9"/></transform>
        <sensor type="irradiancemeter"><film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
        <rfilter type="box"/></film><sampler type="sobol"/></sensor></shape>
        <emitter type="point"><point name="position" x="0.2" y="0.7" z="0.1"/><spectrum name="intensity" value="2"/></emitter>""",
    "powermap": """<sensor type="powermap"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="0.9"/><translate y="-0.6"/></transform>
        <film type="hdrfilm"><integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="box"/></film>
        <sampler type="sobol"/></sensor>""" + ROOM + """<shape type="sphere"><float name="radius" value="0.3"/><bsdf type="conductor"/></shape>
        <emitter type="point"><point name="position" x="0.2" y="0.7" z="0.5"/><spectrum name="intensity" value="3"/></emitter>""",
    "glowing": SENSOR + ROOM + """<shape type="cube"><transform name="to_world"><scale value="0.4"/></transform><bsdf type="null"/>
        <medium name="interior" type="homogeneous"><float name="sigma_t" value="0.9"/><float name="albedo" value="0.5"/>
        <rgb name="emission" value="3, 2, 1"/></medium></shape>""" + LAMP,
}
FILES = {"fire": "scenes/media/fire.xml", "smoke": "scenes/media/powder.xml", "marble": "scenes/marble/marble.xml", "milk": "scenes/milk/milk.xml",
         "star": "scenes/diffraction/star.xml", "slits": "scenes/diffraction/two_slits.xml", "comb": "scenes/diffraction/comb.xml",
         "condensation": "scenes/condensation/condensation.xml"}
INTEGRATORS = {"path": "path", "ptracer": "ptracer", "bdpt": "bdpt", "direct": "direct", "direct 4/2": "direct"}
LIMITS = {"free": {"max_depth": 12, "rr_depth": 2}, "hidden": {"hide_emitters": "true", "max_depth": 5}, "depth 1": {"max_depth": 1},
          "depth 2": {"max_depth": 2}, "depth 3": {"max_depth": 3}, "depth 4": {"max_depth": 4}, "single": {"max_scattering": 1, "max_depth": 6}}
PLAIN = re.compile(r"<integrator .*?</integrator>", re.DOTALL)


def integrator(name, limits, diffraction):
    kind = INTEGRATORS[name]
    values = dict(limits)
    if kind == "direct":
        values = {k: v for k, v in values.items() if k == "hide_emitters"}
        if name != "direct":
            values.update(emitter_samples=4, bsdf_samples=2)
    rows = [f'<boolean name="{k}" value="{v}"/>' if k == "hide_emitters" else f'<integer name="{k}" value="{v}"/>' for k, v in values.items()]
    if diffraction:
        rows += ['<boolean name="diffraction" value="true"/>', diffraction]
    return f'<integrator type="{kind}">{"".join(rows)}</integrator>'


def scenes(folder):
    """Name -> (folder of the files that the scene names, text in which INTEGRATOR is to be replaced, parameters of diffraction)."""
    head = '<scene version="3.0.0"><default name="width" value="16"/><default name="height" value="16"/><default name="spp" value="4"/>'
    for name, body in SCENES.items():
        yield name, None, head + "INTEGRATOR" + body + "</scene>", ""
    beams = '<string name="diffraction_model" value="beams"/>'
    beam = beams + '<string name="beam_width" value="5cm"/>'
    text = head + "INTEGRATOR" + SENSOR + ROOM + LAMP + """<shape type="cube"><transform name="to_world"><scale value="0.3"/><rotate y="1" angle="30"/></transform>
        <bsdf type="diffuse"/></shape></scene>"""
    yield "edges", None, text, beam
    for name, path in FILES.items():
        text = (ROOT / path).read_text()
        own = PLAIN.search(text)
        beam = re.search(r'<string name="beam_width".*?/>', own[0]) if own else None
        text = PLAIN.sub("INTEGRATOR", text, count=1) if own else text.replace("</scene>", "INTEGRATOR</scene>")
        yield name, (ROOT / path).parent, text, beams + beam[0] if beam else ""


def run(program, folder, scene, name, keep=None):
    out = (keep or folder) / (hashlib.sha256(name.encode()).hexdigest()[:16] + ".exr")
    size = [] if name.startswith("receiver") else ["-D", f"width={SIZE}", "-D", f"height={SIZE}"]
    common = [program, "render", scene, "--threads", "1", *size]
    picture = subprocess.run([*common, "--spp", "4", "-o", out, "--quiet", "--restart"], capture_output=True, text=True, cwd=folder)
    if picture.returncode != 0:
        problem = (picture.stderr.strip().splitlines() or ["failed"])[0]
        return f"{re.sub(r'^.*?[.]xml(:[0-9]+)*: ', '', problem)[:60]}  {name}"
    log = subprocess.run([*common, "--pixel", "0,0" if name.startswith("receiver") else f"{SIZE // 2},{SIZE // 2 + 3}", "--samples", "0:2", "-o", out], capture_output=True, text=True, cwd=folder)
    replay = hashlib.sha256(log.stdout.encode()).hexdigest()[:16]
    return f"{pixel_hash(out)} {replay}  {name}"


def report_differences(folder, other, names):
    """Prints the pictures that differ by more than 1e-4 of their largest number, with that part."""
    import aureole  # the package of a build, on PYTHONPATH
    import numpy as np
    for name in names:
        file = hashlib.sha256(name.encode()).hexdigest()[:16] + ".exr"
        if not (folder / file).exists() or not (other / file).exists():
            continue
        a, b = (np.asarray(aureole.read_image(str(f / file)).array, dtype=float) for f in (folder, other))
        difference = np.abs(a - b).max() / max(np.abs(b).max(), 1e-30)
        if not difference < 1e-4:
            pixels = (np.abs(a - b).max(axis=-1) > 1e-4 * np.abs(b).max()).mean()
            print(f"{name}: {difference:.2g} of the largest number, in {pixels:.0%} of the pixels; means {a.mean():.6g}, {b.mean():.6g}",
                  file=sys.stderr)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("--against", type=Path, help="what another build printed")
    p.add_argument("--only", default="", help="names that have this in them")
    p.add_argument("--keep", type=Path, help="folder that the pictures are left in")
    p.add_argument("--near", type=Path, help="folder of another run's pictures: prints those that differ by more than rounding")
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    a = p.parse_args()
    program = a.build.resolve() / "bin/aureole"
    if a.near and not a.keep:
        p.error("--near needs --keep")
    if a.keep:
        a.keep.mkdir(parents=True, exist_ok=True)
        a.keep = a.keep.resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        jobs = []
        for name, files, text, beam in scenes(folder):
            rooms = folder / name
            rooms.mkdir()
            for f in files.iterdir() if files else ():
                (rooms / f.name).symlink_to(f)
            for kind in INTEGRATORS:
                for limit, values in LIMITS.items():
                    if INTEGRATORS[kind] == "direct" and limit not in ("free", "hidden"):
                        continue
                    title = f"{name}, {kind}, {limit}"
                    if a.only not in title:
                        continue
                    scene = rooms / f"walk-{kind.replace(' ', '-').replace('/', '-')}-{limit.replace(' ', '-')}.xml"
                    scene.write_text(text.replace("INTEGRATOR", integrator(kind, values, beam)))
                    jobs.append((scene, title))
        with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
            lines = list(pool.map(lambda job: run(program, job[0].parent, *job, a.keep), jobs))
    print("\n".join(lines))
    if a.near:
        report_differences(a.keep, a.near, [title for _, title in jobs])
    if a.against:
        before = [line for line in a.against.read_text().splitlines() if a.only in line]
        differing = sorted({line.split("  ", 1)[-1] for line in set(before) ^ set(lines)})
        print(f"{len(differing)} of {len(lines)} pictures differ" + "".join("\n  " + d for d in differing), file=sys.stderr)
        sys.exit(1 if differing else 0)


if __name__ == "__main__":
    main()
