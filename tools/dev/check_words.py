#!/usr/bin/env python3
"""check_words.py ROOT: fails on wording that docs/reference/words.md lists under "Wording to avoid", in
comments and pages.

A line that is right has an entry in tools/dev/words_allowed.tsv: path, a part of the line, the reason. An
entry that no line needs is a fault, too. Files in SKIPPED are generated from other texts, or inputs that must
not change.
"""
import pathlib
import re
import subprocess
import sys

SKIPPED = ("docs/results/faults", "docs/reference/commands.md", "test/data/releases/0", "test/guard/scenarios/")
COMMENT = {".cpp": "//", ".hpp": "//", ".h": "//", ".js": "//", ".mjs": "//", ".lcm": "//",
           ".py": "#", ".sh": "#", ".cmake": "#", ".yaml": "#"}
ROW = re.compile(r"^\| `(?P<pattern>[^`]+)` \| (?P<instead>[^|]+) \|$")
PEOPLE = re.compile(r"\b(person|people|operator|pilot|user|reader|student|author|someone|somebody|attacker|stranger|pilot|hand|lab)s?\b", re.I)
CODE = re.compile(r"`[^`]*`")


def patterns(page):
    """The table under "Wording to avoid": compiled pattern and the wording to use instead."""
    text = page.read_text().partition("## Wording to avoid")[2].partition("\n## ")[0]
    rows = (ROW.match(line) for line in text.splitlines())
    return [(re.compile(row["pattern"].replace("\\|", "|"), re.I), row["instead"].strip()) for row in rows if row]


def text_of(path, line):
    """The part of a line that people read, or nothing."""
    if path.suffix == ".md":
        return line
    mark = COMMENT.get(path.suffix, "#" if path.name == "CMakeLists.txt" else None)
    start = line.find(mark) if mark else -1
    return line[start:].lstrip("/#! <") if start >= 0 else ""


def faults_of(path, number, line, avoid):
    text = CODE.sub("", text_of(path, line))
    for pattern, instead in avoid:
        found = pattern.search(text)
        if found and not (found[0].lower() in ("who", "nobody") and PEOPLE.search(text)):
            yield f"{path}:{number}: '{found[0]}'; write {instead}: {text.strip()[:90]}"


def main():
    root = pathlib.Path(sys.argv[1])
    avoid = patterns(root / "docs" / "reference" / "words.md")
    if not avoid:
        sys.exit("check_words: docs/reference/words.md has no table under 'Wording to avoid'")
    allowed = [line.split("\t") for line in (root / "tools/dev/words_allowed.tsv").read_text().splitlines() if line]
    used = set()
    faults = []
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=root, check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        path = root / name
        if name.startswith(SKIPPED) or not path.is_file() or (path.suffix not in {".md", *COMMENT} and path.name != "CMakeLists.txt"):
            continue
        if name == "docs/reference/words.md":
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            for fault in faults_of(pathlib.Path(name), number, line, avoid):
                entry = next((i for i, (where, part, _) in enumerate(allowed) if where == name and part in line), None)
                used.add(entry)
                if entry is None:
                    faults.append(fault)
    faults += [f"tools/dev/words_allowed.tsv: unused entry: {' '.join(each[:2])}"
               for i, each in enumerate(allowed) if i not in used]
    print("\n".join(faults))
    sys.exit(f"{len(faults)} texts to rewrite (docs/reference/words.md)" if faults else 0)


if __name__ == "__main__":
    main()
