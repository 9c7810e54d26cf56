#!/usr/bin/env python3
"""switch_test.py SOURCE_DIR [--network]: test/rig/switch follows its options exactly. Without a network the
statistics of each rule are checked in virtual time. With --network, in a network namespace, the frames that leave
the cables are compared with the counts that the switch reports.
"""
import importlib.machinery
import importlib.util
import json
import math
import pathlib
import subprocess
import sys
import tempfile

FRAMES = 40_000
PERIOD_S = 0.001


def load(path):
    loader = importlib.machinery.SourceFileLoader("switch", str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("switch", loader))
    loader.exec_module(module)
    return module


SWITCH_PATH = pathlib.Path(sys.argv[1]) / "test/rig/switch"
sys.dont_write_bytecode = True
SWITCH = load(SWITCH_PATH)


def pass_through(*words, frames=FRAMES, frame_bytes=100, direction=(1, 2)):
    """Returns (link, [(time sent, time received, number, frame)]) of frames that are sent one period apart."""
    options = SWITCH.options_parser().parse_args(list(words))
    link = SWITCH.links_between(options, [1, 2])[direction]
    out = []
    for number in range(frames):
        frame = number.to_bytes(4, "big").rjust(frame_bytes, b"\0")
        for when, what in link.offer(number * PERIOD_S, frame):
            out.append((number * PERIOD_S, when, number, what))
    return link, out


def close(count, share, of=FRAMES):
    """True within four standard deviations of a binomial count."""
    return abs(count - share * of) <= 4 * math.sqrt(of * share * (1 - share)) + 1e-9


def test_passes_all_frames_without_options():
    link, out = pass_through()
    assert [number for _, _, number, _ in out] == list(range(FRAMES))
    assert all(sent == came for sent, came, _, _ in out)
    assert link.counts == {"frames": FRAMES, "passed": FRAMES}


def test_seed_determines_the_result():
    words = "--loss 0.1 --duplicate 0.1 --flip 0.1 --reorder 0.3 --burst 2:0.5".split()
    assert pass_through(*words)[1] == pass_through(*words)[1]
    assert pass_through(*words)[1] != pass_through("--seed", "2", *words)[1]
    assert pass_through(*words)[1] != pass_through(*words, direction=(2, 1))[1]


def test_loses_the_stated_share():
    for share in 0.01, 0.1, 0.3:
        link, out = pass_through("--loss", str(share))
        assert close(link.counts["lost"], share) and len(out) == FRAMES - link.counts["lost"]
        # Tests that losses are independent of each other.
        lost = [True] * FRAMES
        for _, _, number, _ in out:
            lost[number] = False
        assert close(sum(a and b for a, b in zip(lost, lost[1:])), share * share)


def test_duplicates_the_stated_share():
    link, out = pass_through("--duplicate", "0.2")
    assert close(link.counts["doubled"], 0.2) and len(out) == FRAMES + link.counts["doubled"]


def test_flips_one_bit_outside_the_header():
    link, out = pass_through("--flip", "0.25")
    places = []
    for _, _, number, frame in out:
        change = int.from_bytes(frame, "big") ^ number
        if change:
            assert change.bit_count() == 1
            places.append(len(frame) * 8 - change.bit_length())
    assert len(places) == link.counts["flipped"] and close(len(places), 0.25)
    assert min(places) >= 14 * 8
    middle = (14 * 8 + 100 * 8) / 2
    assert abs(sum(places) / len(places) - middle) < 4 * (86 * 8) / math.sqrt(12 * len(places)), "flipped bits are not uniformly distributed"


def test_reorders_the_stated_share():
    link, out = pass_through("--reorder", "0.3", "--reorder-s", "0.2")
    delays = [came - sent for sent, came, _, _ in out if came > sent]
    assert close(link.counts["delayed"], 0.3) and len(out) == FRAMES
    assert max(delays) <= 0.2 and abs(sum(delays) / len(delays) - 0.1) < 4 * 0.2 / math.sqrt(12 * len(delays))
    arrival = [number for _, _, number, _ in sorted(out, key=lambda each: each[1])]
    assert any(a > b for a, b in zip(arrival, arrival[1:]))


def test_drops_bursts_at_the_stated_intervals():
    link, out = pass_through("--burst", "4:0.5")
    passed = [number for _, _, number, _ in out]
    holes = [b - a - 1 for a, b in zip(passed, passed[1:]) if b - a > 1]
    assert all(499 <= hole <= 501 or hole > 990 for hole in holes), holes
    assert sum(holes) + FRAMES - 1 - passed[-1] + passed[0] == link.counts["burst"]
    # The intervals between gaps are exponential: about 10 of them in 40 s.
    assert 3 <= len(holes) <= 20
    long_link, _ = pass_through("--burst", "4:0.5", frames=20 * FRAMES)
    assert abs(long_link.counts["burst"] / (20 * FRAMES) - 0.125) < 0.03


