#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the pages that explain the source against it: check_docs.py [ROOT].

- Names in backticks in the pages below exist: files, tests (Suite.Name), and every other word somewhere in the source.
- A walk through a file shows all of it: between `<!-- walk FILE -->` and `<!-- end of walk -->` the blocks of C++, one after
  the other, are that file but for blank lines.
- A block of C++ under `<!-- from FILE -->` stands in that file, but for indentation.
- Each record of docs/decisions has a row in its README with its number, title, date and status.
- CITATION.cff states the version of src/aureole/core/version.h.

Prints every difference with its page and line."""
import re
import subprocess
import sys
from pathlib import Path

PAGES = ["CONTRIBUTING.md", "docs/architecture.md", "docs/decisions/*.md"]  # patterns
BASES = ["", "src", "src/aureole", "build"]  # where a path may begin
PLACEHOLDER = re.compile(r"\S*<[\w ]+>\S*|\S*\bNAME\b\S*|\bA:B\b")
STYLES = {"PascalCase", "snake_case", "kLikeThis"}  # names of styles, written in them
TEXTS = {".h", ".cpp", ".inc", ".S", ".bib", ".py", ".pyi", ".sh", ".txt", ".toml", ".json", ".xml", ".ipynb", ".yml", ".yaml", ""}


def lines_of(text):
    return [line.strip() for line in text.splitlines() if line.strip()]


class Tree:
    def __init__(self, root):
        self.root = root
        listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True, check=False)
        files = listed.stdout.split("\n") if listed.returncode == 0 else [str(p.relative_to(root)) for p in root.rglob("*") if not {"build", ".git", ".venv"} & set(p.parts)]
        self.files = {f for f in files if f and (root / f).is_file()}
        self.folders = {str(parent) for f in self.files for parent in Path(f).parents}
        self.texts = {}
        self.words = {}
        self.tests = {}  # names of each suite
        for f in self.files:
            if Path(f).suffix not in TEXTS or (root / f).stat().st_size > 2_000_000:
                continue
            text = (root / f).read_text(encoding="utf-8", errors="ignore")
            self.texts[f] = text
            for word in set(re.findall(r"\w+", text)) | set(re.findall(r"\w+", f)):
                self.words.setdefault(word, set()).add(f)
            if Path(f).suffix in {".h", ".cpp"} and "TEST" in text:
                for suite, name in re.findall(r"\bTEST(?:_P|_F)?\(\s*(\w+)\s*,\s*(\w+)\s*\)", text):
                    self.tests.setdefault(suite, set()).add(name)

    def has_path(self, path):
        path = path.rstrip("/").removeprefix("../")
        for base in BASES:
            whole = f"{base}/{path}".lstrip("/")
            if whole in self.files or whole in self.folders:
                return True
            if any(whole + ext in self.files for ext in (".h", ".cpp", ".py")):
                return True
            if "*" in whole and any(Path(f).match(whole) for f in self.files):
                return True
        return False

    def has_test(self, suite, name):
        return any(re.fullmatch(name.replace("*", r"\w*"), n) for n in self.tests.get(suite, ()))

    def missing(self, span):
        """The parts of a span that exist nowhere."""
        missing = []
        for token in PLACEHOLDER.sub(" ", span).split():
            token = token.strip("`'\",;()[]{}:").rstrip(".")
            if not token or token in STYLES or token.startswith(("http", "build/")):
                continue
            if re.fullmatch(r"[\w.*-]+(/[\w.*-]+)+/?|\w+/", token) and not re.fullmatch(r"[\d/]+", token):
                if not self.has_path(token):
                    missing.append(token)
                continue
            if re.fullmatch(r"[\w-]+\.(md|py|cpp|h|sh|xml|json|txt|exr|toml)", token):
                if not any(Path(f).name == token for f in self.files):
                    missing.append(token)
                continue
            test = re.fullmatch(r"([A-Z]\w+)\.([A-Z]\w*\*?|\*)", token)
            if test:
                if not self.has_test(*test.groups()):
                    missing.append(token)
                continue
            member = re.fullmatch(r"(\w+)(?:::|\.)(\w+)", token)
            if member and not token[0].isdigit():
                if not self.words.get(member[1], set()) & self.words.get(member[2], set()):
                    missing.append(token)
                continue
            missing += [w for w in re.findall(r"[A-Za-z_]\w{2,}", token) if w not in self.words]
        return missing


def check_names(tree, page, text):
    text = re.sub(r"^( *)```.*?^ *```", lambda m: "\n" * m[0].count("\n"), text, flags=re.DOTALL | re.MULTILINE)
    for m in re.finditer(r"`([^`]+)`", text):
        for name in tree.missing(m[1]):
            yield f"{page}:{text[:m.start()].count(chr(10)) + 1}: `{m[1]}`: there is no {name}"


def check_blocks(tree, page, text):
    blocks = r"^ *```cpp\n(.*?)^ *```"
    for m in re.finditer(r"<!-- walk (\S+) -->(.*?)<!-- end of walk -->", text, flags=re.DOTALL):
        where = f"{page}:{text[:m.start()].count(chr(10)) + 1}"
        if m[1] not in tree.texts:
            yield f"{where}: there is no {m[1]}"
            continue
        shown = [line for b in re.findall(blocks, m[2], flags=re.DOTALL | re.MULTILINE) for line in lines_of(b)]
        real = lines_of(tree.texts[m[1]])
        for a, b in zip(shown + [None], real + [None]):
            if a != b:
                yield f"{where}: the walk has {a!r} where {m[1]} has {b!r}"
                break
    for m in re.finditer(rf"<!-- from (\S+) -->\s*?\n{blocks}", text, flags=re.DOTALL | re.MULTILINE):
        if "\n".join(lines_of(m[2])) not in "\n".join(lines_of(tree.texts.get(m[1], ""))):
            yield f"{page}:{text[:m.start()].count(chr(10)) + 1}: this block does not stand in {m[1]}"


def check_records(root):
    folder = root / "docs/decisions"
    index = (folder / "README.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^(\| \[\d{4}\]\(([^)]+)\) .*)$", index, flags=re.MULTILINE))
    rows = {name: row.replace("\\|", "|") for row, name in rows.items()}
    for record in sorted(folder.glob("[0-9]*.md")):
        text = record.read_text(encoding="utf-8")
        m = re.match(r"# (\d{4}): (.+)\n\n\*\*Date:\*\* (.+)\n\n\*\*Status:\*\* (.+)\n", text)
        if not m or m[1] != record.name[:4]:
            yield f"docs/decisions/{record.name}: the head is not number, title, date and status"
        elif not rows.pop(record.name, "").startswith(f"| [{m[1]}]({record.name}) | {m[2]} | {m[3]} | {m[4]} |"):
            yield f"docs/decisions/README.md: the row of {m[1]} is missing or has another title, date or status"
    for name in rows:
        yield f"docs/decisions/README.md: there is no {name}"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    tree = Tree(root)
    problems = []
    pages = sorted(str(p.relative_to(root)) for pattern in PAGES for p in root.glob(pattern))
    for page in pages:
        text = (root / page).read_text(encoding="utf-8")
        problems += check_names(tree, page, text)
        problems += check_blocks(tree, page, text)
    problems += check_records(root)
    version = re.search(r'kVersion = "([^"]+)"', (root / "src/aureole/core/version.h").read_text(encoding="utf-8"))[1]
    if f"\nversion: {version}\n" not in (root / "CITATION.cff").read_text(encoding="utf-8"):
        problems.append(f"CITATION.cff: the version is not {version}")
    print("\n".join(problems) if problems else f"{len(pages)} pages agree with the source")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
