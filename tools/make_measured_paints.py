#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes src/aureole/pigment/data/kimera.csv from the two JSON files of miciwan's repository PaintMixing (CC BY 4.0):
make_measured_paints.py kimera_masstone.json kimera_mix1.json > kimera.csv"""
import json
import sys

print("# Reflectance of 13 acrylic paints (Kimera, single pigments), pure and with weighed white, opaque layers, three measurements each.")
print("# By miciwan, https://github.com/miciwan/PaintMixing, under CC BY 4.0 (LICENSE.kimera); rearranged as a table, numbers unchanged.")
wavelengths = None
for path in sys.argv[1:]:
    for entry in json.load(open(path)):
        if entry["type"] == "wavelengths":
            if wavelengths is None:
                wavelengths = entry["values"]
                print("paints,unit," + ",".join(f"{nm:g}" if nm == round(nm) else f"{nm:.4f}" for nm in wavelengths))
            assert entry["values"] == wavelengths
            continue
        parts = entry.get("components")
        paints = " + ".join(f"{name}: {amount:g}" for name, amount in parts.items()) if parts else entry["name"]
        print(f"{paints},percent," + ",".join(f"{value:.4f}" for value in entry["reflectance"]))
