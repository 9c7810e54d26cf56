#!/usr/bin/env python3
"""misuse.py VANTAGE SAMPLE.xz CONFIG_DIR PROBLEM: tests mistakes of users, which are listed in tables.

Every command that reads a file gets one that is missing, a folder, empty, incomplete, of another kind and
huge. Every command that writes gets an output path in a missing folder, below a file, without write
permission and on a full disk. Output goes into a closed pipe; options and commands are mistyped. Each
command must end with the exit code in the table and must not crash. With code 2 it must print one line that
names the file (or the word) and the rule. Files that existed before must exist afterwards.
"""
import math
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

TIMEOUT_S = 240  # under a sanitizer, next to other tests, a huge file takes longer than 60 s
HUGE_BYTES = 3 << 30  # sparse: takes no disk space
FULL_DISK_BYTES = 20_000  # a limit on the size of files emulates the full disk

SCENARIO = [
    "check {}", "trial {} --duration-s 1 --nodes 20", "up {} --no-log --duration-s 1",
    "demo --scenario {} --duration-s 1 --out demo-x", "console {}"]
PROBLEM = ["plan {} --nodes 100"]
TABLE = [
    "log fit-ranges {} --poses way.csv", "log fit-ranges ranges.csv --poses {}",
    "log fit-ranges ranges.csv --poses way.csv --beacons {}"]
# Commands that read a log. Exit codes for an empty log, a truncated log, a foreign file (a picture), and a
# log with other channels.
LOG = {
    "log info {}": (0, 0, 0, 0),
    "log check {}": (0, 1, 1, 0),
    "log repair {} new.lcmlog": (0, 0, 0, 0),
    "log slice {} new.lcmlog --from-s 1": (0, 0, 0, 0),
    "log filter {} new.lcmlog --channels NOPE": (2, 2, 2, 2),
    "log filter {} new.lcmlog --without NOPE": (0, 0, 0, 0),
    "log rename {} new.lcmlog --rule A=B": (0, 0, 0, 0),
    "log merge {} {} --out new.lcmlog": (0, 0, 0, 0),
    "log metrics {}": (2, 0, 2, 2),
    "log plot {} --out new.png": (2, 0, 2, 2),
    "log fit-ranges {}": (2, 2, 2, 2),  # the truncated log has too few ranges
    "log localize {}": (2, 2, 2, 2),  # no log has the section localizer
    "log fit-sensor {}": (2, 2, 2, 2),
    "log import mrclam {} new.lcmlog": (2, 2, 2, 2),  # no folder
    "log replay {} --node planner:Q1": (2, 0, 2, 2),
    "log export {} --to csv --out new-csv": (0, 0, 0, 1),
    "log export {} --to mcap --out new.mcap": (0, 0, 0, 1),
    "log play {} --url memq:// --speed 64 --to-s 1": (0, 0, 0, 0),
    "view {} --port 0": (2, None, 2, 2),  # a truncated log is shown until Ctrl-C
}
# The output option of each command, and its valid input if it needs one: {i} log, {s} scenario, {p}
# problem.
WRITERS = {
    "log repair {i} {o}": "x.lcmlog", "log slice {i} {o} --to-s 20": "x.lcmlog",
    "log filter {i} {o} --channels TRUTH": "x.lcmlog", "log rename {i} {o} --rule A=B": "x.lcmlog",
    "log merge {i} {i} --out {o}": "x.lcmlog", "log plot {i} --out {o}": "x.png",
    "log export {i} --to csv --out {o}": "csv", "log export {i} --to mcap --out {o}": "x.mcap",
    "log fit-ranges ranges.csv --poses way.csv --out {o}": "x.svg",
    "log import mrclam set {o}": "x.lcmlog", "log localize set --out {o}": "x.lcmlog",
    "log localize set --csv {o}": "x.csv",
    "plan {p} --nodes 1000 --svg {o}": "x.svg", "config copy lab {o}": "x.yaml",
    "trial {s} --duration-s 2 --nodes 20 --log {o}": "x.lcmlog",
    "trial {s} --duration-s 2 --nodes 20 --svg {o}": "x.svg",
    "demo --scenario {s} --duration-s 1 --out {o}": "demo",
    "experiment dls-savings --smoke --out {o}": "results"}
