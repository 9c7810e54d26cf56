#!/usr/bin/env python3
"""signals.py VANTAGE SAMPLE.xz SCENARIO PROBLEM: sends SIGINT, SIGTERM and SIGHUP to commands while they work.

Each command must soon end, keep its results so far and report this; no output may be incomplete. "Soon"
is half a second on an idle machine. The test limits the CPU time instead, to much less than the
whole work needs.
"""
import json
import math
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PATIENCE_S = 60
CPU_S = 1.5  # s; CPU time after the signal; two threads may run


def cpu_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def interrupted(words, folder, is_at_work, which):
    """Returns (exit code, stdout, stderr) of a command that receives the signal while it works."""
    with subprocess.Popen(words, cwd=folder, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            after_s = end(process, is_at_work, which)
        finally:
            process.kill()  # only if the process does not end
        said, warned = process.communicate()
    assert after_s < CPU_S, f"{words}: {after_s} s of CPU after the signal"
    return process.returncode, said, warned


def end(process, is_at_work, which):
    """Returns the CPU seconds that a process takes to end after a signal that arrives while it works."""
    give_up = time.monotonic() + PATIENCE_S
    while not is_at_work(process):
        assert process.poll() is None, f"{process.args} has ended: {process.communicate()}"
        assert time.monotonic() < give_up, f"{process.args} does not begin"
        time.sleep(0.01)
    before_s = after_s = cpu_s(process.pid)
    process.send_signal(which)
    give_up = time.monotonic() + PATIENCE_S
    while process.poll() is None:
        try:
            after_s = cpu_s(process.pid)
        except (FileNotFoundError, IndexError):
            pass
        assert time.monotonic() < give_up, f"{process.args} does not end"
        time.sleep(0.01)
    return after_s - before_s


def has_worked(seconds):
    return lambda process: cpu_s(process.pid) > seconds


def grown(path, size_bytes):
    return lambda process: path.exists() and path.stat().st_size > size_bytes


def check_log(vantage, path):
    done = subprocess.run([vantage, "log", "check", path], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def descendants(pid):
    """Returns the ids of all descendants of a process."""
    children = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(path.read_text().rsplit(")", 1)[1].split()[1])
        except (OSError, IndexError):
            continue  # the process has ended in the meantime
        children.setdefault(parent, []).append(int(path.parent.name))
    found = []
    waiting = [pid]
    while waiting:
        of_one = children.get(waiting.pop(), [])
        found += of_one
        waiting += of_one
    return found


BROWSER = f"""#!{sys.executable}
import os, time
folder = os.environ["TMPDIR"]
if os.fork() > 0:
    open(folder + "/begun", "w").close()
    time.sleep({PATIENCE_S})
else:
    give_up = time.monotonic() + {PATIENCE_S}
    while time.monotonic() < give_up:
        try:
            os.makedirs(folder, exist_ok=True)
            open(folder + "/profile", "w").close()
        except OSError:
            pass  # it is being removed
"""


def check_folder_of_record(vantage, folder):
    """No file remains, although a browser's child processes write files into their folder until they are ended."""
    kept = folder / "kept_by_children"
    kept.mkdir()
    browser = folder / "browser"
    browser.write_text(BROWSER)
    browser.chmod(0o755)
    words = ["env", f"TMPDIR={kept}", f"CHROMIUM={browser}", vantage, "view", folder / "flight.lcmlog",
             "--record", folder / "flight.webm"]
    code, said, warned = interrupted(words, folder, lambda _: list(kept.glob("*/begun")), signal.SIGINT)
    assert code == 1 and "interrupted: the video is incomplete" in said, (code, said, warned)
    assert not list(kept.iterdir()), list(kept.iterdir())


def check_record(vantage, folder):
    """An incomplete video is removed, and neither its browser nor the browser's files remain."""
    if not shutil.which(os.environ.get("CHROMIUM", "chromium")):
        print("signals: no chromium, so no video is interrupted")
        return
    kept = folder / "kept"
    kept.mkdir()
    video = folder / "flight.webm"
    words = ["env", f"TMPDIR={kept}", vantage, "view", folder / "flight.lcmlog", "--record", video]
    done = subprocess.run([*words, "--from-s", "20", "--to-s", "20.1"], capture_output=True, text=True)
    if "was not built" in done.stderr:
        print("signals: no page, so no video is interrupted")
        return
    assert done.returncode == 0 and video.stat().st_size > 0, done
    video.unlink()
    check_folder_of_record(vantage, folder)
    browser = set()

    def is_drawing(process):
        pids = descendants(process.pid)
        browser.update(pids)
        used_s = 0.0
        for pid in pids:
            try:
                if b"--type=renderer" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes():
                    used_s += cpu_s(pid)
            except (OSError, IndexError):
                pass  # the process has ended in the meantime
        return used_s > 1.0

    for which in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        browser.clear()
        code, said, warned = interrupted(words, folder, is_drawing, which)
        assert code == 1 and "interrupted: the video is incomplete" in said, (code, said, warned)
        assert not video.exists()
        give_up = time.monotonic() + PATIENCE_S
        while any(pathlib.Path(f"/proc/{pid}").exists() for pid in browser):
            assert time.monotonic() < give_up, "the browser still runs after the recording"
            time.sleep(0.01)
        assert not list(kept.iterdir()), list(kept.iterdir())


def main():
    vantage, sample, scenario, problem = (str(pathlib.Path(each).resolve()) for each in sys.argv[1:5])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        flight = subprocess.run(["xz", "-dkc", sample], capture_output=True, check=True).stdout
        (folder / "flight.lcmlog").write_bytes(flight)

        # A search with a budget of one day prints its best plan. (It prepares its memory within 4 s
        # of CPU time.)
        for which in (signal.SIGINT, signal.SIGTERM):
            code, said, _ = interrupted(
                [vantage, "plan", problem, "--budget-s", "86400", "--algorithm", "beam", "--json"],
                folder, has_worked(4.0), which)
            assert said, f"ended by the signal without output: {code}"
            plan = json.loads(said)
            assert code == 1 and plan["stop_reason"] == "interrupted", (code, said)
            assert plan["found"] and plan["controls"], said

        # A trial also ends when its terminal is closed; its log is complete.
        log = folder / "trial.lcmlog"
        for which in (signal.SIGHUP, signal.SIGTERM):
            code, said, warned = interrupted(
                [vantage, "trial", scenario, "--duration-s", "86400", "--nodes", "300", "--log",
                 log, "--json"], folder, grown(log, 100_000), which)
            assert code == 1 and json.loads(said)["duration_s"] > 0, said
            assert "trial stopped after" in warned, warned
            check_log(vantage, log)
            log.unlink()

        demo = folder / "demo/lab.lcmlog"
        code, said, _ = interrupted(
            [vantage, "demo", "--scenario", scenario, "--duration-s", "300", "--out", folder / "demo",
             "--json"], folder, grown(demo, 50_000), signal.SIGHUP)
        assert code == 0 and json.loads(said)["duration_s"] > 0, (code, said)
        check_log(vantage, demo)

        # The file of an interrupted export is valid up to the interruption.
        part = folder / "flight.mcap.part"
        many = folder / "many.lcmlog"
        subprocess.run([vantage, "log", "merge", *[folder / "flight.lcmlog"] * 12, "--out", many],
                       check=True, stdout=subprocess.DEVNULL)
        code, said, warned = interrupted(
            [vantage, "log", "export", many, "--to", "mcap", "--out", folder / "flight.mcap"], folder,
            grown(part, 1 << 20), signal.SIGINT)
        assert code == 1 and "interrupted" in warned, (code, warned)
        whole = (folder / "flight.mcap").read_bytes()
        assert whole[:8] == whole[-8:] and not part.exists()
        code, said, warned = interrupted(
            [vantage, "log", "export", many, "--to", "csv", "--raw", "--out", folder / "csv"], folder,
            grown(folder / "csv/TRUTH.csv", 100_000), signal.SIGTERM)
        assert code == 1 and "interrupted" in warned, (code, warned)
        assert all(path.read_bytes().endswith(b"\n") for path in (folder / "csv").iterdir())

        check_record(vantage, folder)

        # A command that has printed nothing yet ends immediately.
        way = [(0.01 * k, 20 * math.cos(1e-3 * k), 15 * math.sin(1e-3 * k)) for k in range(400_000)]
        (folder / "way.csv").write_text(
            "time_s,x_m,y_m\n" + "".join("%f,%f,%f\n" % row for row in way))
        (folder / "ranges.csv").write_text("time_s,beacon_id,range_m\n" + "".join(
            f"{t},A,{math.hypot(x - 9, y - 30) + 0.2 * math.sin(1e3 * t)}\n" for t, x, y in way))
        for which in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            code, said, _ = interrupted(
                [vantage, "log", "fit-ranges", "ranges.csv", "--poses", "way.csv"], folder,
                has_worked(0.3), which)
            assert code == -which and not said, (code, said)

        # The doctor reports what it has received. Here a server accepts the connection and sends nothing.
        with socket.create_server(("127.0.0.1", 0)) as silent:
            code, said, warned = interrupted(
                [vantage, "doctor", "vicon", "127.0.0.1", "--port", str(silent.getsockname()[1]),
                 "--udp-port", "51999", "--listen-s", "60"], folder,
                lambda process: silent.accept() is not None, signal.SIGINT)
        assert code == 1 and "127.0.0.1" in said and "interrupted" in warned, (said, warned)

        # An experiment keeps finished units and prints how to continue; the same command continues it.
        results = folder / "my results"
        rows = results / "rows"
        words = [vantage, "experiment", "tracking-noise", "--trials", "50", "--out", results]
        code, said, warned = interrupted(
            words, folder, lambda process: has_worked(3.0)(process) and rows.exists(),
            signal.SIGTERM)
        assert code == 1 and "rows are kept. To continue: vantage experiment" in warned, warned
        assert f"--out '{results}'" in warned, warned
        for path in rows.iterdir():
            text = path.read_text()
            assert text.endswith("\n") and all(json.loads(line) for line in text.splitlines())
    print("signals: all good")


if __name__ == "__main__":
    sys.exit(main())
