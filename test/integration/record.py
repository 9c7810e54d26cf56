#!/usr/bin/env python3
"""record.py BIN_DIR: tests `vantage log record` against everything that ends or harms loggers: signals,
kill -9, a full disk, a read-only disk, a limit on files, existing files, datagrams that end lcm-logger.
It is also compared with lcm-logger, whose log must have the same content. To be run in its own network,
as root there: in_network.sh record.py ...
"""
import os
import pathlib
import random
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

PATIENCE_S = 30
LOSS_MAX_S = 0.1
GROUP, PORT = "239.255.76.67", 7667
HEADER = struct.Struct(">IqqII")
VANTAGE = str(pathlib.Path(sys.argv[1]).resolve() / "vantage")
FOLDER = None


def url(port=PORT):
    return f"udpm://{GROUP}:{port}?ttl=0"


def events(log):
    """Returns (number, time, channel, data) of each event; fails if the log is not whole."""
    data, at = pathlib.Path(log).read_bytes(), 0
    while at < len(data):
        assert at + HEADER.size <= len(data), f"{log} is torn"
        sync, number, utime, name_bytes, data_bytes = HEADER.unpack_from(data, at)
        assert sync == 0xEDA1DA01, f"{log} is damaged at {at}"
        name_at, data_at = at + HEADER.size, at + HEADER.size + name_bytes
        at = data_at + data_bytes
        assert at <= len(data), f"{log} is torn"
        yield number, utime, data[name_at:data_at].decode(), data[data_at:at]


def whole_part(log):
    """Cuts off an incomplete end, as `vantage up` does before it continues a log."""
    subprocess.run([VANTAGE, "log", "repair", log, f"{log}.whole", "--force"], check=True,
                   stdout=subprocess.DEVNULL)
    return f"{log}.whole"


def until(holds, what):
    give_up = time.monotonic() + PATIENCE_S
    while not (found := holds()):
        assert time.monotonic() < give_up, f"no {what}"
        time.sleep(0.005)
    return found


class Sender:
    """Sends LCM datagrams from its own port."""

    def __init__(self, port=PORT):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.to, self.sequence = (GROUP, port), 0

    def raw(self, datagram):
        self.socket.sendto(datagram, self.to)

    def publish(self, channel, data):
        name, sequence = channel.encode() + b"\0", self.sequence
        self.sequence += 1
        if len(name) + len(data) <= 65499:
            self.raw(b"LC02" + struct.pack(">I", sequence) + name + data)
            return
        first = 65487 - len(name)
        cuts = [0, *range(first, len(data), 65487), len(data)]
        for number, (begin, end) in enumerate(zip(cuts, cuts[1:])):
            self.raw(fragment(sequence, len(data), begin, number, len(cuts) - 1,
                              (b"" if number else name) + data[begin:end]))


def fragment(sequence, size, offset, number, count, rest):
    return b"LC03" + struct.pack(">IIIHH", sequence, size, offset, number, count) + rest


class Recorder:
    def __init__(self, log, *options, port=PORT, before=None, command=None):
        self.log, self.errors = str(log), tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            command or [VANTAGE, "log", "record", self.log, "--url", url(port), *options],
            stdout=subprocess.DEVNULL, stderr=self.errors, preexec_fn=before)
        self.sender = Sender(port)

    def start(self):
        """Returns once the recorder receives messages."""
        def has_received():
            assert self.process.poll() is None, self.printed()
            self.sender.publish("KNOCK", b"")
            return os.path.exists(self.log) and os.path.getsize(self.log) > 0
        until(has_received, "first recorded message")
        return self

    def is_waiting(self):
        """True if no thread of the recorder is running or ready to run, so its work so far is done."""
        stats = pathlib.Path(f"/proc/{self.process.pid}/task").glob("*/stat")
        return all(stat.read_text().rpartition(")")[2].split()[0] == "S" for stat in stats)

    def printed(self):
        self.errors.seek(0)
        return self.errors.read()

    def end(self, how=signal.SIGINT):
        self.process.send_signal(how)
        return self.process.wait(PATIENCE_S)


def of(log, *channels):
    return [(channel, data) for _, _, channel, data in events(log) if channel in channels]


def test_signals_end_it_with_a_complete_log():
    for how in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
        recorder = Recorder(FOLDER / f"{how.name}.lcmlog").start()
        for i in range(100):
            recorder.sender.publish("TICK", struct.pack(">I", i))
        assert recorder.end(how) == 0, (how, recorder.printed())
        assert of(recorder.log, "TICK") == [("TICK", struct.pack(">I", i)) for i in range(100)], how
        numbers = [number for number, *_ in events(recorder.log)]
        assert numbers == list(range(len(numbers)))


