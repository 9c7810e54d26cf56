#!/usr/bin/env python3
"""long_log.py LOG GIGABYTES OUT: writes repetitions of LOG to OUT as one long log.

In each repetition the numbers and times of the events, the sequence numbers of their messages and all
instants in the messages continue those of the previous repetition. Such logs serve to
measure how long opening and seeking take (see docs/results/viewer.md and test/view/peer/seek.mjs).
"""
import os
import pathlib
import struct
import sys

HEADER = struct.Struct(">IqqII")  # sync word, number, time, lengths of channel and data
NUMBER = struct.Struct(">q")
STAMP_BYTES = 32                  # bytes; each message begins with fingerprint, utime, run_id, sequence
AROUND_US = 3_600_000_000         # us; maximum difference of instants in messages from the log's times


def events(log):
    """Yields (offset, number, utime, channel, offset of the data, their length) of each event."""
    at = 0
    while at + HEADER.size <= len(log):
        _, number, utime, name_bytes, data_bytes = HEADER.unpack_from(log, at)
        data = at + HEADER.size + name_bytes
        yield at, number, utime, log[at + HEADER.size:data], data, data_bytes
        at = data + data_bytes


def instants(log, first_us, last_us):
    """Yields the offsets of all big-endian 64-bit integers whose values are instants during the log, AROUND_US
    included. Other data are very unlikely to have such a value."""
    low, high = (NUMBER.pack(each) for each in (first_us - AROUND_US, last_us + AROUND_US))
    prefix = os.path.commonprefix([low, high])
    at = log.find(prefix)
    while 0 <= at <= len(log) - NUMBER.size:
        is_one = low <= log[at:at + NUMBER.size] <= high
        if is_one:
            yield at
        at = log.find(prefix, at + (NUMBER.size if is_one else 1))


def main():
    log = pathlib.Path(sys.argv[1]).read_bytes()
    size = float(sys.argv[2]) * 1e9
    all_events = list(events(log))
    times_us = [utime for _, _, utime, *_ in all_events]
    first_us, last_us = min(times_us), max(times_us)
    sequences = {}  # sequence numbers by channel
    for _, _, _, name, data, length in all_events:
        if length >= STAMP_BYTES:
            sequences.setdefault(name, set()).add(NUMBER.unpack_from(log, data + 24)[0])
    steps = {at: last_us - first_us + 1000 for at in instants(log, first_us, last_us)}
    for at, _, _, name, data, length in all_events:
        steps[at + 4] = len(all_events)
        if length >= STAMP_BYTES:
            steps[data + 24] = max(sequences[name]) - min(sequences[name]) + 1
    places = sorted(steps)
    ends = [0] + [place + NUMBER.size for place in places]
    layout = struct.Struct(">" + "".join(f"{place - end}sq" for end, place in zip(ends, places))
                           + f"{len(log) - ends[-1]}s")
    parts = list(layout.unpack(log))
    increments = [steps[place] for place in places]
    with open(sys.argv[3], "wb") as out:
        while out.tell() < size:
            out.write(layout.pack(*parts))
            parts[1::2] = map(int.__add__, parts[1::2], increments)


if __name__ == "__main__":
    main()