WORDS = {  # mistyped word: text that the error line must contain
    "trail x": "did you mean 'trial'", "log inof x": "did you mean 'info'", "nonsense": "available: ",
    "trial x --sead 3": "did you mean '--seed'", "trial x --seed -1": "whole number from 0",
    "trial x --seed 18446744073709551616": "whole number from 0", "trial x --seed 1.5": "whole number",
    "trial x --duration-s abc": "'abc' is not a number", "trial x --duration-s nan": "not a number",
    "trial x --duration-s -3": "above 0", "plan x --budget-s 1e9": "from 0 to 86400",
    "doctor viccon localhost": "viccon", "config copy labb": "did you mean 'lab'",
    "experiment nope": "nope", "experiment hardware --planning-share 0": "from 1e-06 to 1",
    "experiment dls-savings --planning-share 0.2": "experiment dls-savings has no planning time to reduce", "log export x --to docx --out y": "docx",
    "log plot x --out y.docx": ".png, .svg or .pdf", "log fit-rang x": "did you mean 'fit-ranges'",
    "log fit-ranges ranges.csv": "expected --poses", "log fit-ranges x --gap-max-s 0": "above 0",
    "log fit-ranges ranges.csv --poses way.csv --robot Q1": "--robot is only for a log",
    "log fit-ranges ranges.csv --poses words.csv": "words.csv:3: x 'far'; expected a number",
    "log fit-ranges way.csv --poses way.csv": "way.csv:1: no column 'beacon'",
    "log import mrclan x y": "did you mean 'mrclam'", "log localize set --start far": "known",
    "log localize set --loss 2": "from 0 to 1", "log localize set --heading R9": "no robot 'R9'",
    "log localize set --smoothed --late-s 3": "exclude each other",
    "log localize set --scenario lab.yaml": "lab.yaml: has no section localizer",
    "log import mrclam folder x.lcmlog": "folder/Barcodes.dat: cannot be read",
    "log fit-ranges flight.lcmlog --robot Q9": "no robot 'Q9'", "view --port 99999": "65535",
    "plan typo.json": "typo.json:8: tua: unknown key; did you mean tau?",
    "plan typo.json.value": "typo.json.value:8: tau: must be above 0 and at most 3600, is -1",
    "plan torn.json": "not JSON: ", "plan empty": "empty:1: empty file; expected a planning problem",
    "check typo.yaml": "world.sealing_m: unknown key; did you mean ceiling_m?",
    "view x --types none.lcm": "none.lcm: cannot be read", "view x --record y.webm --fps 0": "1 to 60"}

failures = []


class Place:
    def __init__(self, vantage, folder):
        self.vantage, self.folder = vantage, folder

    def run(self, line, stdout=subprocess.PIPE, limit=None):
        def limited():
            if limit:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        try:
            return subprocess.run([self.vantage, *line.split()], cwd=self.folder, text=True,
                                  stdin=subprocess.DEVNULL, stdout=stdout, errors="replace",
                                  stderr=subprocess.PIPE, timeout=TIMEOUT_S,
                                  preexec_fn=limited, restore_signals=not limit)
        except subprocess.TimeoutExpired:
            failures.append(f"'{line}' does not end")
            return None

    def expect(self, line, codes, names="", limit=None):
        done = self.run(line, limit=limit)
        if done is None:
            return
        said = f"'{line}': exit code {done.returncode}:\n{done.stdout}{done.stderr}"
        if done.returncode not in codes:
            failures.append(f"want {codes}, {said}")
        if done.returncode != 0 and names not in done.stderr + done.stdout:
            failures.append(f"'{names}' is not named, {said}")
        lines = [each for each in done.stderr.splitlines() if each]
        # `check` lists at most ten mistakes of a file and their number.
        is_list = 2 < len(lines) <= 11 and re.match(r"\d+ mistakes", lines[-1])
        if done.returncode == 2 and len(lines) != 1 and not is_list and "Run with --help" not in done.stderr:
            failures.append(f"{len(lines)} lines, {said}")
        for word in ("terminate called", "filesystem error", "json.exception", "basic_string"):
            if word in done.stderr:
                failures.append(said)


def foreign_log():
    """Returns an LCM log of 50 events of an unknown type."""
    out = b""
    for number in range(50):
        channel, data = b"POSE_BODY", bytes(range(40))
        out += (0xEDA1DA01).to_bytes(4, "big") + number.to_bytes(8, "big")
        out += (1_700_000_000_000_000 + number * 1000).to_bytes(8, "big")
        out += len(channel).to_bytes(4, "big") + len(data).to_bytes(4, "big") + channel + data
    return out