def test_kill_9_loses_at_most_100_ms():
    rng, worst_s = random.Random(7), 0.0
    for turn in range(12):
        recorder = Recorder(FOLDER / f"kill{turn}.lcmlog").start()
        stop, sent = threading.Event(), []

        def speak():
            while not stop.is_set():
                sent.append(time.monotonic())
                recorder.sender.publish("TICK", struct.pack(">d", sent[-1]) + bytes(200))
                time.sleep(0.001)

        speaker = threading.Thread(target=speak)
        speaker.start()
        # Log size, bytes; only messages after it may be lost.
        kept_bytes = os.path.getsize(recorder.log) + 240 * rng.randrange(100, 300)
        until(lambda: os.path.getsize(recorder.log) > kept_bytes, "traffic")
        enough = len(sent) + rng.randrange(200)
        until(lambda: len(sent) > enough, "traffic")
        until(recorder.is_waiting, "rest of the recorder")  # the machine did not keep it waiting
        last = sent[-1]
        recorder.end(signal.SIGKILL)
        stop.set()
        speaker.join()
        ticks = of(whole_part(recorder.log), "TICK")
        assert len(ticks) > 50
        worst_s = max(worst_s, last - struct.unpack(">d", ticks[-1][1][:8])[0])
    print(f"  kill -9: {1e3 * worst_s:.1f} ms lost at most in 12 kills")
    assert worst_s <= LOSS_MAX_S


def small_disk(name, options):
    disk = FOLDER / name
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", disk], check=True)
    return disk


def hears_refusal(port=PORT):
    """Returns a function that is true once HEALTH_RECORDER has reported that it cannot write the log."""
    ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    ear.bind((GROUP, port))
    ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                   socket.inet_aton(GROUP) + struct.pack("=I", 0))
    ear.setblocking(False)
    name = b"log.is_written\0"

    def has_said():
        try:
            while True:
                datagram = ear.recv(65536)
                at = datagram.find(name)
                if b"HEALTH_RECORDER\0" in datagram and at >= 0:
                    value_at = at + len(name)
                    if struct.unpack_from(">q", datagram, value_at)[0] == 0:
                        return True
        except BlockingIOError:
            return False
    return has_said


def test_full_disk_is_reported_at_once_and_leaves_a_complete_log():
    disk = small_disk("full", "size=1m")
    refused = hears_refusal()
    recorder = Recorder(disk / "a.lcmlog", "--free-mib", "0").start()
    (disk / "else").write_bytes(bytes(700_000))
    sent = 0
    while "LOG NOT WRITTEN" not in recorder.printed():
        recorder.sender.publish("TICK", struct.pack(">I", sent) + bytes(2000))
        sent += 1
        assert sent < 100_000
        time.sleep(0.001)
    assert f"LOG NOT WRITTEN: {recorder.log}: cannot be written: No space left on device" in recorder.printed()
    until(refused, "word of it on HEALTH_RECORDER")
    (disk / "else").unlink()
    until(lambda: "the log is written again; number of lost events: 0" in recorder.printed(), "writing again")
    assert recorder.end() == 1, "exit code 0 although the log was not written"
    ticks = of(recorder.log, "TICK")
    assert [struct.unpack(">I", data[:4])[0] for _, data in ticks] == list(range(sent)), "events were lost"


def test_log_ends_with_a_complete_event_if_the_disk_stays_full():
    disk = small_disk("stays_full", "size=256k")
    recorder = Recorder(disk / "a.lcmlog", "--free-mib", "0").start()
    while "LOG NOT WRITTEN" not in recorder.printed():
        recorder.sender.publish("TICK", bytes(3000))
        time.sleep(0.001)
    assert recorder.end(signal.SIGTERM) == 1
    assert len(of(recorder.log, "TICK")) > 20
    assert "events were lost" in recorder.printed(), recorder.printed()


def test_file_size_limit_is_reported_as_a_write_error():
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
    recorder = Recorder(FOLDER / "limit.lcmlog", before=limit).start()
    while "LOG NOT WRITTEN" not in recorder.printed():
        recorder.sender.publish("TICK", bytes(3000))
        time.sleep(0.001)
    assert "File too large" in recorder.printed()
    assert recorder.end() == 1
    assert 190_000 < os.path.getsize(recorder.log) <= 200_000 and of(recorder.log, "TICK")


