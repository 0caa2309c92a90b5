#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares predictions of mixtures that were kept back with those of the plain two-constant fit, mixture by mixture.

    python3 tools/revigo_table.py ../shared/data/revigo > revigo.csv
    aureole pigment fit revigo.csv --joint --k1 0.0418 --k2 0.5963 --index 1.48 --white ZincWhite --black BoneBlack \
        --hold-out each --json held.json
    python3 tools/compare_held_out.py revigo.csv held.json

For each theory of the report it prints the mean and the median CIEDE2000, the median of the ratios to the plain fit with a 90 %
interval by bootstrap over the mixtures, their geometric mean, and on how many mixtures the theory is better. The sets of mixtures are: all; those whose coloured paints have another tint in the table; those
that have one in their own series, as the plain fit needs (40 of the oil paints); those of the kinds of which the table lacks
specimens, 50:50 tints, shades and mixtures; and sets of eleven, drawn from all in a fixed random order: four tints of about 50:50,
four shades with black, three other mixtures.

The kinds, as the numbers of the table have gaps (03C, 04E, 05C, 08C, 09C, 11C, 13C, 14E, 16E and more): coloured paints with about as
much of the white, coloured paints with 4 to 15 % of the black, and mixtures with another white.
"""
import csv
import json
import math
import random
import statistics
import sys

WHITE, BLACK = "ZincWhite", "BoneBlack"
OTHER_WHITES = ("LeadWhite", "BariumSulphate", "CalciumCarbonate")
DRAWS = 2000


def interval_of_median(values):
    """90 % interval of the median by bootstrap, from a fixed seed."""
    draw = random.Random(1)
    medians = sorted(statistics.median(draw.choices(values, k=len(values))) for _ in range(DRAWS))
    return medians[round(0.05 * DRAWS)], medians[round(0.95 * DRAWS) - 1]


def recipes(file):
    """Parts by paint of each specimen, and its series."""
    with open(file, encoding="utf-8") as rows:
        return {row["specimen"]: (row["series"], {part.split(":")[0].strip(): float(part.split(":")[1]) for part in row["paints"].split("+")})
                for row in csv.DictReader(rows) if row["paints"]}


def is_determined(name, table):
    """Whether each coloured paint of a mixture is in another mixture of its series with a paint that is not the black."""
    series, recipe = table[name]
    return all(any(other != name and of == series and paint in parts and any(with_ not in (paint, BLACK) for with_ in parts)
                   for other, (of, parts) in table.items() if len(parts) > 1)
               for paint in recipe if paint not in (WHITE, BLACK))


def kind(recipe):
    share = recipe.get(WHITE, 0) / sum(recipe.values())
    if BLACK in recipe:
        return "shade"
    return "tint" if 0.4 <= share <= 0.6 else "other"


def is_of_the_kinds(recipe):
    """Whether a mixture is a 50:50 tint, a shade with 4 to 15 % of the black, or a mixture of a coloured paint with another white."""
    total = sum(recipe.values())
    white, black = recipe.get(WHITE, 0) / total, recipe.get(BLACK, 0) / total
    colours = [paint for paint in recipe if paint not in (WHITE, BLACK)]
    if any(paint in OTHER_WHITES for paint in colours):
        return black == 0
    return (0.4 <= white <= 0.6 and black == 0) or (0.04 < black < 0.15 and bool(colours))


def main():
    table = recipes(sys.argv[1])
    with open(sys.argv[2], encoding="utf-8") as file:
        report = json.load(file)["held_out"]
    held = {one["specimen"]: one for one in report["specimens"] if "plain" in one}
    theories = [name for name in report["coverage"] if all(name in one for one in held.values())]
    forty = [name for name in held if is_determined(name, table)]
    sets = {"all": list(held), "another tint": [name for name, one in held.items() if one["determined"]], "another tint of the series": forty,
            "of the kinds that lack": [name for name in held if is_of_the_kinds(table[name][1])]}
    by_kind = {k: [name for name in held if kind(table[name][1]) == k] for k in ("tint", "shade", "other")}
    order = random.Random(1)
    elevens = [order.sample(by_kind["tint"], 4) + order.sample(by_kind["shade"], 4) + order.sample(by_kind["other"], 3) for _ in range(DRAWS)]
    print(f"{'mixtures':<28}{'theory':<12}{'mean':>6}{'median':>8}{'ratio':>7}{'90 %':>12}{'geom.':>7}  better")
    for title, names in sets.items():
        values = [held[name]["plain"] for name in names]
        print(f"{title:<28}{'plain':<12}{statistics.mean(values):>6.2f}{statistics.median(values):>8.2f}")
        for theory in theories:
            values = [held[name][theory] for name in names]
            ratios = [held[name][theory] / held[name]["plain"] for name in names]
            low, high = interval_of_median(ratios)
            geometric = math.exp(statistics.mean(math.log(r) for r in ratios))
            print(f"{'':<28}{theory:<12}{statistics.mean(values):>6.2f}{statistics.median(values):>8.2f}{statistics.median(ratios):>7.2f}"
                  f"{f'{low:.2f} - {high:.2f}':>12}{geometric:>7.2f}  {sum(r < 1 for r in ratios)} of {len(names)}")
    for theory in theories:
        ratios = [[held[name][theory] / held[name]["plain"] for name in names] for names in elevens]
        medians = [statistics.median(r) for r in ratios]
        better = [sum(x < 1 for x in r) for r in ratios]
        print(f"{DRAWS} sets of eleven, {theory}: median ratio {statistics.mean(medians):.2f} +- {statistics.stdev(medians):.2f}, at most 0.8 in "
              f"{sum(m <= 0.8 for m in medians) / DRAWS:.0%}; better on {statistics.mean(better):.1f} +- {statistics.stdev(better):.1f}, "
              f"on at least 8 in {sum(b >= 8 for b in better) / DRAWS:.0%}")
    for theory in theories:
        print(f"90 % intervals of {theory} cover {report['coverage'][theory]:.1%}")


if __name__ == "__main__":
    main()
