#!/usr/bin/env python3
"""run_commands.py PROGRAMS SOURCE_DIR: checks that the commands in README.md and docs/*.md work after
tools/demo. PROGRAMS lists the programs that tools/demo builds, one per line; no other programs are
available.

Every line of a fenced block that begins with `vantage` must name a program and a command that exist,
with flags that its --help lists. Every block below the line `<!-- run -->` is run as it is by `sh -e`.
Each line of a block below `<!-- run 4 s -->` is run separately in its own network. If the line still runs
after this time, it receives the signal of Ctrl-C. Every command must succeed.

Commands run in a folder that contains config/ and logs/, flight.lcmlog (the sample log, also as
demo-out/lab.lcmlog) and torn.lcmlog (a part of it that ends within an event), with the programs'
folder in PATH.
"""
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

TIMEOUT_S = 120
END_TIMEOUT_S = 20
BLOCK = re.compile(r"^(?:(?P<mark><!-- run(?: (?P<span_s>\d+) s)? -->)\n+)?"
                   r"```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)
LINE = re.compile(r"^(?:\w+\$ )?(?:build/release/bin/)?(?P<command>vantage[-\w]* .*)$")


def words_of(line):
    """Returns the command in a line, without its comment and the part after a pipe or an operator."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|;&><()")
    lexer.whitespace_split = True
    words = []
    for word in lexer:
        if word[0] in "|;&><()":
            break
        words.append(word)
    return words


class Commands:
    def __init__(self, binaries):
        self.binaries = binaries
        self.helps = {}

    def help_of(self, path):
        """Returns the output of `PATH --help`; None if there is no such program or command."""
        if path not in self.helps:
            program = self.binaries / path[0]
            self.helps[path] = None
            if program.exists():
                done = subprocess.run([program, *path[1:], "--help"], capture_output=True, text=True)
                self.helps[path] = done.stdout if done.returncode == 0 else None
        return self.helps[path]

    def complaints(self, words):
        path = tuple(words[:2]) if words[0] == "vantage" else tuple(words[:1])
        if path[1:] in (("log",), ("keys",)) and len(words) > 2 and not words[2].startswith("-"):
            path += (words[2],)
        if path[-1].startswith("-") or any(word.isupper() for word in path):
            return []  # `vantage --help`, `vantage COMMAND`
        known = self.help_of(path)
        if known is None:
            return [f"there is no '{' '.join(path)}'"]
        flags = [word.strip("[]").split("=")[0] for word in words if word.lstrip("[").startswith("--")]
        return [f"'{' '.join(path)}' knows no {flag}" for flag in flags
                if not re.search(re.escape(flag) + r"\b", known)]


def fill(folder, source):
    """Fills the folder of a run."""
    for name in ("config", "logs"):
        os.symlink(source / name, folder / name)
    unpacked = subprocess.run(["xz", "-dkc", source / "logs/sample/lab_60s.lcmlog.xz"],
                              capture_output=True, check=True)
    (folder / "flight.lcmlog").write_bytes(unpacked.stdout)
    (folder / "torn.lcmlog").write_bytes(unpacked.stdout[:2 * len(unpacked.stdout) // 3])
    (folder / "demo-out").mkdir()
    shutil.copy(folder / "flight.lcmlog", folder / "demo-out/lab.lcmlog")


def run_block(text, folder, environment):
    done = subprocess.run(["sh", "-e", "-c", text], cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=TIMEOUT_S)
    return [] if done.returncode == 0 else [f"exit code {done.returncode}:\n{done.stdout}"]


def run_for(line, span_s, folder, environment, source):
    """Runs a command until it is signalled to end; returns the problems found."""
    network = source / "test/integration/in_network.sh"
    with subprocess.Popen([network, "sh", "-c", "exec " + line], cwd=folder, env=environment,
                          text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT) as process:
        try:
            output_text, _ = process.communicate(timeout=span_s)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            try:
                output_text, _ = process.communicate(timeout=END_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                return [f"'{line}' does not end at Ctrl-C:\n{process.communicate()[0]}"]
        if process.returncode in (0, 77):
            return []
        return [f"'{line}': exit code {process.returncode}:\n{output_text}"]


def run(block, binaries, source):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        fill(folder, source)
        environment = dict(os.environ, PATH=f"{binaries}:{os.environ['PATH']}")
        if block["span_s"] is None:
            return run_block(block["text"], folder, environment)
        return [complaint
                for line in block["text"].splitlines() if LINE.match(line)
                for complaint in run_for(LINE.match(line)["command"], int(block["span_s"]), folder,
                                         environment, source)]


def lay_out(programs, folder):
    """Makes a folder with only these programs, as hard links, since they find each other by their folder."""
    for line in pathlib.Path(programs).read_text().split():
        try:
            os.link(line, folder / pathlib.Path(line).name)
        except OSError:  # on another disk
            shutil.copy2(line, folder)


def main():
    source = pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory(dir=pathlib.Path(sys.argv[1]).parent) as name:
        binaries = pathlib.Path(name)
        lay_out(sys.argv[1], binaries)
        return check_pages(binaries, source)


def check_pages(binaries, source):
    commands = Commands(binaries)
    complaints, lines, blocks = [], 0, 0
    if "--target vantage_programs\n" not in (source / "tools/demo").read_text():
        complaints.append("tools/demo does not build the target vantage_programs")
    for page in [source / "README.md", *sorted((source / "docs").rglob("*.md"))]:
        text = page.read_text()
        for block in BLOCK.finditer(text):
            if block["language"] not in ("", "sh"):
                continue
            at = f"{page.relative_to(source)}:{text[:block.start()].count(chr(10)) + 1}"
            found = []
            for line in block["text"].replace("\\\n", " ").splitlines():
                match = LINE.match(line)
                if match:
                    lines += 1
                    found += commands.complaints(words_of(match["command"]))
            if block["mark"]:
                blocks += 1
                found += run(block, binaries, source)
            complaints += [f"{at}: {each}" for each in found]
    print(f"{lines} command lines looked up, {blocks} blocks run")
    print("\n".join(complaints), file=sys.stderr)
    return 1 if complaints or lines == 0 or blocks == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
