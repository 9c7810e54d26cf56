#!/usr/bin/env python3
"""check_words.py ROOT: fails on wording that docs/reference/words.md lists under "Wording to avoid", in
comments, pages, messages (string literals of at least three words) and test names, and on titles of new
commits that are not `area: imperative phrase`.

A line that matches a pattern but is correct has an entry in tools/dev/words_allowed.tsv: path, a part of the
line, the reason. An entry without such a line is also a fault. Files in SKIPPED are generated from other texts,
or are inputs that must not change.
"""
import pathlib
import re
import subprocess
import sys

SKIPPED = ("docs/reference/faults.md", "docs/reference/wire-faults.md", "docs/reference/commands.md",
           "test/data/releases/0", "test/guard/scenarios/")
COMMENT = {".cpp": "//", ".hpp": "//", ".h": "//", ".js": "//", ".mjs": "//", ".lcm": "//",
           ".py": "#", ".sh": "#", ".cmake": "#", ".yaml": "#"}
MESSAGES = {".cpp", ".hpp", ".py", ".js", ".mjs"}
ROW = re.compile(r"^\| `(?P<pattern>[^`]+)` \| (?P<instead>[^|]+) \|$")
PEOPLE = re.compile(r"\b(person|people|operator|pilot|user|reader|student|author|someone|somebody|attacker|stranger|pilot|hand|lab)s?\b", re.I)
CODE = re.compile(r"`[^`]*`")
TEST = re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+), (\w+)\)")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
WORDS = re.compile(r"[a-z']{2,} [^ ]+ [a-z']{2,}", re.I)
FIRST_COMMIT = "fe0e1134aba7bf3c0931a0032477bd8eee6e22f8"  # titles of older commits are not checked
TITLE = re.compile(r"^[A-Za-z0-9_./,{}* -]+: [a-z`\"'{/.<-]")
TITLE_MAX = 72


def patterns(page):
    """Returns the table under "Wording to avoid": [(compiled pattern, wording to use instead)]."""
    text = page.read_text().partition("## Wording to avoid")[2].partition("\n## ")[0]
    rows = (ROW.match(line) for line in text.splitlines())
    return [(re.compile(row["pattern"].replace("\\|", "|"), re.I), row["instead"].strip()) for row in rows if row]


def texts_of(path, line):
    """Returns the parts of a line that people read: comment, test name, messages."""
    if path.suffix == ".md":
        return [line]
    mark = COMMENT.get(path.suffix, "#" if path.name == "CMakeLists.txt" else None)
    start = line.find(mark) if mark else -1
    texts = [line[start:].lstrip("/#! <")] if start >= 0 else []
    code = line if start < 0 else line[:start]
    if test := TEST.match(code):
        texts.append(" ".join(re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z0-9]+", " ".join(test.groups()))).lower())
    if path.suffix in MESSAGES and path.parts[0] != "test":
        texts += [text for text in LITERAL.findall(code) if WORDS.search(text)]
    return texts


def faults_of(path, number, line, avoid):
    for text in texts_of(path, line):
        text = CODE.sub("", text)
        for pattern, instead in avoid:
            found = pattern.search(text)
            if found and not (found[0].lower() in ("who", "nobody") and PEOPLE.search(text)):
                yield f"{path}:{number}: '{found[0]}'; write {instead}: {text.strip()[:90]}"


def faults_of_titles(root):
    """Yields a fault for each invalid title of a commit after FIRST_COMMIT; none in a copy without this history."""
    log = subprocess.run(["git", "log", "--no-merges", "--format=%h %s", f"{FIRST_COMMIT}..HEAD"], cwd=root,
                         capture_output=True, text=True)
    for line in log.stdout.splitlines() if log.returncode == 0 else []:
        commit, _, title = line.partition(" ")
        if not TITLE.match(title) or len(title) > TITLE_MAX:
            yield f"commit {commit}: the title must be `area: imperative phrase`, at most {TITLE_MAX} characters: {title}"


def main():
    root = pathlib.Path(sys.argv[1])
    avoid = patterns(root / "docs" / "reference" / "words.md")
    if not avoid:
        sys.exit("check_words: docs/reference/words.md has no table under 'Wording to avoid'")
    allowed = [line.split("\t") for line in (root / "tools/dev/words_allowed.tsv").read_text().splitlines() if line]
    used = set()
    faults = list(faults_of_titles(root))
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
