#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Single diffraction by metal edges after sionna-rt 2.2 (NVIDIA, Apache-2.0), for tests/optics/diffraction/sionna_test.cpp and
tests/render/edge_sionna_test.cpp.

    python3 -m venv venv && venv/bin/pip install sionna-rt==2.2.0
    venv/bin/python make_sionna_references.py sionna_references.inc ../../../render/references/sionna_powers.inc

sionna-rt's compiler needs a libLLVM of version 17 or later: DRJIT_LIBLLVM_PATH names its file. Written with sionna-rt 2.2.0, mitsuba
3.9.1, drjit 1.5.0 and LLVM 19. It takes some minutes.

Each row is one path with one diffraction, oblique as well: frequency [GHz], exterior angle of the edge over pi, transmitter, point of
the edge, receiver [m], a point on the o-face and one on the n-face beside the edge, 10 lg of the path's gain between isotropic
antennas. All edges are along z.

Antennas are polarised across z ("H"). For these sionna-rt 2.2.0 computes D = -(d1 + d2 - d3 - d4), d1 ... d4 being the four terms of
Kouyoumjian & Pathak 1974, equation 25: their coefficient of *soft* polarisation, though its own reflection has the sign of a hard one
there. Polarised along z it computes d1 - d2 + d3 - d4 where both faces cannot be lit, which is neither of theirs. Its total
field therefore jumps where the reflection ends: 14 m from a transmitter 60 degrees off a metal block's face from .45 to 2.41 (along z) and from 3.42 to
1.44 (across), over the field in free space. So the rows test the four terms and the geometry, and polarisation is not compared.

