"""A client of Player's protocol on a plain socket, for scripts/bench where nothing compiles C.

raw_client.py HOST PORT: as raw_client.c, it reads position2d, laser and blobfinder in pull mode and
answers each round with a velocity.
"""

import socket
import struct
import sys

HEADER = struct.Struct(">6IdII")
PLAYER, POSITION2D, LASER, BLOBFINDER = 1, 4, 6, 7
DATA, CMD, REQ, ACK, SYNCH = range(1, 6)


def say(interf: int, type_: int, subtype: int, payload: bytes = b"") -> bytes:
    """A message with its header."""
    return HEADER.pack(0, 0, interf, 0, type_, subtype, 0.0, 0, len(payload)) + payload


def main() -> None:
    """Drive until the server closes the connection."""
    link = socket.create_connection((sys.argv[1], int(sys.argv[2])))
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    rest = b""

    def exactly(size: int) -> bytes:
        nonlocal rest
        while len(rest) < size:
            got = link.recv(1 << 16)
            if not got:
                sys.exit()
            rest += got
        found, rest = rest[:size], rest[size:]
        return found

    def read_until(wanted: int) -> bytes:
        """Take messages until one of this type; the payload of the scan among them."""
        scan = b""
        while True:
            _, _, interf, _, type_, _, _, _, size = HEADER.unpack(exactly(HEADER.size))
            payload = exactly(size)
            if (interf, type_) == (LASER, DATA):
                scan = payload
            if type_ == wanted:
                return scan

    exactly(32)
    subscriptions = [
        (3, struct.pack(">7I", 0, 0, interf, 0, 1, 0, 0))
        for interf in (POSITION2D, LASER, BLOBFINDER)
    ]
    rule = struct.pack(">5i", -1, -1, DATA, -1, 1)
    for subtype, payload in [(5, struct.pack(">I", 2)), (10, rule), *subscriptions]:
        link.sendall(say(PLAYER, REQ, subtype, payload))
        read_until(ACK)
    while True:
        link.sendall(say(PLAYER, REQ, 4))
        ahead = min(struct.unpack_from(">60f", read_until(SYNCH), 24 + 4 * 60))
        turn = 0.0 if ahead > 1.5 else 0.8
        link.sendall(say(POSITION2D, CMD, 1, struct.pack(">3dI", 0.4, 0.0, turn, 1)))


if __name__ == "__main__":
    main()
