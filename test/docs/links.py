#!/usr/bin/env python3
"""links.py FOLDER | links.py --install CMAKE BUILD_DIR: checks that every relative link of the pages
(*.md) below FOLDER leads to a file or folder in FOLDER, and to a heading if the link names one.
--install checks the installed documentation in the same way.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```.*?^```$", re.M | re.S)
LINK = re.compile(r"\]\(([^)\s]+)\)")
ELSEWHERE = re.compile(r"[a-z]+:")


def headings(text):
    """Returns the anchors of the headings: lower case, a dash for a space, no punctuation."""
    names = re.findall(r"^#+ (.*)$", BLOCK.sub("", text), re.M)
    return {re.sub(r"[^\w -]", "", name.lower()).strip().replace(" ", "-") for name in names}


def complaints(page, root):
    for link in LINK.findall(BLOCK.sub("", page.read_text())):
        if ELSEWHERE.match(link):
            continue
        path, _, heading = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.is_relative_to(root) or not target.exists():
            yield f"{page.relative_to(root)}: {link}: there is no such file"
        elif heading and heading not in headings(target.read_text()):
            yield f"{page.relative_to(root)}: {link}: there is no such heading"


def check(root):
    root = root.resolve()
    pages = sorted(root.rglob("*.md"))
    found = [each for page in pages for each in complaints(page, root)]
    print(f"{len(pages)} pages")
    print("\n".join(found), file=sys.stderr)
    return 1 if found or not pages else 0


def main():
    if sys.argv[1] != "--install":
        return check(pathlib.Path(sys.argv[1]))
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([sys.argv[2], "--install", sys.argv[3], "--component", "doc", "--prefix", name],
                       check=True, stdout=subprocess.DEVNULL)
        return check(pathlib.Path(name) / "share/doc")


if __name__ == "__main__":
    sys.exit(main())
