#!/usr/bin/env python3
"""Fails on a C++ file of more than 500 lines, and outside tests on a function of more than 60 lines
without a reason. A reason is a comment `Long function: why` in the lines directly above the function. Expects text
formatted by clang-format: the last `}` of a definition is in the column in which its first line begins."""

import pathlib
import re
import subprocess
import sys

FUNCTION_LINES_MAX = 60
FILE_LINES_MAX = 500
# Keywords of statements and types with braces, which are not function definitions.
NO_FUNCTION = re.compile(r"^(if|for|while|switch|do|else|namespace|class|struct|enum|union|case|default|try|catch|extern|return|using)\b")
LAMBDA = re.compile(r"\[[^\]]*\](\s*\(|\s*\{|\s*mutable)")
HEAD = re.compile(r"^[\w~:<>,*&\[\]()\s\"=.!+\-/|^%]*\)[\w\s&:(){},.<>*]*\{$")


def blank(text):
    """Returns the text with comments and the content of literals replaced by blanks."""
    pattern = r'R"(\w*)\((?:.|\n)*?\)\1"|//[^\n]*|/\*(?:.|\n)*?\*/|"(?:[^"\\\n]|\\.)*"|(?<!\d)\'(?:[^\'\\\n]|\\.)\''
    return re.sub(pattern, lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def functions(text):
    """Yields (first line, last line), from 1, of each function definition."""
    lines = blank(text).split("\n")
    begin = None  # first line of the declaration that is being read
    for i, line in enumerate(lines):
        stripped = line.strip()
        if not stripped:
            continue
        if begin is None:
            begin = i
        if stripped.endswith("{"):
            head = " ".join(each.strip() for each in lines[begin : i + 1])
            first = lines[begin]
            indent = len(first) - len(first.lstrip())
            is_function = "(" in head and not NO_FUNCTION.match(head) and not LAMBDA.search(head) and "= {" not in head
            if is_function and HEAD.match(head):
                last = next((j for j in range(i + 1, len(lines))
                             if re.match(r"\s{%d}\}" % indent, lines[j])), i)
                yield begin + 1, last + 1
            begin = None
        elif stripped.endswith((";", "}", ":", "},")) or stripped.startswith("#"):
            begin = None


def has_reason(lines, first):
    i = first - 2
    while i >= 0 and lines[i].lstrip().startswith(("//", "template")):
        if re.search(r"\bLong function: \S", lines[i]):
            return True
        i -= 1
    return False


def main(root):
    faults = []
    listed = subprocess.run(["git", "ls-files", "-z", "*.hpp", "*.cpp"], cwd=root, check=True,
                            capture_output=True, text=True).stdout.split("\0")
    for name in filter(None, listed):
        path = pathlib.Path(root, name)
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8")
        lines = text.split("\n")
        if len(lines) - 1 > FILE_LINES_MAX:
            faults.append(f"{name}: {len(lines) - 1} lines; the limit is {FILE_LINES_MAX}")
        if name.startswith("test/"):
            continue
        for first, last in functions(text):
            if last - first + 1 > FUNCTION_LINES_MAX and not has_reason(lines, first):
                faults.append(f"{name}:{first}: a function of {last - first + 1} lines; the limit is {FUNCTION_LINES_MAX}"
                              " without a comment `Long function: why` above it")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
