#!/usr/bin/env python3
"""run_commands.py BIN_DIR SOURCE_DIR: what README.md and docs/*.md tell people to type.

Every line of a fenced block that begins with `vantage` must name a command that exists, with flags
that its --help knows. Every block below the line `<!-- run -->` is run as it stands, by `sh -e` in a
folder of its own that has config/ and logs/ in it, with BIN_DIR in its PATH.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

RUN = "<!-- run -->"
TIMEOUT_S = 120
BLOCK = re.compile(r"^(?P<mark>" + RUN + r"\n+)?```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)


def words_of(line):
    """The command in a line, without its comment and what follows a pipe or an operator."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|;&><()")
    lexer.whitespace_split = True
    words = []
    for word in lexer:
        if word[0] in "|;&><()":
            break
        words.append(word)
    return words


class Vantage:
    def __init__(self, program):
        self.program = program
        self.helps = {}

    def help_of(self, path):
        """What `vantage PATH --help` prints; None when there is no such command."""
        if path not in self.helps:
            done = subprocess.run([self.program, *path, "--help"], capture_output=True, text=True)
            self.helps[path] = done.stdout if done.returncode == 0 else None
        return self.helps[path]

    def complaints(self, words):
        path = tuple(words[1:2])
        if path == ("log",) and len(words) > 2 and not words[2].startswith("-"):
            path += (words[2],)
        if path and path[0].startswith("-") or any(word.isupper() for word in path):
            return []  # `vantage --help`, `vantage COMMAND`
        known = self.help_of(path)
        if known is None:
            return [f"there is no 'vantage {' '.join(path)}'"]
        flags = [word.split("=")[0] for word in words if word.startswith("--")]
        return [f"'vantage {' '.join(path)}' knows no {flag}" for flag in flags
                if not re.search(re.escape(flag) + r"\b", known)]


def run_block(text, binaries, source):
    with tempfile.TemporaryDirectory() as folder:
        for name in ("config", "logs"):
            os.symlink(source / name, pathlib.Path(folder) / name)
        environment = dict(os.environ, PATH=f"{binaries}:{os.environ['PATH']}")
        done = subprocess.run(["sh", "-e", "-c", text], cwd=folder, env=environment, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=TIMEOUT_S)
        return [] if done.returncode == 0 else [f"exit code {done.returncode}:\n{done.stdout}"]


def main():
    binaries, source = (pathlib.Path(each).resolve() for each in sys.argv[1:3])
    vantage = Vantage(str(binaries / "vantage"))
    complaints, lines, blocks = [], 0, 0
    for page in [source / "README.md", *sorted((source / "docs").rglob("*.md"))]:
        text = page.read_text()
        for block in BLOCK.finditer(text):
            if block["language"] not in ("", "sh"):
                continue
            at = f"{page.relative_to(source)}:{text[:block.start()].count(chr(10)) + 1}"
            found = []
            for line in block["text"].replace("\\\n", " ").splitlines():
                if line.startswith(("vantage ", "build/release/bin/vantage ")):
                    lines += 1
                    found += vantage.complaints(words_of(line))
            if block["mark"]:
                blocks += 1
                found += run_block(block["text"], binaries, source)
            complaints += [f"{at}: {each}" for each in found]
    print(f"{lines} command lines looked up, {blocks} blocks run")
    print("\n".join(complaints), file=sys.stderr)
    return 1 if complaints or lines == 0 or blocks == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
