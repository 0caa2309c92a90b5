#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes one source of several, which tools/batches.cmake has compiled together.

Usage: batch_sources.py OUTPUT ROOT SOURCE...; sources are relative to ROOT. Each keeps its numbers of lines, and its path as the compiler
finds it, which runs in the same folder as this script; its unnamed namespaces are put into a namespace of its own, which the rest of the
source sees.
"""
import os
import pathlib
import re
import sys


def main():
    output, root, sources = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    parts = ["// Made by tools/batch_sources.py."]
    for source in sources:
        own = "in_" + re.sub(r"\W", "_", source.removesuffix(".cpp"))
        text = (root / source).read_text()
        # Where only closing braces follow, nothing there needs the names, and headers of later sources are spared them.
        has_more = not re.fullmatch(r"(\s|\}|//.*)*", text.rpartition("}  // namespace\n")[2])
        using = f" using namespace {own};" if has_more else ""
        text, opened = re.subn(r"^namespace \{$", f"namespace {own} {{ namespace {{", text, flags=re.M)
        text, closed = re.subn(r"^\}  // namespace$", f"}}}}{using}  // namespace", text, flags=re.M)
        if opened != closed:
            sys.exit(f"{source}: {opened} unnamed namespaces begin in lines of their own, {closed} end as \"}}  // namespace\"")
        parts.append(f'#line 1 "{os.path.relpath(root / source)}"\n{text}')
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text("\n".join(parts))


main()
