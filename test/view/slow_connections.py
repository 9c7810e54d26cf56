#!/usr/bin/env python3
"""slow_connections.py VANTAGE SAMPLE.xz: while 64 connections are at saying what they want, and do not
get on with it, viewers and who asks for a file are served; and they are ended before long."""
import http.client
import select
import socket
import sys

from plain_viewer import Viewer, serving

SLOW = 64
PATIENCE_S = 120


def slow(port):
    one = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
    one.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
    return one


def main():
    with serving(*sys.argv[1:3]) as port:
        many = [slow(port) for _ in range(SLOW)]
        opcode, content = Viewer(port).frame()
        assert opcode == 1 and b"serverInfo" in content, content
        asked = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        asked.request("GET", "/api/topics")
        assert asked.getresponse().status == 200
        ended, _, _ = select.select(many, [], [], 0)
        assert not ended, f"only once {len(ended)} of them were ended"
        for one in many:
            while one.recv(4096):  # some error page, or nothing
                pass
    print("slow_connections: all good")


if __name__ == "__main__":
    main()
