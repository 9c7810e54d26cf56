#!/usr/bin/env python3
"""close_frame.py VANTAGE SAMPLE.xz: a viewer's Close frame is answered (RFC 6455, 5.5.1) by a Close frame with
the same code; nothing follows, and the connection ends."""
import sys

from plain_viewer import Viewer, serving


def goodbye(port, content):
    viewer = Viewer(port)
    assert viewer.frame()[0] == 1, "the server sends no identification"
    viewer.send(8, content)
    opcode = 0
    while opcode != 8:
        frame = viewer.frame()
        assert frame is not None, "the connection ends without a Close frame"
        opcode, answer = frame
    assert answer == content[:2], answer
    assert viewer.frame() is None, "data follows the Close frame"


def main():
    with serving(*sys.argv[1:3], "--play") as port:
        for content in ((1000).to_bytes(2, "big"), (1001).to_bytes(2, "big") + b"going away", b""):
            goodbye(port, content)
    print("close_frame: all good")


if __name__ == "__main__":
    main()
