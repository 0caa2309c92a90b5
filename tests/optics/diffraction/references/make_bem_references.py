#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two slits and two cubes at 10 GHz after bempp-cl (MIT), for tests/optics/diffraction/bem_test.cpp.

    python3 -m venv venv && venv/bin/pip install bempp-cl==0.4.2 meshio gmsh
    venv/bin/python make_bem_references.py bem_references.inc [SLITS] [CUBES]

SLITS and CUBES: nodes to a wavelength, 8 and 4. A matrix takes 16 N^2 bytes: the slits have N = 2,048 (67 MB) and the cubes 2,032 (66 MB); the
program prints both before it begins. It takes half an hour of one core. The scalar Helmholtz equation, as the models that are compared.

Slits: a soft screen (u = 0) with two slits of 6 x 24 cm, 12 cm apart, unbounded. By Babinet's principle the field behind it is
minus what two hard plates in place of the slits scatter: a hypersingular equation over the plates alone, with no rim of the screen.
Cubes: soft cubes of 9 cm (3 wavelengths), 4.5 cm apart across the light, by the combined field equation, solved directly.

A row is the angle from the way of the light [degrees], in the plane across the slits or through both cubes, and the intensity per
steradian for an irradiance of 1, |f|^2 [m^2/sr], f the amplitude of the far field exp(i k r)/r. The light goes along -z.
"""

import pathlib
import sys

import bempp_cl.api as api
import numpy as np
from bempp_cl.api.operators import boundary, far_field

api.DEFAULT_DEVICE_INTERFACE = "numba"
LAMBDA = 299792458.0 / 10e9
K = 2 * np.pi / LAMBDA
ANGLES = np.arange(0.0, 61.0, 1.0)


def directions():
    t = np.radians(ANGLES)
    return np.array([np.sin(t), np.zeros_like(t), -np.cos(t)])


def patch(corner, u, v, nu, nv):
    """Vertices and triangles of a parallelogram divided into nu x nv."""
    a, b = np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1), indexing="ij")
    points = np.asarray(corner)[:, None] + np.outer(u, a.ravel()) + np.outer(v, b.ravel())
    index = np.arange((nu + 1) * (nv + 1)).reshape(nu + 1, nv + 1)
    p, q, r, s = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    return points, np.hstack([np.array([p, q, r]), np.array([p, r, s])])


def grid(patches):
    """One grid of patches, vertices at one place welded."""
    points = np.hstack([p for p, _ in patches])
    offset, triangles = 0, []
    for p, t in patches:
        triangles.append(t + offset)
        offset += p.shape[1]
    _, first, inverse = np.unique(np.round(points.T, 9), axis=0, return_index=True, return_inverse=True)
    return api.Grid(points[:, first], inverse.ravel()[np.hstack(triangles)].astype("uint32"))


def dense(operator):
    return api.as_matrix(operator.weak_form())


def slits(per_wavelength):
    n = [int(np.ceil(size / LAMBDA * per_wavelength)) for size in (0.06, 0.24)]
    g = grid([patch((x - 0.03, -0.12, 0), (0.06, 0, 0), (0, 0.24, 0), *n) for x in (-0.06, 0.06)])
    space = api.function_space(g, "P", 1)  # 0 on the borders
    print(f"slits: N = {space.global_dof_count}, {16e-6 * space.global_dof_count**2:.0f} MB", flush=True)
    w = dense(boundary.helmholtz.hypersingular(space, space, space, K))

    @api.complex_callable
    def slope(x, normal, _, result):  # d/dn of exp(-i k z)
        result[0] = -1j * K * normal[2] * np.exp(-1j * K * x[2])

    right = api.GridFunction(space, fun=slope, dual_space=space).projections(space)
    jump = api.GridFunction(space, coefficients=np.linalg.solve(w, right))
    return (far_field.helmholtz.double_layer(space, directions(), K) * jump).ravel()


def cubes(per_wavelength):
    side, gap = 0.09, 0.045
    n = int(np.ceil(side / LAMBDA * per_wavelength))
    patches = []
    for x in (-gap / 2 - side, gap / 2):
        o = np.array([x, -side / 2, -side / 2])
        e = side * np.eye(3)
        for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            patches.append(patch(o, e[b], e[a], n, n))  # normals outside: -e[c], then +e[c]
            patches.append(patch(o + e[c], e[a], e[b], n, n))
    g = grid(patches)
    space = api.function_space(g, "P", 1)
    print(f"cubes: N = {space.global_dof_count}, {16e-6 * space.global_dof_count**2:.0f} MB", flush=True)
    identity = boundary.sparse.identity(space, space, space)
    adjoint = boundary.helmholtz.adjoint_double_layer(space, space, space, K)
    single = boundary.helmholtz.single_layer(space, space, space, K)
    matrix = 0.5 * np.asarray(api.as_matrix(identity.weak_form())) + dense(adjoint) - 1j * K * dense(single)

    @api.complex_callable
    def right_side(x, normal, _, result):
        u = np.exp(-1j * K * x[2])
        result[0] = -1j * K * normal[2] * u - 1j * K * u

    right = api.GridFunction(space, fun=right_side, dual_space=space).projections(space)
    density = api.GridFunction(space, coefficients=np.linalg.solve(matrix, right))
    return -(far_field.helmholtz.single_layer(space, directions(), K) * density).ravel()


def main():
    nodes = [float(n) for n in sys.argv[2:4]] + [8.0, 4.0][len(sys.argv[2:4]) :]
    text = "// SPDX-License-Identifier: Apache-2.0\n// Written by make_bem_references.py with bempp-cl 0.4.2.\n"
    for name, solve, per_wavelength in (("slits", slits, nodes[0]), ("cubes", cubes, nodes[1])):
        text += f"// {name}, {per_wavelength:g} nodes to a wavelength\n"
        text += "".join(f'{{"{name}", {a:g}, {abs(f) ** 2:.6g}}},\n' for a, f in zip(ANGLES, solve(per_wavelength)))
    pathlib.Path(sys.argv[1]).write_text(text)


if __name__ == "__main__":
    main()
