# SPDX-License-Identifier: Apache-2.0
"""The grids of bench/scenes, for peers.py: written once into a folder as Mitsuba's .vol files."""
import struct

import numpy as np

SIZE = 128


def turbulence(seed, octaves):
    """A sum of octaves of smooth noise on SIZE^3 points, periodic, of zero mean and unit variance."""
    rng = np.random.default_rng(seed)
    total = np.zeros((SIZE,) * 3)
    for octave in range(1, octaves + 1):
        n = 2 ** (octave + 1)
        coarse = np.zeros((SIZE,) * 3, dtype=complex)
        spectrum = np.fft.fftn(rng.standard_normal((n,) * 3))
        k = np.fft.fftfreq(n, 1 / n).astype(int)
        coarse[np.ix_(k, k, k)] = spectrum
        total += np.real(np.fft.ifftn(coarse)) * (SIZE / n) ** 3 * 0.6**octave
    return (total - total.mean()) / total.std()


def axes():
    x = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    return np.meshgrid(x, x, x, indexing="ij")  # z, y, x: a file's order


def smoke():
    """A column that widens upwards, with turbulent density everywhere in it."""
    z, y, x = axes()
    radius = 0.2 + 0.25 * (y + 1)
    column = np.clip(1.3 - np.hypot(x + 0.15 * np.sin(3 * y), z) / radius, 0, 1)
    return np.clip(column * (0.8 + 0.5 * turbulence(1, 5)), 0, None)


def sparse_cloud():
    """Balls with ragged edges; 99 % of the voxels are empty."""
    z, y, x = axes()
    rng = np.random.default_rng(2)
    field = np.full((SIZE,) * 3, -np.inf)
    for center in rng.uniform(-0.75, 0.75, (12, 3)):
        distance = np.sqrt((x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2)
        field = np.maximum(field, 0.16 - distance)
    field = field + 0.03 * turbulence(3, 5)
    return np.clip((field - np.quantile(field, 0.99)) * 12, 0, 1)


def write(path, values):
    """Values [z, y, x] as a .vol file of one channel of floats over the unit cube."""
    header = struct.pack("<3sB5i6f", b"VOL", 3, 1, values.shape[2], values.shape[1], values.shape[0], 1, 0, 0, 0, 1, 1, 1)
    path.write_bytes(header + values.astype("<f4").tobytes())


GRIDS = {"smoke": smoke, "sparse_cloud": sparse_cloud}


def make(name, folder):
    """The file of a grid, made where it is missing."""
    path = folder / f"{name}.vol"
    if not path.is_file():
        write(path, GRIDS[name]())
    return path
