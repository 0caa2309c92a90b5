#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write src/aureole/optics/sky/data/hosek_wilkie.bin, the spectral data of the sky and sun models of Hosek & Wilkie.

    python tools/make_sky_table.py FILE [output file]

FILE is data/sunsky/sunsky_datasets.bin of the PyPI package `mitsuba`, which holds the data of
http://cgg.mff.cuni.cz/projects/SkylightModelling/ under their licence, src/aureole/optics/sky/data/LICENSE.hosek_wilkie.
The output is float32, little-endian:
sky  [turbidity 1..10][albedo 0, 1][control point 0..5][channel 0..10][A ... I of the formula, radiance]
sun  [turbidity 1..10][segment of elevation 0..44][channel 0..10][coefficient of x^0 ... x^3]
limb [channel 0..10][coefficient of cos^0 ... cos^5]
"""
import pathlib
import struct
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent


def read_tensors(data):
    """The float64 arrays of a tensor file, by name."""
    if not data.startswith(b"tensor_file\0"):
        sys.exit("not a tensor file")
    (count,) = struct.unpack_from("<I", data, 14)
    at, arrays = 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
        at += 11 + 8 * dimensions
        if kind != 11:
            sys.exit(f"{name}: expected float64")
        arrays[name] = np.frombuffer(data, "<f8", int(np.prod(shape)), offset).reshape(shape)
    return arrays


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    tensors = read_tensors(pathlib.Path(sys.argv[1]).read_bytes())
    sky = np.concatenate([tensors["sky_params_spec"], tensors["sky_rad_spec"][..., None]], -1)
    sun, limb = tensors["sun_rad_spec"], tensors["sun_ld_spec"]
    assert sky.shape == (10, 2, 6, 11, 10) and sun.shape == (10, 45, 11, 4) and limb.shape == (11, 6)
    out = sys.argv[2] if len(sys.argv) == 3 else ROOT / "src/aureole/optics/sky/data/hosek_wilkie.bin"
    pathlib.Path(out).write_bytes(b"".join(a.astype("<f4").tobytes() for a in (sky, sun, limb)))


if __name__ == "__main__":
    main()
