"""A minimal viewer for tests, with the frames of RFC 6455, and a server for it."""
import base64
import contextlib
import os
import pathlib
import re
import socket
import subprocess
import tempfile

TIMEOUT_S = 30


class Viewer:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=TIMEOUT_S)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            (f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
             f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n").encode())
        self.left = b""
        head = self.until(b"\r\n\r\n")
        assert b" 101 " in head.split(b"\r\n")[0], head

    def more(self):
        part = self.socket.recv(65536)
        self.left += part
        return bool(part)

    def until(self, mark):
        while mark not in self.left:
            assert self.more(), "closed early"
        head, self.left = self.left.split(mark, 1)
        return head

    def take(self, size):
        while len(self.left) < size:
            if not self.more():
                return None
        taken, self.left = self.left[:size], self.left[size:]
        return taken

    def frame(self):
        """Returns (opcode, content), or None at the end of the connection."""
        head = self.take(2)
        if head is None:
            return None
        length = head[1] & 0x7F
        if length > 125:
            length = int.from_bytes(self.take(2 if length == 126 else 8), "big")
        return head[0] & 0x0F, self.take(length)

    def send(self, opcode, content):
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(content))
        self.socket.sendall(bytes([0x80 | opcode, 0x80 | len(content)]) + mask + masked)


@contextlib.contextmanager
def serving(vantage, sample, *options):
    """Runs `vantage view` on the log that is packed in `sample`; yields its port."""
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "lab.lcmlog"
        log.write_bytes(subprocess.run(["xz", "-dkc", sample], capture_output=True,
                                       check=True).stdout)
        with subprocess.Popen([vantage, "view", log, "--port", "0", *options], text=True,
                              stdout=subprocess.PIPE) as server:
            try:
                yield int(re.search(r"http://127.0.0.1:(\d+)", server.stdout.readline())[1])
            finally:
                server.terminate()
