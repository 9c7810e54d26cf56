#!/usr/bin/env python3
"""play_pace.py [LOG [ROUNDS]]: measures the timing errors of `vantage log play` and lcm-logplayer.

Both play the same log in turn, ROUNDS times each (3), to a socket with time stamps of the kernel. The
delay of an event is its arrival time minus its logged time; its error is its delay minus the median delay
of the run. The drift of a run is the median delay of its last tenth minus that of its first tenth. LOG: the
first 15 s of the sample unless given. BIN: the folder of the programs, build/release/bin unless set. Runs in
a separate network namespace and leaves no files behind.
"""
import os
import pathlib
import socket
import statistics
import struct
import subprocess
import sys
import tempfile

GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
SO_TIMESTAMPNS = 35
SHORT, FRAGMENT = 0x4C433032, 0x4C433033
ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("BIN", ROOT / "build/release/bin")).resolve()


def event_times_us(path):
    """Returns the times in us at which the events of a log were received, in the log's order."""
    log, at, times = pathlib.Path(path).read_bytes(), 0, []
    while at + 28 <= len(log):
        _, _, utime, channel, size = struct.unpack_from(">IqqII", log, at)
        times.append(utime)
        at += 28 + channel + size
    return times


def arrivals_us(command, count):
    """Runs a player. Returns the arrival times in us of its messages by sequence number."""
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    receiver.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    receiver.bind((GROUP, PORT))
    receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                   socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1"))
    receiver.settimeout(0.2)
    player = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    arrived = {}
    while len(arrived) < count:
        try:
            packet, ancillary, _, _ = receiver.recvmsg(65536, 64)
        except socket.timeout:
            if player.poll() is not None:
                break
            continue
        magic, sequence = struct.unpack_from(">II", packet)
        fragment = struct.unpack_from(">H", packet, 16)[0] if magic == FRAGMENT else 0
        if magic in (SHORT, FRAGMENT) and fragment == 0:
            seconds, nanoseconds = struct.unpack("qq", ancillary[0][2][:16])
            arrived[sequence] = seconds * 1e6 + nanoseconds / 1e3
    player.wait()
    receiver.close()
    return arrived


def quantile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))]


def row(name, run, logged, arrived):
    first = min(arrived)
    offsets = [arrived[each] - logged[each - first] for each in sorted(arrived)]
    middle = statistics.median(offsets)
    errors = [abs(each - middle) for each in offsets]
    tenth = max(1, len(offsets) // 10)
    drift = statistics.median(offsets[-tenth:]) - statistics.median(offsets[:tenth])
    cells = [name, run, f"{len(arrived)} of {len(logged)}"]
    cells += [f"{quantile(errors, share):.0f}" for share in (0.5, 0.95, 0.99, 1.0)]
    print("| " + " | ".join(map(str, cells + [f"{drift:.0f}"])) + " |", flush=True)


def main():
    if "PACE_INSIDE" not in os.environ:
        os.environ["PACE_INSIDE"] = "yes"
        inside = str(ROOT / "test/integration/in_network.sh")
        os.execv(inside, [inside, sys.executable, str(pathlib.Path(__file__).resolve())]
                 + sys.argv[1:])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    vantage = str(BIN / "vantage")
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 1:
            log = sys.argv[1]
        else:
            whole, log = f"{folder}/whole.lcmlog", f"{folder}/part.lcmlog"
            with open(whole, "wb") as out:
                subprocess.run(["xz", "-dkc", str(ROOT / "logs/sample/lab_60s.lcmlog.xz")],
                               stdout=out, check=True)
            subprocess.run([vantage, "log", "slice", whole, log, "--to-s", "15"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        logged = event_times_us(log)
        print("| player | run | messages | p50 µs | p95 | p99 | worst | drift µs |\n|---|---|---|---|---|---|---|---|")
        for run in range(1, rounds + 1):
            row("vantage log play", run, logged,
                arrivals_us([vantage, "log", "play", log, "--url", URL, "--json"], len(logged)))
            row("lcm-logplayer", run, logged,
                arrivals_us(["lcm-logplayer", "-l", URL, log], len(logged)))


if __name__ == "__main__":
    main()
