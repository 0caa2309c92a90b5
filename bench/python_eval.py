#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nanoseconds per (wi, wo, wavelength) of the Python module's `Bsdf.eval` over arrays beside those of a loop in C++ over the same numbers.

Usage: PYTHONPATH=build/bench/python bench/python_eval.py build/bench/bin/libaureole_eval_loop.so [--repeats 15]

The loop in C++ has one thread, the module takes all cores for large arrays (taskset -c 0 for one). Both take turns; the least time of each counts. Directions are uniform on the upper hemisphere (wo of the layer of scatterers on the
lower one, where it transmits), wavelengths uniform over 360 to 830 nm.
"""
import argparse
import ctypes
import time

import numpy as np

import aureole

CASES = {
    "diffuse": '<bsdf type="diffuse"/>',
    "roughconductor, Au": '<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.2"/></bsdf>',
    "correlated_scatterers": '<bsdf type="correlated_scatterers"><string name="radius" value="5um"/><float name="area_fraction" value="0.3"/></bsdf>',
}


def directions(random: np.random.Generator, n: int, sign: int = 1) -> np.ndarray:
    z = random.random(n)
    phi = 2 * np.pi * random.random(n)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), sign * z], axis=-1)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("library")
    parser.add_argument("--repeats", type=int, default=15)
    arguments = parser.parse_args()
    library = ctypes.CDLL(arguments.library)
    library.loop_make.restype = ctypes.c_void_p
    for name in ("loop_triples", "loop_directions"):
        getattr(library, name).restype = ctypes.c_double
    random = np.random.default_rng(1)
    pointer = lambda a: ctypes.c_void_p(a.ctypes.data)  # noqa: E731
    print(f"{'BSDF':24}{'':24}{'C++':>8}{'float64':>9}{'ratio':>7}{'float32':>9}{'ratio':>7}")
    for name, xml in CASES.items():
        loop = ctypes.c_void_p(library.loop_make(xml.encode()))
        bsdf = aureole.load_string(xml)
        sign = -1 if "scatterers" in name else 1
        for what, n in (("random triples", 1 << 18), ("directions x 8", 1 << 16)):
            wi, wo = directions(random, n), directions(random, n, sign)
            each = 1 if what == "random triples" else 8
            nm = 360 + 470 * random.random((n, each) if each > 1 else n)
            single = [np.ascontiguousarray(a, dtype=np.float32) for a in (wi, wo, nm)]
            reference = np.empty(nm.shape, np.float32)
            function = library.loop_triples if each == 1 else library.loop_directions
            times = [[], [], []]
            for _ in range(arguments.repeats):
                times[0].append(function(loop, *map(pointer, single), ctypes.c_int64(n), pointer(reference)))
                for k, (a, b, c) in enumerate(((wi, wo, nm), single), 1):
                    if each > 1:
                        a, b = a[:, None], b[:, None]
                    begin = time.perf_counter()
                    values = bsdf.eval(a, b, c)
                    times[k].append(time.perf_counter() - begin)
                    assert k == 1 or np.array_equal(values, reference), "the loops do not agree"
            cpp, double, float_ = (min(t) / nm.size * 1e9 for t in times)
            print(f"{name:24}{what:24}{cpp:8.2f}{double:9.2f}{double / cpp:7.2f}{float_:9.2f}{float_ / cpp:7.2f}")
        library.loop_free(loop)


if __name__ == "__main__":
    main()
