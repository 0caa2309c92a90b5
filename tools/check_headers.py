#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that each header of src/aureole compiles alone: check_headers.py BUILD [--jobs N] [HEADER...].

BUILD is a folder with a compile_commands.json. A header is included two times in a unit of its own, which is parsed by
the compiler and with the flags of a source that is near to it, without precompiled headers. A header that includes too
little, or that has no guard, is an error.

Results are kept in BUILD/headers_alone.json: a header is compiled again only where its flags or a file of the project that it
includes have changed. HEADER restricts the check to headers whose path contains one of these words."""
import argparse
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HEADERS = ROOT / "src" / "aureole"
COMPILER = re.compile(r"(?:.*/)?(?:[\w-]*-)?(?:c\+\+|g\+\+|clang\+\+)(?:-[\d.]+)?$")


def flags_of(command):
    """The compiler and its flags, without a launcher, precompiled headers, input and output."""
    words = shlex.split(command)
    first = next(i for i, word in enumerate(words) if COMPILER.match(word))
    kept, rest = [words[first]], iter(words[first + 1:])
    for word in rest:
        if word in {"-o", "-MF", "-MT", "-MQ"}:
            next(rest)
        elif word == "-include":
            header = next(rest)
            if not re.search(r"cmake_pch\.h(xx)?$", header):
                kept += [word, header]
        elif word in {"-Xclang"}:  # clang's precompiled headers: -Xclang -include-pch -Xclang FILE
            value = next(rest)
            if value == "-include-pch" or value == "-include":
                next(rest), next(rest)
            else:
                kept += [word, value]
        elif word not in {"-c", "-MD", "-MMD", "-Winvalid-pch", "-fpch-preprocess"} and not word.endswith((".cpp", ".cxx")):
            kept.append(word)
    return kept


def sources_of(file, build):
    """The sources that a unit compiles: itself, or those of a batch (tools/batches.cmake)."""
    path = Path(file)
    if build not in path.parents:
        return [path]
    if not path.is_file():
        return []
    named = re.findall(r'^#(?:include|line \d+) "([^"]+\.cpp)"', path.read_text(encoding="utf-8", errors="ignore"), flags=re.MULTILINE)
    return [p if p.is_absolute() else ROOT / "src" / p for p in map(Path, named)]


def units(build):
    """By folder of sources of src/aureole: the folder to run in and the flags, those of the library where a tool compiles a source, too."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        for source in sources_of(entry["file"], build):
            if HEADERS in source.parents and source.suffix == ".cpp":
                flags = flags_of(entry.get("command") or shlex.join(entry["arguments"]))
                if len(flags) > len(found.get(source.parent, ("", []))[1]):
                    found[source.parent] = (entry["directory"], flags)
    return found


def nearest(header, found):
    """The unit whose folder shares most with the header's."""
    return found[max(found, key=lambda folder: (len(os.path.commonpath([folder, header.parent])), -len(str(folder))))]


def digest(flags, files):
    h = hashlib.sha256(" ".join(flags).encode())
    for file in sorted(files):
        path = ROOT / file
        h.update(file.encode() + (path.read_bytes() if path.is_file() else b"missing"))
    return h.hexdigest()


def compile_alone(header, unit):
    """(errors or "", files of the project that the header includes)."""
    folder, flags = unit
    name = header.relative_to(ROOT / "src")
    with tempfile.NamedTemporaryFile(suffix=".d") as made:
        run = subprocess.run([*flags, "-fsyntax-only", "-MD", "-MT", "x", "-MF", made.name, "-x", "c++", "-"], cwd=folder,
                             input=f'#include "{name}"\n#include "{name}"\n', capture_output=True, text=True, check=False)
        words = Path(made.name).read_text(encoding="utf-8").replace("\\\n", " ").split()[1:]
    paths = (Path(folder, w).resolve() for w in words if w != "-")
    files = {str(p.relative_to(ROOT)) for p in paths if HEADERS in p.parents}
    return ("" if run.returncode == 0 else run.stderr.strip() or "the compiler failed"), files | {str(header.relative_to(ROOT))}


def main():
    parser = argparse.ArgumentParser(description="Compiles each header alone.")
    parser.add_argument("build", type=Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("headers", nargs="*")
    arguments = parser.parse_intermixed_args()
    build = arguments.build.resolve()
    if not (build / "compile_commands.json").is_file():
        print(f"{build} has no compile_commands.json: configure it by CMake first")
        return 2
    found = units(build)
    if not found:
        print("compile_commands.json names no source of src/aureole")
        return 2
    store = build / "headers_alone.json"
    try:
        known = json.loads(store.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        known = {}
    headers = [h for h in sorted(HEADERS.rglob("*.h")) if not arguments.headers or any(w in str(h) for w in arguments.headers)]

    def check(header):
        name, unit = str(header.relative_to(ROOT)), nearest(header, found)
        old = known.get(name)
        if old and old["digest"] == digest(unit[1], old["files"]):
            return name, "", old
        errors, files = compile_alone(header, unit)
        return name, errors, {"digest": digest(unit[1], files), "files": sorted(files)}

    failed, compiled = 0, 0
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for name, errors, result in pool.map(check, headers):
            compiled += known.get(name) != result
            if errors:
                failed += 1
                known.pop(name, None)
                print(f"{name} does not compile alone:\n" + "\n".join(errors.split("\n")[:12]))
            else:
                known[name] = result
    store.write_text(json.dumps(known), encoding="utf-8")
    print(f"{len(headers)} headers, {compiled} compiled, {failed} do not compile alone")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