def fill(folder, sample, problem):
    flight = subprocess.run(["xz", "-dkc", sample], capture_output=True, check=True).stdout
    (folder / "flight.lcmlog").write_bytes(flight[:len(flight) // 6])  # truncated, so that commands read it quickly
    (folder / "foreign.lcmlog").write_bytes(foreign_log())
    (folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20)
    (folder / "empty").touch()
    (folder / "folder").mkdir()
    for name in ("huge", "huge.lcmlog"):
        with open(folder / name, "wb") as file:
            file.truncate(HUGE_BYTES)
    lab = (folder / "lab.yaml").read_text()
    (folder / "torn.yaml").write_text(lab[:lab.index("robots:") + 60])
    way = [(0.5 * k, 20 * math.cos(0.05 * k), 15 * math.sin(0.05 * k)) for k in range(500)]
    (folder / "way.csv").write_text("time_s,x_m,y_m\n" + "".join("%f,%f,%f\n" % row for row in way))
    (folder / "words.csv").write_text("time_s,x_m,y_m\n0,0,0\n1,far,0\n")
    (folder / "ranges.csv").write_text("time_s,beacon_id,range_m\n" + "".join(
        f"{t},{b},{1.1 * math.hypot(x - 9 * b, y - 30) + 0.2 * math.sin(1e3 * t)}\n"
        for t, x, y in way for b in (1, 2)))
    subprocess.run([pathlib.Path(__file__).parent / "mrclam_folder.py", folder / "set", "20"], check=True)
    text = problem.read_text()
    (folder / "problem.json").write_text(text)
    (folder / "torn.json").write_text(text[:len(text) // 2])
    (folder / "typo.json").write_text(text.replace('"tau"', '"tua"'))
    (folder / "typo.json.value").write_text(text.replace('"tau": 0.5', '"tau": -1'))
    (folder / "typo.yaml").write_text(lab.replace("ceiling_m:", "sealing_m:"))


def try_inputs(place):
    for line in SCENARIO + PROBLEM:
        torn = "torn.json" if line in PROBLEM else "torn.yaml"
        other = "lab.yaml" if line in PROBLEM else "problem.json"
        for name in ("missing", "folder", "empty", torn, other, "picture.png", "huge"):
            place.expect(line.format(name), {2}, name)
    for line in TABLE:
        for name in ("missing", "folder", "empty", "torn.json", "picture.png", "huge"):
            place.expect(line.format(name), {2}, name)
    for line, (empty, torn, picture, foreign) in LOG.items():
        new = [word for word in line.split() if word.startswith("new")]
        for name, code in (("missing", 2), ("folder", 2), ("empty", empty),
                           ("flight.lcmlog", torn), ("picture.png", picture),
                           ("foreign.lcmlog", foreign)):
            if code is not None:
                place.expect(line.format(name, name), {code}, name)
            for each in new:
                subprocess.run(["rm", "-rf", each], cwd=place.folder, check=True)
    place.expect("log info huge.lcmlog", {0})
    place.expect("log check huge.lcmlog", {1}, "huge.lcmlog")


def try_outputs(place):
    inputs = {"i": "flight.lcmlog", "s": "lab.yaml", "p": "problem.json"}
    for line, name in WRITERS.items():
        makes_folders = name in ("csv", "demo", "results")
        if not makes_folders:
            place.expect(line.format(o=f"not/there/{name}", **inputs), {1, 2}, f"not/there/{name}")
        place.expect(line.format(o=f"empty/{name}", **inputs), {1, 2}, f"empty/{name}")
        stem = name.split(".")[0]  # the refused file may be the script next to a plot
        place.expect(line.format(o=f"/proc/{name}", **inputs), {1, 2}, f"/proc/{stem}")
        if "--svg" in line or "config" in line:
            continue  # too small to fill the disk
        place.expect(line.format(o=f"full-{name}", **inputs), {1, 2}, f"full-{stem}",
                     200 if name == "results" else FULL_DISK_BYTES)
        full = place.folder / f"full-{name}"
        logs = [full] if name.endswith("lcmlog") else list(full.glob("*.lcmlog"))
        for log in logs:
            if log.exists() and log.stat().st_size > 0:
                place.expect(f"log check {log}", {0})
        if list(place.folder.rglob("*.part")):
            failures.append(f"'{line}' leaves half a file")
        subprocess.run(["rm", "-rf", full], check=True)
    # Files that exist must not be lost.
    precious = place.folder / "precious"
    for line in ("log repair flight.lcmlog {}", "log export flight.lcmlog --to mcap --out {}",
                 "config copy lab {}"):
        precious.write_text("precious")
        place.expect(line.format("precious"), {2}, "precious")
        place.expect("log repair flight.lcmlog flight.lcmlog --force", {2}, "flight.lcmlog")
        assert precious.read_text() == "precious", line


def try_closed_pipe(place):
    for line in ("check lab.yaml", "log info flight.lcmlog", "log metrics flight.lcmlog --json",
                 "log fit-ranges ranges.csv --poses way.csv",
                 "plan problem.json --nodes 100", "trial lab.yaml --duration-s 1 --nodes 20"):
        read, write = os.pipe()
        os.close(read)
        done = place.run(line, stdout=write)
        os.close(write)
        if done.returncode != 1 or "standard output" in done.stderr:
            failures.append(f"closed pipe, '{line}': {done.returncode}: {done.stderr}")


def main():
    vantage, sample, config, problem = (pathlib.Path(each).resolve() for each in sys.argv[1:5])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        place = Place(vantage, folder)
        subprocess.run([vantage, "config", "copy", "lab"], cwd=folder, check=True,
                       stdout=subprocess.DEVNULL)
        assert (folder / "lab.yaml").read_bytes() == (config / "lab.yaml").read_bytes()
        fill(folder, sample, problem)
        before = {path: path.read_bytes() for path in folder.iterdir()
                  if path.is_file() and path.stat().st_size < HUGE_BYTES}
        try_inputs(place)
        try_outputs(place)
        try_closed_pipe(place)
        for line, words in WORDS.items():
            place.expect(line, {2}, words)
        for path, content in before.items():
            if path.read_bytes() != content:
                failures.append(f"{path.name} was changed")
    print("\n".join(failures), file=sys.stderr)
    print(f"{len(failures)} failures" if failures else "misuse: all good")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
