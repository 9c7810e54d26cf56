"""A socket on LCM's group for programs without the LCM library; loopback only."""

import socket
import struct

GROUP, PORT = "239.255.76.67", 7667
MAGIC_SHORT = 0x4C433032


def receiver_and_sender():
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    receiver.bind(("", PORT))
    receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                        socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1"))
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
    sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    return receiver, sender


def say(sender, channel, payload, number=0):
    packet = struct.pack(">II", MAGIC_SHORT, number) + channel.encode() + b"\0" + payload
    sender.sendto(packet, (GROUP, PORT))


def sent_by(packet):
    """Returns channel and bytes of a short message; (None, b"") for anything else."""
    if len(packet) < 9 or struct.unpack(">I", packet[:4])[0] != MAGIC_SHORT:
        return None, b""
    name, _, payload = packet[8:].partition(b"\0")
    return name.decode(), payload