The second file has what receivers on lines from the light into the shadow get, between the same antennas: the direct path where there is one,
and all with one diffraction. Each line is cut into cells, and each cell has two receivers, the nodes of Gauss's quadrature. Rows, one per path:
scene and line (POWER_LINES), frequency [GHz], cell, transmitter, receiver, exterior angle of the edge over pi (0: the direct path), point of
the edge, points on both faces as above, 10 lg of irradiance over radiant intensity [1/m^2]: the path's gain over (lambda/(4 pi))^2. One more row
per cell, with -1 for the angle, has the mean over 12 places of all paths added with their phases. Paths over the top and below the bottom
of obstacles, 60 m away, are left out: the largest has -110 dB.
"""

import pathlib
import sys
import tempfile

import numpy as np

WALL = {"name": "wall", "boxes": [], "sheets": [((-8, 0), (0, 0))]}
BLOCK = {"name": "block", "boxes": [((-8, -8), (0, 0))], "sheets": []}
BLOCKS = {"name": "two blocks", "boxes": [((-8, -8), (0, 0)), ((3, -9), (9, 1))], "sheets": []}
HALF_HEIGHT = 15.0
# Scene, transmitter, height of receivers, beginning and end of the line, cells. Top and bottom are so far away that only vertical edges count.
TWO_BLOCKS = {"name": "two blocks", "boxes": [((-8, -8), (0, 0)), ((4, -9), (12, 1))], "sheets": []}
POWER_LINES = (
    (WALL, (-3.1, 7.4, 1), -0.5, (6, -5), (-4, -5), 20),
    (BLOCK, (-9, 5.5, 1), -0.5, (14, -6), (0.8, -6), 20),
    (TWO_BLOCKS, (-9, 5.5, 1), -0.5, (2, 3), (2, -7), 20),
    (TWO_BLOCKS, (-9, 5.5, 1), -0.5, (15, 5), (15, -7), 20),
)
POWER_HALF_HEIGHT = 60.0
FIELD_PLACES = 12  # in a cell


def write_ply(path, vertices, triangles):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\n")
        f.write(f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n")
        f.write(f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
        f.writelines("%.9g %.9g %.9g\n" % tuple(v) for v in vertices)
        f.writelines("3 %d %d %d\n" % tuple(t) for t in triangles)


def box(low, high, half_height):
    v = [(x, y, z) for z in (-half_height, half_height) for y in (low[1], high[1]) for x in (low[0], high[0])]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return v, [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def sheet(a, b, half_height):
    v = [(*a, -half_height), (*b, -half_height), (*b, half_height), (*a, half_height)]
    return v, [(0, 1, 2), (0, 2, 3)]


def vertical_edges(geometry):
    """Edge (x, y), exterior angle over pi, points on both faces beside it; the o-face is where turning by increasing angle
    (clockwise from above) leaves the solid."""
    edges = []
    for (x0, y0), (x1, y1) in geometry["boxes"]:
        for x, y, inward in ((x0, y0, (1, 1)), (x1, y0, (-1, 1)), (x0, y1, (1, -1)), (x1, y1, (-1, -1))):
            faces = [(x + inward[0], y), (x, y + inward[1])]
            a, b = np.array(faces[0]) - (x, y), np.array(faces[1]) - (x, y)
            # Clockwise by 3 pi/2 from the o-face is the n-face: counterclockwise by pi/2.
            if a[0] * b[1] - a[1] * b[0] < 0:
                faces.reverse()
            edges.append(((x, y), 1.5, *faces))
    for a, b in geometry["sheets"]:
        edges.append((b, 2.0, a, a))
        edges.append((a, 2.0, b, b))
    return edges


def paths_of(geometry, half_height, ghz, polarization, transmitter, receivers, direct, folder):
    """Receiver, point of the edge, and the root of the gain with its phase, without that of the way, of each path. Of the direct path,
    the point is None."""
    import sionna.rt as rt

    shapes = [box(*b, half_height) for b in geometry["boxes"]] + [sheet(*s, half_height) for s in geometry["sheets"]]
    xml = '<scene version="2.1.0"><bsdf type="itu-radio-material" id="metal"><string name="type" value="metal"/>'
    xml += '<float name="thickness" value="0.1"/></bsdf>'
    for i, (vertices, triangles) in enumerate(shapes):
        write_ply(folder / f"{i}.ply", vertices, triangles)
        xml += f'<shape type="ply" id="s{i}"><string name="filename" value="{folder / f"{i}.ply"}"/>'
        xml += '<boolean name="face_normals" value="true"/><ref id="metal" name="bsdf"/></shape>'
    (folder / "scene.xml").write_text(xml + "</scene>")
    scene = rt.load_scene(str(folder / "scene.xml"), merge_shapes=False)
    scene.frequency = ghz * 1e9
    scene.tx_array = rt.PlanarArray(num_rows=1, num_cols=1, pattern="iso", polarization=polarization)
    scene.rx_array = rt.PlanarArray(num_rows=1, num_cols=1, pattern="iso", polarization=polarization)
    scene.add(rt.Transmitter("tx", position=[float(x) for x in transmitter]))
    for i, r in enumerate(receivers):
        scene.add(rt.Receiver(f"rx{i}", position=[float(x) for x in r]))
    paths = rt.PathSolver()(
        scene, max_depth=1, los=direct, specular_reflection=False, refraction=False, diffraction=True,
        edge_diffraction=True, diffraction_lit_region=True, samples_per_src=4_000_000)
    real, imaginary = (np.array(x) for x in paths.a)
    a = (real + 1j * imaginary)[:, 0, 0, 0, :]
    kinds = np.array(paths.interactions)[0]
    points = np.array(paths.vertices)[0]
    if kinds.ndim == 4:  # antennas apart
        kinds, points = kinds[:, 0, 0], points[:, 0, 0]
    else:
        kinds, points = kinds[:, 0], points[:, 0]
    for i, receiver in enumerate(receivers):
        for k in range(a.shape[-1]):
            if kinds[i, k] == rt.constants.InteractionType.DIFFRACTION and a[i, k] != 0:
                yield receiver, points[i, k], complex(a[i, k])
            elif kinds[i, k] == rt.constants.InteractionType.NONE and a[i, k] != 0:
                yield receiver, None, complex(a[i, k])


def write_rows(name, rows):
    with open(name, "w") as f:
        f.write("// SPDX-License-Identifier: Apache-2.0\n// Written by make_sionna_references.py.\n")
        for r in rows:
            f.write("{" + ", ".join(f"{float(v):.7g}" for v in r) + "},\n")


def single_edges():
    rows, polarization = [], "H"
    for geometry in (WALL, BLOCK, BLOCKS):
        edges = vertical_edges(geometry)
        angles = np.radians(np.arange(-170, 180, 12.0) + 1.3)
        radius = 6.0
        receivers = [np.array((radius * np.cos(t), radius * np.sin(t), 1.5 * np.sin(3 * t))) for t in angles]
        if geometry["boxes"]:
            receivers = [r for r in receivers
                         if not any(l[0] - 0.2 < r[0] < h[0] + 0.2 and l[1] - 0.2 < r[1] < h[1] + 0.2
                                    for l, h in geometry["boxes"])]
        transmitter = np.array((-3.1, 7.4, -1.2))
        for ghz in (3.5, 28.0):
            with tempfile.TemporaryDirectory() as folder:
                found = list(paths_of(geometry, HALF_HEIGHT, ghz, polarization, transmitter, receivers, False,
                                      pathlib.Path(folder)))
            for receiver, point, a in found:
                for (x, y), n, o_face, n_face in edges:
                    if np.hypot(point[0] - x, point[1] - y) < 1e-3:
                        rows.append((ghz, n, *transmitter, *point, *receiver, *o_face, *n_face, 20 * np.log10(abs(a))))
            print(geometry["name"], ghz, len(found), len(rows), file=sys.stderr)
    return rows


def powers():
    rows = []
    for number, (geometry, transmitter, z, begin, end, cells) in enumerate(POWER_LINES):
        edges = vertical_edges(geometry)

        def places(parts):
            return [(*(np.array(begin) + (cell + part) / cells * (np.array(end) - begin)), z)
                    for cell in range(cells) for part in parts]

        nodes = places(0.5 + np.array((-1, 1)) / np.sqrt(12))
        field_places = places((np.arange(FIELD_PLACES) + 0.5) / FIELD_PLACES)
        number_of = {p: i for i, p in enumerate(nodes + field_places)}
        for ghz in (3.5, 28.0):
            wavelength = 0.299792458 / ghz
            unit = wavelength / (4 * np.pi)
            with tempfile.TemporaryDirectory() as folder:
                found = list(paths_of(geometry, POWER_HALF_HEIGHT, ghz, "H", transmitter, list(number_of), True,
                                      pathlib.Path(folder)))
            fields, largest_away = np.zeros(len(field_places), complex), 0
            for receiver, point, a in found:
                here = [e for e in edges if point is not None and np.hypot(point[0] - e[0][0], point[1] - e[0][1]) < 1e-3]
                if point is not None and not here:
                    largest_away = max(largest_away, abs(a / unit)**2)
                    continue
                i = number_of[receiver]
                if i >= len(nodes):
                    corner = transmitter if point is None else point.astype(float)
                    way = np.linalg.norm(np.subtract(corner, transmitter)) + np.linalg.norm(np.subtract(receiver, corner))
                    fields[i - len(nodes)] += a / unit * np.exp(-2j * np.pi * way / wavelength)
                    continue
                edge = (here[0][1], *point, *here[0][2], *here[0][3]) if here else (0,) * 8
                rows.append((number, ghz, i // 2, *transmitter, *receiver, *edge, 20 * np.log10(abs(a) / unit)))
            for cell, power in enumerate(np.mean(np.abs(fields.reshape(cells, -1))**2, axis=1)):
                rows.append((number, ghz, cell, *transmitter, *nodes[2 * cell], -1, *(0,) * 7, 10 * np.log10(power)))
            print(geometry["name"], ghz, len(found), len(rows), "top and bottom", 10 * np.log10(largest_away + 1e-30),
                  file=sys.stderr)
    return rows


def main():
    write_rows(sys.argv[1], single_edges())
    write_rows(sys.argv[2], powers())


if __name__ == "__main__":
    main()
