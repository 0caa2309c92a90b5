#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that includes run one way: core <- math <- spectrum <- optics, pigment <- plugin <- parameter <- families <- asset <- scene <-
transport <- integrator <- loading <- render, instrument <- apps <- python.
The families are ranked, too: one may include the interfaces of those before it, not their plug-ins. Prints every include against that order, rooms that include each other, and files that have the name of another one: a name says which file is meant, in an error, a
list of open files or a talk; files that open files of the user by themselves, not by core/input_file.h or core/output_file.h."""
import os
import re
import sys
from graphlib import CycleError, TopologicalSorter

FAMILIES = ["shape", "texture", "volume", "filter", "film", "sampler", "aperture", "correlation", "ingredient", "phase", "medium", "bsdf",
            "bssrdf", "modulation", "emitter", "sensor"]
LAYERS = [["core"], ["math"], ["spectrum"], ["optics", "pigment"], ["plugin"], ["parameter"], FAMILIES,
          ["asset"], ["scene"], ["transport"], ["integrator"], ["loading"], ["render", "instrument"], ["apps"], ["python"]]
RANK = {name: i for i, layer in enumerate(LAYERS) for name in layer}
ALONE = {"apps": "apps", "python/bindings": "python"}  # folders without subfolders
PHYSICS = {"optics", "pigment"}  # never see a renderer type, not even a float Spectrum
PHYSICS_CORE = {"letter_case", "parallel_for", "random"}  # of core what the library aureole_optics has (src/aureole/optics/CMakeLists.txt)
# Headers of a family that other families may include; where a family is not named here, <family>/<family>.h alone.
INTERFACES = {"shape": {"shape", "surface_point", "area_sampler", "shape_area"},
              "phase": {"phase", "mean_cosine", "mie_tables", "tabulated_phase_function"}}
OPTICS_ROOMS = {"interface": 0, "particle": 0, "aperture": 0, "sky": 0, "photometry": 0, "lens": 0, "detector": 0, "diffraction": 1, "arrangement": 1, "medium": 1, "stack": 1, "layer": 2}  # a room includes lower ones


def may_include(room, other):
    """Rooms of optics; what lies beside the rooms is for all of them."""
    return other == room or other not in OPTICS_ROOMS or OPTICS_ROOMS[other] < OPTICS_ROOMS.get(room, 0)


root = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "")
problems = []
places = {}  # by name
count = 0
arrows = {}  # which rooms each one includes
for base in ("src/aureole", "apps", "python/bindings"):
    for folder, _, files in os.walk(os.path.join(root, base)):
        for name in files:
            if not name.endswith((".h", ".cpp")):
                continue
            path = os.path.join(folder, name)
            if name in places:
                problems.append(f"{os.path.relpath(path, root)}: {places[name]} has the same name")
            places[name] = os.path.relpath(path, root)
            if base == "src/aureole" and folder == os.path.join(root, base):
                continue  # precompiled.h is above and below everything
            here = ALONE[base] if base in ALONE else os.path.relpath(path, os.path.join(root, base)).split(os.sep)[0]
            if here not in RANK:
                problems.append(f"{os.path.relpath(path, root)}: the folder {here} has no place in the order")
                continue
            for number, line in enumerate(open(path, encoding="utf-8"), 1):
                m = re.match(r'\s*#include "aureole/(\w+)/(\w+)', line)
                if not m:
                    continue
                count += 1
                there, inside = m.groups()
                where = f"{os.path.relpath(path, root)}:{number}"
                if there != here:
                    arrows.setdefault(here, set()).add(there)
                if there not in RANK:
                    problems.append(f"{where}: includes unknown folder {there}")
                elif RANK[there] > RANK[here]:
                    problems.append(f"{where}: {here} must not include {there}")
                elif here in PHYSICS and there not in PHYSICS | {"core"}:
                    problems.append(f"{where}: {here} stands alone and must not include {there}")
                elif here in PHYSICS and there == "core" and inside not in PHYSICS_CORE:
                    problems.append(f"{where}: core/{inside}.h is no part of the library of optics")
                elif here == "optics" and there == "pigment":
                    problems.append(f"{where}: optics must not include pigment, which is above it")
                elif here == there == "optics" and not may_include(os.path.basename(folder), inside):
                    problems.append(f"{where}: optics/{os.path.basename(folder)} must not include optics/{inside}")
                elif here in FAMILIES and there in FAMILIES and there != here:
                    header = re.search(rf'"aureole/{there}/(.*)\.h"', line)
                    if FAMILIES.index(there) > FAMILIES.index(here):
                        problems.append(f"{where}: {here} must not include {there}, which comes after it in the order of the families")
                    elif not header or header.group(1) not in INTERFACES.get(there, {there}):
                        problems.append(f"{where}: {here} may include {there} through its interface only")
try:
    TopologicalSorter(arrows).prepare()
except CycleError as cycle:
    problems.append("these rooms include each other: " + " <- ".join(cycle.args[1]))
# Edges that diffract light are an affair of two rooms: few other files may name their types.
EDGE_NAMES = re.compile(r"aureole/scene/edge/|aureole/transport/edge|\b(SceneEdges|EdgePaths|EdgeWalk|LightWay|LitEdges|SeenEdges|AfterEdge)\b")
EDGE_ROOMS = re.compile(r"src/aureole/(scene/edge/|transport/edge|optics/diffraction/)")
MOST_EDGE_FILES = 6
edge_files = sorted(path for path in places.values() if not EDGE_ROOMS.match(path)
                    and EDGE_NAMES.search(open(os.path.join(root, path), encoding="utf-8").read()))
if len(edge_files) > MOST_EDGE_FILES:
    problems.append(f"{len(edge_files)} files outside of scene/edge and transport/edge* name edges that diffract, at most {MOST_EDGE_FILES} may: "
                    + ", ".join(edge_files))
# A pipe blocks who opens it, a device may have no end: files of the user are opened in one place, and where a library opens them by name, after
# a check there.
OPENS = re.compile(r"std::[io]?fstream\b|\bfopen\(|(?<![\w:])::open\(|\bload_file\(\w")
PRINTS = re.compile(r"fmt::print\(\s*stderr")  # throws where standard error cannot be written
OPENERS = {"src/aureole/core/input_file.cpp", "src/aureole/core/output_file.cpp", "src/aureole/core/memory.cpp", "src/aureole/core/workers.cpp",
           "src/aureole/parameter/vdb/module/vdb_module.cpp", "src/aureole/parameter/vdb/module/vdb_lengths.cpp"}
for path in sorted(set(places.values()) - OPENERS):
    for number, line in enumerate(open(os.path.join(root, path), encoding="utf-8"), 1):
        if OPENS.search(line.split("//")[0]):
            problems.append(f"{path}:{number}: opens a file by itself; use InputFile, read_text_file (core/input_file.h) or write_file_atomically (core/output_file.h)")
        if PRINTS.search(line):
            problems.append(f"{path}:{number}: prints to standard error by itself; use tell (apps/aureole/messages.h)")
print("\n".join(problems) if problems else f"{count} includes, all in order; {len(edge_files)} files outside of their rooms name edges that diffract")
sys.exit(1 if problems else 0)
