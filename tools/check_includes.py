#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that includes run one way: core <- math <- spectrum <- optics <- plugin <- families <- scene <- integrator <- render <- apps <- python.
Plug-ins may include family interfaces (`<family>/<family>.h`), not one another. Prints every arrow that points the wrong way."""
import os
import re
import sys

LAYERS = [["core"], ["math"], ["spectrum"], ["optics", "pigment"], ["plugin"],
          ["shape", "texture", "bsdf", "aperture", "correlation", "phase", "medium", "emitter", "sensor", "film", "filter", "sampler"],
          ["scene"], ["integrator"], ["render", "instrument"], ["apps"], ["python"]]
RANK = {name: i for i, layer in enumerate(LAYERS) for name in layer}
ALONE = {"apps": "apps", "python/bindings": "python"}  # folders without subfolders
PHYSICS = {"optics", "pigment"}  # never see a renderer type, not even a float Spectrum

root = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "")
problems = []
count = 0
for base in ("src/aureole", "apps", "python/bindings"):
    for folder, _, files in os.walk(os.path.join(root, base)):
        for name in files:
            if not name.endswith((".h", ".cpp")):
                continue
            path = os.path.join(folder, name)
            here = ALONE[base] if base in ALONE else os.path.relpath(path, os.path.join(root, base)).split(os.sep)[0]
            if here not in RANK:
                problems.append(f"{os.path.relpath(path, root)}: the folder {here} has no place in the order")
                continue
            for number, line in enumerate(open(path, encoding="utf-8"), 1):
                m = re.match(r'\s*#include "aureole/(\w+)/', line)
                if not m:
                    continue
                count += 1
                there = m.group(1)
                where = f"{os.path.relpath(path, root)}:{number}"
                if there not in RANK:
                    problems.append(f"{where}: includes unknown folder {there}")
                elif RANK[there] > RANK[here]:
                    problems.append(f"{where}: {here} must not include {there}")
                elif here in PHYSICS and there not in PHYSICS | {"core"}:
                    problems.append(f"{where}: {here} stands alone and must not include {there}")
                elif RANK[there] == RANK[here] and there != here and RANK[here] == RANK["bsdf"]:
                    if not re.search(rf'"aureole/{there}/({there}|\w+_point|\w+_docs)\.h"', line):
                        problems.append(f"{where}: {here} may include {there} through its interface only")
print("\n".join(problems) if problems else f"{count} includes, all in order")
sys.exit(1 if problems else 0)