def test_limits_the_rate():
    link, out = pass_through("--rate", "400000", frame_bytes=100)  # bit/s, half of the offered rate
    span_s = out[-1][1] - out[0][1]
    assert abs(8 * 100 * (len(out) - 1) / span_s - 400_000) < 4_000
    assert abs(link.counts["over_rate"] - FRAMES / 2) < 300
    assert max(came - sent for sent, came, _, _ in out) <= SWITCH.Link.QUEUE_S + 0.003
    link, out = pass_through("--rate", "900000")
    assert len(out) == FRAMES, "frames within the rate limit were lost"


def test_cuts_apply_to_one_direction():
    words = ["--cut", "1-2@10:20"]
    link, out = pass_through(*words)
    assert link.counts["cut"] == 10_000 and not [1 for sent, *_ in out if 10 <= sent < 20]
    assert len(pass_through(*words, direction=(2, 1))[1]) == FRAMES
    assert not pass_through("--cut", "1-2")[1]


def test_span_limits_all_effects_except_cuts():
    words = "--loss 0.5 --duplicate 0.5 --flip 0.5 --reorder 0.5 --burst 2:0.5 --rate 400000 --span 10:20 --cut 1-2@30:31".split()
    link, out = pass_through(*words)
    calm = [(came - sent, number) for sent, came, number, _ in out if not 10 <= sent < 20]
    assert len(calm) == 30_000 - 1_000 and link.counts["cut"] == 1_000
    # Frames sent before the end of the span may still wait for the limited rate after it.
    assert all(delay == 0 for delay, _ in calm)
    assert link.counts["lost"] and link.counts["flipped"] and link.counts["doubled"] and link.counts["burst"]


SENDER = """
import socket, time
ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.bind(("", 9000))
ear.recv(10)
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
for number in range(3000):
    out.sendto(number.to_bytes(4, "big") + bytes(200), ("239.255.1.1", 9001))
    time.sleep(0.0005)
out.sendto(bytes(20_000), ("239.255.1.1", 9001))
for _ in range(200):
    out.sendto(b"end", ("239.255.1.1", 9001))
    time.sleep(0.002)
"""
HEARER = """
import json, socket, struct, sys
ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
ear.bind(("239.255.1.1", 9001))
ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
               socket.inet_aton("239.255.1.1") + socket.inet_aton("10.77.0.2"))
ear.settimeout(0.2)
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
heard, large = [], 0
while True:
    try:
        data = ear.recv(65536)
    except TimeoutError:
        out.sendto(b"go", ("10.77.0.1", 9000))
        continue
    if data == b"end":
        break
    large += len(data) == 20_000
    if len(data) == 204:
        heard.append(int.from_bytes(data[:4], "big"))
json.dump([heard, large], open(sys.argv[1], "w"))
"""


def over_the_cables(*options):
    with tempfile.NamedTemporaryFile() as found:
        done = subprocess.run([str(SWITCH_PATH), *options, "--", sys.executable, "-c", SENDER, "--",
                               sys.executable, "-c", HEARER, found.name],
                              check=True, capture_output=True, text=True, timeout=100)
        heard, large = json.load(open(found.name))
        return heard, large, json.loads(done.stdout)["1-2"]


def network_test_passes_unharmed_frames():
    heard, large, counts = over_the_cables()
    assert heard == list(range(3000)) and large == 1, (len(heard), large)
    assert set(counts) == {"frames", "passed"}


def network_test_counts_match_the_received_frames():
    heard, _, counts = over_the_cables("--loss", "0.2", "--duplicate", "0.1", "--reorder", "0.1", "--reorder-s", "0.02")
    assert 4 * math.sqrt(3000 * 0.16) > abs(len(set(heard)) - 2400), len(set(heard))
    assert 4 * math.sqrt(2400 * 0.09) > abs(len(heard) - len(set(heard)) - 240)
    assert any(a > b for a, b in zip(heard, heard[1:])), "no frame was reordered"
    assert counts["frames"] == counts["passed"] + counts["lost"]


def main():
    prefix = "network_test_" if "--network" in sys.argv else "test_"
    for name, test in list(globals().items()):
        if name.startswith(prefix):
            print(name, flush=True)
            test()


if __name__ == "__main__":
    main()
