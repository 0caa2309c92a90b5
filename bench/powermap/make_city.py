#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A city of a given number of triangles, and the scene of a power map over its middle.

    bench/powermap/make_city.py build/city --triangles 1000000 --frequency 10GHz
    aureole powermap build/city/city.xml

Houses stand on a grid of streets, each a box turned by a few degrees with four to eight boxes on its roof (lifts, chimneys,
parapets), all closed and of 12 triangles. Everything is one PLY file, metres, z up. The transmitter hangs over the crossing nearest to the
middle, lower than most roofs; the map of 512 x 512 cells is 1.5 m above the streets around it.
"""

import argparse
import math
import pathlib
import random
import struct

PITCH = 40.0  # from house to house [m]
STREET = 16.0
SCENE = """<?xml version="1.0" encoding="utf-8"?>
<!-- Written by bench/powermap/make_city.py: {triangles} triangles. -->
<scene version="3.0.0">
    <default name="spp" value="64"/>
    <default name="cells" value="512"/>
    <default name="depth" value="6"/>
    <default name="diffraction" value="true"/> <default name="model" value="beams"/>
    <integrator type="ptracer"><integer name="max_depth" value="$depth"/>
        <boolean name="diffraction" value="$diffraction"/> <string name="diffraction_model" value="$model"/></integrator>
    <sensor type="powermap">
        <transform name="to_world"><scale value="{half:g}"/><translate x="{x:g}" y="{y:g}" z="1.5"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="$cells"/> <integer name="height" value="$cells"/>
            <string name="wavelength_min" value="{shortest:.9g}"/> <string name="wavelength_max" value="{longest:.9g}"/>
            <string name="response" value="uniform"/> <string name="component_format" value="float32"/>
            <rfilter type="box"/>
        </film>
        <sampler type="sobol"><integer name="sample_count" value="$spp"/></sampler>
    </sensor>
    <emitter type="point">
        <point name="position" x="{x:g}" y="{y:g}" z="12"/>
        <spectrum name="intensity" value="1"/>
    </emitter>
    <shape type="rectangle">
        <transform name="to_world"><scale value="{ground:g}"/><translate x="{x:g}" y="{y:g}"/></transform>
        <bsdf type="roughconductor"><string name="material" value="itu_concrete"/><float name="alpha" value="0.1"/></bsdf>
    </shape>
    <shape type="ply">
        <string name="filename" value="city.ply"/> <boolean name="face_normals" value="true"/>
        <bsdf type="conductor"><string name="material" value="itu_concrete"/></bsdf>
    </shape>
</scene>
"""
FACES = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(center, half, bottom, top, turn):
    """Eight corners, counterclockwise from above, the lower four first."""
    c, s = math.cos(turn), math.sin(turn)
    return [
        (center[0] + c * x - s * y, center[1] + s * x + c * y, z)
        for z in (bottom, top)
        for x, y in ((-half[0], -half[1]), (half[0], -half[1]), (half[0], half[1]), (-half[0], half[1]))
    ]


def make_boxes(count, rng):
    """The first `count` boxes of the houses, row by row, and the number of houses in a row."""
    side = math.ceil(math.sqrt(count / 7))
    boxes = []
    for house in range(side * side):
        center = (PITCH * (house % side + 0.5), PITCH * (house // side + 0.5))
        half = tuple(0.5 * (PITCH - STREET) * rng.uniform(0.75, 1) for _ in range(2))
        height, turn = rng.uniform(9, 40), math.radians(rng.uniform(-4, 4))
        boxes.append(box(center, half, 0, height, turn))
        for _ in range(rng.randint(4, 8)):
            place = [c + h * rng.uniform(-0.7, 0.7) for c, h in zip(center, half)]
            boxes.append(box(place, [rng.uniform(0.3, 2) for _ in range(2)], height, height + rng.uniform(0.5, 3), turn))
    return boxes[:count], side


def write_ply(file, boxes):
    with open(file, "wb") as f:
        f.write(
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {8 * len(boxes)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {12 * len(boxes)}\nproperty list uchar uint vertex_indices\nend_header\n".encode()
        )
        for corners in boxes:
            f.write(b"".join(struct.pack("<3f", *p) for p in corners))
        for i in range(len(boxes)):
            for a, b, c, d in FACES:
                f.write(struct.pack("<B3I", 3, 8 * i + a, 8 * i + b, 8 * i + c))
                f.write(struct.pack("<B3I", 3, 8 * i + a, 8 * i + c, 8 * i + d))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--triangles", type=int, default=1_000_000, help="rounded to whole boxes of 12")
    parser.add_argument("--frequency", default="10GHz", help="the middle of a band of 1 %% (default 10GHz)")
    parser.add_argument("--width", type=float, default=512, help="of the map [m]")
    parser.add_argument("--seed", type=int, default=1)
    a = parser.parse_args()
    if a.triangles < 12:
        parser.error(f"--triangles {a.triangles}: a box has 12")
    if not a.frequency.endswith("GHz"):
        parser.error(f"--frequency {a.frequency}: expected a number of GHz, such as 28GHz")
    nm = 299792458.0 / float(a.frequency.removesuffix("GHz"))
    boxes, side = make_boxes(a.triangles // 12, random.Random(a.seed))
    a.folder.mkdir(parents=True, exist_ok=True)
    write_ply(a.folder / "city.ply", boxes)
    middle = PITCH * (side // 2)
    (a.folder / "city.xml").write_text(
        SCENE.format(triangles=12 * len(boxes), half=a.width / 2, x=middle, y=middle, shortest=nm * 0.995,
                     longest=nm * 1.005, ground=PITCH * side))
    print(f"{12 * len(boxes)} triangles, {side * side} houses: {a.folder / 'city.xml'}")


if __name__ == "__main__":
    main()