def test_unwritable_paths_are_refused_at_the_start():
    disk = small_disk("read_only", "size=1m,ro")
    recorder = Recorder(disk / "a.lcmlog", "--free-mib", "0")
    assert recorder.process.wait(PATIENCE_S) == 2 and "Read-only file system" in recorder.printed()
    taken = FOLDER / "taken.lcmlog"
    taken.write_bytes(b"a flight of last year")
    recorder = Recorder(taken)
    assert recorder.process.wait(PATIENCE_S) == 2
    assert f"{taken}: exists already" in recorder.printed(), recorder.printed()
    assert taken.read_bytes() == b"a flight of last year"
    recorder = Recorder(FOLDER / "huge.lcmlog", "--free-mib", "1000000000")
    assert recorder.process.wait(PATIENCE_S) == 2 and "MiB are free on its disk" in recorder.printed()
    assert not (FOLDER / "huge.lcmlog").exists()


def hostile(rng):
    """Returns a datagram that no correct LCM program sends. Those of the first three kinds end lcm-logger."""
    number, name = rng.getrandbits(32), b"A" * rng.randrange(1, 70)
    junk = rng.randbytes(rng.randrange(1500))
    return rng.choice([
        lambda: fragment(number, 0x180, 0xFFFFFF00, 0, 2, b"A\0" + bytes(0x180)),  # the end wraps to 128
        lambda: fragment(number, 400, 100, 0, 1, name),  # a first fragment without a terminated name
        lambda: fragment(number, 400, 200, 0, 1, b"A" * 5),
        lambda: fragment(number, 0x180, 0xFFFFFF00, 1, 2, bytes(0x180)),
        lambda: junk,
        lambda: b"LC02" + junk,
        lambda: b"LC03" + junk,
        lambda: b"LC02" + struct.pack(">I", number) + name,
        lambda: b"LC02" + struct.pack(">I", number) + b"\1\n\x7f\0" + junk,  # an invalid channel name for a log
        lambda: fragment(number, 0xFFFFFFFF, 0, 0, 65535, b"A\0" + bytes(10)),
        lambda: fragment(number, rng.getrandbits(18), rng.getrandbits(18), rng.getrandbits(2),
                         rng.getrandbits(2), b"A\0" + junk),
    ])()


def test_survives_datagrams_that_end_lcm_logger():
    rng = random.Random(21)
    recorder = Recorder(FOLDER / "hostile.lcmlog", "--channels", "GOOD", "KNOCK").start()
    attacker, good = Sender(), []
    for i in range(20_000):
        attacker.raw(hostile(rng))
        if i % 20 == 0:
            good.append(rng.randbytes(150_000 if i % 2000 == 0 else 300))
            recorder.sender.publish("GOOD", good[-1])
        if i % 100 == 0:
            attacker = Sender()
            # Sends no faster than the recorder writes, since this test is not about the socket's buffer.
            until(lambda: os.path.getsize(recorder.log) >= sum(map(len, good)),
                  "good messages in the log")
    assert recorder.end() == 1, "forged first fragments were not counted as incomplete messages"
    assert "parts of them never arrived" in recorder.printed(), recorder.printed()
    assert [data for _, data in of(recorder.log, "GOOD")] == good
    # Shows that one such datagram ends lcm-logger.
    stock = Recorder(FOLDER / "stock.lcmlog",
                     command=["lcm-logger", "-q", f"--lcm-url={url()}", FOLDER / "stock.lcmlog"]).start()
    attacker.raw(fragment(1, 400, 200, 0, 1, b"A" * 5))
    print("  lcm-logger:", "signal", -stock.process.wait(PATIENCE_S))


def test_log_equals_that_of_lcm_logger():
    rng = random.Random(4)
    stock_log = FOLDER / "beside_stock.lcmlog"
    stock = Recorder(stock_log, command=["lcm-logger", "-q", f"--lcm-url={url()}", stock_log]).start()
    ours = Recorder(FOLDER / "beside_ours.lcmlog").start()
    sent = []
    for i in range(400):
        channel, data = f"CHANNEL_{i % 7}", rng.randbytes(120_000 if i % 50 == 7 else rng.randrange(2000))
        sent.append((channel, data))
        ours.sender.publish(channel, data)
        time.sleep(0.002)  # lcm-logger's queue holds 31
    while os.path.getsize(stock_log) < sum(len(data) for _, data in sent):
        ours.sender.publish("KNOCK", b"")  # it writes when it receives more
        time.sleep(0.01)
    assert ours.end() == 0
    stock.end()
    channels = {channel for channel, _ in sent}
    assert of(ours.log, *channels) == sent
    assert of(stock_log, *channels) == sent
    apart_us = [abs(a[1] - b[1]) for a, b in zip(
        *([event for event in events(log) if event[2] in channels] for log in (ours.log, stock_log)))]
    print(f"  times differ from those of lcm-logger by {sorted(apart_us)[len(apart_us) // 2]} µs (median), "
          f"{max(apart_us)} at most")
    # LCM's player replays our log on another port.
    again = Recorder(FOLDER / "played.lcmlog", port=PORT + 1).start()
    subprocess.run(["lcm-logplayer", "-l", url(PORT + 1), ours.log], check=True, stdout=subprocess.DEVNULL,
                   timeout=PATIENCE_S)
    assert again.end() == 0
    assert of(again.log, *channels) == sent


