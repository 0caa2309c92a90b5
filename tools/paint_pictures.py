#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw the oil paints of a folder with Revigo's data: docs/images/oils.png and docs/images/oils_predicted.png.

    python tools/revigo_table.py ../shared/data/revigo > revigo.csv
    python tools/paint_pictures.py revigo.csv docs/images

The first picture is a brushed-out card: every pure paint as the fit has it, in brush strokes of uneven thickness over a
black and a white card. The second has each mixture as it was measured beside what the other specimens predict. Needs the
Python package aureole and matplotlib; the fits take some minute of CPU time.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

from aureole import pigment  # noqa: E402

def srgb(lab):
    """sRGB (IEC 61966-2-1) in [0, 1] of L*, a*, b* under D65."""
    lab = np.asarray(lab)
    y = (lab[..., 0] + 16) / 116
    f = np.stack([y + lab[..., 1] / 500, y, y - lab[..., 2] / 200], axis=-1)
    xyz = np.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29)) * [0.95047, 1, 1.08883]
    linear = np.clip(xyz @ np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                                     [0.0556434, -0.2040259, 1.0572252]]).T, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def strokes(random, rows, columns):
    """Thickness in films of a brushed patch: streaks along the stroke, thin where the brush lifts, none at the edges."""
    across = np.cumsum(random.normal(size=rows))
    across = np.convolve(across - np.linspace(across[0], across[-1], rows), np.ones(3) / 3, "same")
    across = across / (np.abs(across).max() + 1e-9)
    along = np.cumsum(random.normal(size=columns))
    along = along / (np.abs(along).max() + 1e-9)
    thickness = np.exp(0.45 * across[:, None] + 0.15 * along[None, :] + 0.06 * random.normal(size=(rows, columns)))
    reach = columns * (0.95 + 0.04 * np.sin(np.linspace(0, 9, rows)) + 0.02 * random.normal(size=rows))
    begin = columns * (0.04 + 0.015 * random.normal(size=rows))
    x = np.arange(columns)[None, :]
    fade = np.clip((reach[:, None] - x) / (0.12 * columns), 0, 1) * np.clip((x - begin[:, None]) / (0.02 * columns), 0, 1)
    edge = np.minimum(np.arange(rows), np.arange(rows)[::-1])[:, None]
    return thickness * fade * np.clip((edge - 2 - 2 * random.random((1, columns))) / 2, 0, 1)


def save(figure, file, dpi):
    """The figure as a picture of 256 colours, a third of the bytes."""
    figure.savefig(file, dpi=dpi)
    with Image.open(file) as picture:
        small = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    small.save(file, optimize=True)
    plt.close(figure)


def card_picture(palette, file):
    """Every paint over black and over white, with its name."""
    random = np.random.default_rng(3)
    columns, rows = 4, -(-len(palette.names) // 4)
    figure, axes = plt.subplots(rows, columns, figsize=(11, 1.75 * rows), facecolor="#f4f2ec")
    black, white = 0.01, 0.83  # inner reflectance of the cards
    height, width = 90, 240
    for axis, name in zip(axes.flat, palette.names):
        paint = palette.mix(name)
        levels = np.concatenate([[1e-6], np.geomspace(0.02, 4, 24)])
        thickness = strokes(random, height, width)
        picture = np.empty((height, width, 3))
        for half, below in ((slice(0, width // 2), black), (slice(width // 2, width), white)):
            colours = pigment.lab(palette.nm, np.stack([paint.reflectance(x, below) for x in levels]))
            place = np.interp(thickness[:, half], levels, np.arange(levels.size))
            low = np.clip(place.astype(int), 0, levels.size - 2)
            t = (place - low)[..., None]
            picture[:, half] = srgb(colours[low] * (1 - t) + colours[low + 1] * t)
        axis.imshow(picture, interpolation="bilinear", aspect="auto")
        axis.set_title(name, fontsize=10, loc="left", pad=3, family="serif")
    for axis in axes.flat:
        axis.axis("off")
    figure.tight_layout(pad=0.8)
    save(figure, file, 80)


def mixtures_picture(held, nm, recipes, file):
    """Measured (left) and predicted (right) over black (top) and over white (bottom), with CIEDE2000."""
    held = sorted(held, key=lambda h: h.difference)
    columns = 9
    rows = -(-len(held) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(11, 1.5 * rows), facecolor="#f4f2ec")
    for axis, one in zip(axes.flat, held):
        order = np.argsort(one.measured.mean(axis=1))
        patch = np.stack([np.stack([srgb(pigment.lab(nm, np.maximum(v[i], 0))) for v in (one.measured, one.predicted)])
                          for i in order])
        axis.imshow(np.repeat(np.repeat(patch, 20, axis=0), 20, axis=1), aspect="auto")
        axis.set_title(f"{recipes[one.specimen]}\n{one.difference:.1f}", fontsize=6.5, pad=2, family="serif", linespacing=0.95)
    for axis in axes.flat:
        axis.axis("off")
    figure.tight_layout(pad=0.5, h_pad=0.6, w_pad=0.5)
    save(figure, file, 90)


def main():
    table, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    # As the command of docs/pigments.md: streams, which predict these mixtures better, in linseed oil.
    fit = pigment.joint_fit(table, theory="streams", geometry="d8", index=1.48, hold_out="each")
    card_picture(fit.palette, folder / "oils.png")
    recipes = {}
    for line in pathlib.Path(table).read_text().splitlines()[1:]:
        _, specimen, _, paints = line.split(",")[:4]
        if specimen:
            recipes[specimen] = paints.replace(" + ", "\n")
    mixtures_picture(fit.held_out, fit.palette.nm, recipes, folder / "oils_predicted.png")
    differences = np.array([h.difference for h in fit.held_out])
    print(f"{differences.size} mixtures kept back in turn: CIEDE2000 mean {differences.mean():.2f}, median {np.median(differences):.2f}")


if __name__ == "__main__":
    main()
