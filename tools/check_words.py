#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks how comments and pages are written: check_words.py [--root ROOT] [--count] [PATH...].

- Comments of C++, Python, shell, CMake and make do not begin with an opening that has no noun of its own (OPENINGS),
  and hold no word or phrase that only this project would understand (PHRASES).
- Pages in `docs` have one sentence a line, numbers with a leading zero, and none of these phrases.

Prints each finding with file and line and fails if there is any. PATH restricts the check to files and folders; a path
inside an excluded one is checked when it is named. With --count, prints the number of findings of each folder instead."""
import argparse
import ast
import io
import re
import subprocess
import sys
import tokenize
from collections import Counter
from pathlib import Path

# Folders and files that are not checked yet, and why. This is the one list of them.
EXCLUDED = {
    "docs/plugins.md": "generated from the plug-ins (make docs)",
    "tools/check_words.py": "holds the phrases",
}

# A comment that begins so refers to something outside of it.
OPENINGS = re.compile(
    r"(?i:the same\b|those\b|that of\b|those of\b|as that\b|as those\b|about the part\b|of that\b|with that\b|than that\b)"
    r"|Of (?:an?|the|each|every|one|all)\b|What\b")

# Each hit is sure: no sentence of the field needs these. The second item is the field's term.
PHRASES = [
    (r"\bseldom(?:ly)?\b", "rarely; Russian roulette with survival probability p"),
    (r"\bamid(?:st)?\b", "among, within"),
    (r"\blend(?:s|ing)?\b|\blent\b", "power diffracted at an edge"),
    (r"\bledgers?\b", "power balance; diffraction factor"),
    (r"\bof no meaning\b", "undefined"),
    (r"\band what is,? always is\b", "never missed"),
    (r"\b(?:other|wrong) way round\b", "from the other endpoint; reversed"),
    (r"\blight straight ahead\b", "undiffracted beam"),
    (r"\blight that goes around\b", "diffracted light"),
    (r"\bwhat edges send\b", "diffracted radiance"),
    (r"\bways? to find (?:it|them|this)\b", "techniques"),
    (r"\bplaces by (?:a )?light\b", "equiangular sampling"),
    (r"\blook(?:s|ed|ing)? for (?:a )?(?:lights?|lamps?)\b", "light sampling"),
    (r"\bask(?:s|ed|ing)? a lamp\b", "light sampling"),
    (r"\bwhat shines\b|\bthat shines?\b", "emitter; emits"),
    (r"\bthat lets? (?:light|rays?|it) pass\b|\blets? pass\b", "null surface; transmits"),
    (r"\bpassable\b", "null surface"),
    (r"\bfurther channels?\b", "AOV"),
    (r"\bso far as\b", "up to the distance"),
    (r"\bno more than that\b", "upper bound"),
    (r"\bflights?\b", "ray state; segment"),
    (r"\bremarks?\b|\bremarked\b", "note; warning"),
    (r"\bhow (?:seldom|much is lent)\b", "probability"),
    (r"\bweight that is left\b|\bwhat is left of the (?:path|weight)\b", "path throughput"),
    (r"\bat a place\b", "at a point, surface, vertex"),
    (r"\bwhat of (?:the|its|it|a|an|that|this|their)\b", "the fraction, the part of"),
    (r"\bwhat is (?:met|seen)\b", "the hit; the visible"),
    (r"\bopen ways?\b", "unoccluded segment"),
    (r"\brays? (?:that )?meets?\b|\bmeets? (?:a|the|no|any) (?:rays?|surface|lamps?|light|scene|face|edge|shape|sphere|box|triangle)s?\b",
     "hit, intersect"),
    (r"\bsurfaces? with a priority\b", "nested dielectric, priority"),
]
PHRASES = [(re.compile(pattern, re.IGNORECASE), term) for pattern, term in PHRASES]

CPP = {".h", ".cpp", ".inc", ".S"}
HASH = {".sh", ".cmake", ".toml", ".yml", ".yaml"}
ABBREVIATIONS = re.compile(r"\b(?:e\.g|i\.e|cf|vs|et al|[Ff]igs?|[Ee]qs?|[Ss]ec|[Cc]h|[Nn]o|[Vv]ol|pp?|approx|St|Dr|ca|[A-Z])\.$")


def comments_of_cpp(text):
    """(line, text, owns_line) of each comment; strings and raw strings are skipped."""
    token = re.compile(
        r'R"([^\s()\\]{0,16})\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*(?:.|\n)*?\*/')
    for m in token.finditer(text):
        if not m[0].startswith(("//", "/*")):
            continue
        start = text.rfind("\n", 0, m.start()) + 1
        yield text.count("\n", 0, m.start()) + 1, m[0], not text[start:m.start()].strip()


def comments_of_python(text):
    try:
        for t in tokenize.generate_tokens(io.StringIO(text).readline):
            if t.type == tokenize.COMMENT:
                yield t.start[0], t.string, not t.line[:t.start[1]].strip()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
                doc = node.body and isinstance(node.body[0], ast.Expr) and ast.get_docstring(node)
                if doc:
                    yield node.body[0].lineno, doc, None
    except (tokenize.TokenError, SyntaxError):
        return


def comments_of_hash(text):
    for number, line in enumerate(text.split("\n"), 1):
        m = re.match(r"""((?:[^"'#\\]|\\.|"[^"]*"|'[^']*')*?(?:^|(?<=\s)))#(?![!{])(.*)""", line)
        if m:
            yield number, "#" + m[2], not m[1].strip()


def blocks_of(path, text):
    """(line, text) of each comment; lines of comments that follow each other are one."""
    name, suffix = path.name, path.suffix
    if suffix in CPP:
        found = comments_of_cpp(text)
    elif suffix == ".py":
        found = comments_of_python(text)
    elif suffix in HASH or name in {"CMakeLists.txt", "Makefile"} or (suffix == "" and text.startswith("#!")):
        found = comments_of_hash(text)
    else:
        return
    block = None  # first line, text, last line
    for line, comment, owns in found:
        if owns is None:  # a docstring
            yield line, " ".join(comment.split())
            continue
        plain = re.sub(r"^\s*(?://[/!]?<?|/\*[*!]?|\*(?!/)|#+)\s?", "", comment, flags=re.MULTILINE).replace("*/", "").strip()
        if plain.startswith(("SPDX", "clang-format", "NOLINT", "noqa", "ruff:", "shellcheck")):
            continue
        if block and owns and block[3] and line == block[2] + 1 and plain:
            block = (block[0], block[1] + " " + " ".join(plain.split()), line + comment.count("\n"), True)
            continue
        if block:
            yield block[0], block[1]
        block = (line, " ".join(plain.split()), line + comment.count("\n"), owns) if plain else None
    if block:
        yield block[0], block[1]


def check_comments(path, text):
    for line, comment in blocks_of(path, text):
        comment = re.sub(r"`[^`]*`", "x", comment)  # names of the code
        if OPENINGS.match(comment):
            yield line, f"a comment begins with \"{' '.join(comment.split()[:4])} ...\": name the thing"
        for pattern, term in PHRASES:
            m = pattern.search(comment)
            if m:
                yield line, f"\"{m[0]}\": write of {term}"


def plain_text(line):
    """A line of a page without code, links, emphasis and a run-in heading (`*Title.* Text`)."""
    line = re.sub(r"^((?:[-+*]|\d+\.)\s+)?(\*\*?)[^*]+[.:]\2\s", r"\1", line)
    line = re.sub(r"`[^`]*`", "x", line)
    line = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", line)
    return line.replace("**", "").replace("*", "")


def sentences_end_inside(line):
    for m in re.finditer(r"[.!?][\")]?\s+(?=[\"(]?[A-Z0-9])", line):
        before = line[:m.start() + 1]
        if ABBREVIATIONS.search(before) or re.match(r"\s*(?:[-*]|\d+\.)\s*$", before) or before.endswith("..."):
            continue
        if re.search(r"(?:^|\s)\d+\.$", before):  # a number of a list
            continue
        return True
    return False


def check_page(text):
    text = re.sub(r"<!--.*?-->", lambda m: "\n" * m[0].count("\n"), text, flags=re.DOTALL)
    fenced = False
    previous = ""  # the line before, of running text
    for number, line in enumerate(text.split("\n"), 1):
        if re.match(r"\s*(```|~~~)", line):
            fenced = not fenced
            previous = ""
            continue
        stripped = line.strip()
        table = stripped.startswith("|")
        code = fenced or (line.startswith("    ") and not previous)
        if not code and not stripped.startswith("#"):
            zero = re.search(r"(?<![\w.)\]/\\*-])-?\.\d", re.sub(r"`[^`]*`|\]\([^)]*\)", "", line))
            if zero:
                yield number, f"\"{zero[0]}\": a number has a leading zero"
        if code or table or not stripped or stripped.startswith(("#", "![", "<", "[")) and not re.search(r"[.:]$", stripped):
            previous = ""
            continue
        if stripped.startswith("#"):
            previous = ""
            continue
        plain = plain_text(stripped)
        for pattern, term in PHRASES:
            m = pattern.search(plain)
            if m:
                yield number, f"\"{m[0]}\": write of {term}"
        if sentences_end_inside(plain):
            yield number, "more than one sentence on a line"
        begins = re.match(r"(?:[-*+]|\d+\.)\s", stripped)
        if previous and not begins and not re.search(r"[.:;!?][\")*]*$", previous):
            yield number, "a sentence goes on from the line before: one sentence a line"
        previous = plain


def excluded(path):
    for prefix in EXCLUDED:
        if path == prefix or path.startswith(prefix + "/"):
            return prefix
    return None


def main():
    parser = argparse.ArgumentParser(description="Checks the words of comments and pages.")
    parser.add_argument("--root", default=Path(__file__).resolve().parent.parent, type=Path)
    parser.add_argument("--count", action="store_true", help="print the number of findings of each folder")
    parser.add_argument("paths", nargs="*", help="files and folders to check, relative to the root")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True, check=False)
    if listed.returncode == 0:
        files = listed.stdout.split("\n")
    else:  # no repository
        files = [str(p.relative_to(root)) for p in root.rglob("*") if not {"build", ".git", ".venv"} & set(p.parts)]
    wanted = [str(Path(p)).rstrip("/") for p in arguments.paths]
    counts, problems, checked = Counter(), [], 0
    for name in sorted(set(files)):
        path = root / name
        if not name or not path.is_file():
            continue
        prefix = excluded(name)
        if wanted:
            chosen = [w for w in wanted if name == w or name.startswith(w + "/") or w == "."]
            if not chosen or (prefix and not any(w.startswith(prefix) for w in chosen)):
                continue
        elif prefix:
            continue
        page = path.suffix == ".md" and name.startswith("docs/")
        if not page and not (path.suffix in CPP | HASH | {".py"} or path.name in {"CMakeLists.txt", "Makefile"} or name.startswith(".ci/")):
            continue
        text = path.read_text(encoding="utf-8", errors="ignore")
        checked += 1
        for line, message in check_page(text) if page else check_comments(path, text):
            problems.append(f"{name}:{line}: {message}")
            folder = name.split("/")
            counts["/".join(folder[:3] if name.startswith("src/") else folder[:2]) if len(folder) > 1 else name] += 1
    if arguments.count:
        for folder, count in sorted(counts.items()):
            print(f"{count:5} {folder}")
        print(f"{sum(counts.values()):5} in {checked} files")
    else:
        print("\n".join(problems) if problems else f"the words of {checked} files are plain")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