def paced(sender, channel, data):
    """Publishes in fragments, at a pace that the socket's buffer can follow."""
    raw, sent = sender.raw, []

    def send(datagram):
        raw(datagram)
        sent.append(len(datagram))
        if len(sent) % 2 == 0:
            time.sleep(0.001)
    sender.raw = send
    sender.publish(channel, data)
    sender.raw = raw


def test_large_messages_are_recorded_or_reported():
    picture = random.Random(3).randbytes(6_200_000)
    recorder = Recorder(FOLDER / "large.lcmlog").start()
    for count in range(1, 6):
        paced(recorder.sender, "CAMERA", picture)
        until(lambda: os.path.getsize(recorder.log) >= count * len(picture), f"picture {count} in the log")
    assert recorder.end() == 0, recorder.printed()
    assert of(recorder.log, "CAMERA") == 5 * [("CAMERA", picture)]
    for options, code in ([], 1), (["--without", "CAMERA"], 0):
        log = FOLDER / f"small{code}.lcmlog"
        small = Recorder(log, command=[VANTAGE, "log", "record", log, "--url",
                                       url() + "&max_message_size=4000000", *options]).start()
        paced(small.sender, "CAMERA", picture)
        small.sender.publish("TICK", b"after it")
        until(lambda: of(small.log, "TICK"), "what was sent after it")
        assert small.end() == code, small.printed()
        words = "CAMERA: 1 messages are not in the log: they have up to 6200000 bytes, more than max_message_size 4000000"
        assert (words in small.printed()) == (code == 1), small.printed()


def test_incomplete_message_is_reported():
    recorder = Recorder(FOLDER / "lacks.lcmlog").start()
    recorder.sender.raw(fragment(900, 100_000, 0, 0, 2, b"CAMERA\0" + bytes(60_000)))
    # The incomplete message is dropped one second after its newest fragment.
    lacks = b"transport.incomplete_messages\0"
    until(lambda: any(lacks in data for _, data in of(recorder.log, "HEALTH_RECORDER")), "count of it")
    assert recorder.end() == 1, recorder.printed()
    assert "1 messages are not in the log: parts of them never arrived" in recorder.printed(), recorder.printed()


def test_files_continue_each_other():
    recorder = Recorder(FOLDER / "turn.lcmlog", "--rotate-mib", "1").start()
    recorder.sender.publish("SCENARIO", b"what is flown")
    for i in range(300):
        recorder.sender.publish("TICK", struct.pack(">I", i) + bytes(9_000))
        time.sleep(0.001)
    assert recorder.end() == 0
    logs = [FOLDER / name for name in ("turn.lcmlog", "turn-2.lcmlog", "turn-3.lcmlog")]
    assert all(log.stat().st_size <= 2 ** 20 for log in logs)
    assert [next(events(log))[2] for log in logs[1:]] == ["SCENARIO"] * 2
    assert [struct.unpack(">I", data[:4])[0] for log in logs for _, data in of(log, "TICK")] == list(range(300))
    recorder = Recorder(FOLDER / "enough.lcmlog", "--limit-mib", "1").start()
    while recorder.process.poll() is None:
        recorder.sender.publish("TICK", bytes(9_000))
        time.sleep(0.001)
    assert recorder.process.returncode == 1 and "the limit of 1048576 bytes is reached" in recorder.printed()
    assert of(recorder.log, "TICK")


def main():
    global FOLDER
    if len(sys.argv) < 3:  # separate disks
        os.execvp("unshare", ["unshare", "-m", sys.executable, __file__, sys.argv[1], "--mounted"])
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        FOLDER = pathlib.Path(name)
        try:
            for what, test in list(globals().items()):
                if what.startswith("test_"):
                    print(what, flush=True)
                    test()
        finally:
            subprocess.run(["umount", "-l", *FOLDER.glob("*/")], stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
