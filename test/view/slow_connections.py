#!/usr/bin/env python3
"""slow_connections.py VANTAGE SAMPLE.xz: 150 connections begin a request and do not send the rest of it.
Viewers and requests for a file are served meanwhile, and the slow connections are ended."""
import http.client
import socket
import sys

from plain_viewer import Viewer, serving

SLOW = 150  # more than the number of server threads
PATIENCE_S = 15  # half of the server's time limit for a write


def slow(port):
    one = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
    one.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
    return one


def receive(one):
    try:
        return one.recv(4096)
    except ConnectionResetError:
        return b""


def main():
    with serving(*sys.argv[1:3]) as port:
        many = [slow(port) for _ in range(SLOW)]
        opcode, content = Viewer(port).frame()
        assert opcode == 1 and b"serverInfo" in content, content
        asked = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        asked.request("GET", "/api/topics")
        assert asked.getresponse().status == 200
        for one in many:
            while receive(one):  # reads an error page, or nothing
                pass
    print("slow_connections: all good")


if __name__ == "__main__":
    main()
