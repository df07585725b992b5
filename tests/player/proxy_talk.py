"""A proxy and a scripted server for it, with geometry and configurations to answer."""

from scripted_server import scripted
from wire_talk import ACK

from player import (
    LaserConfig,
    PlayerClient,
    RangerConfig,
    RangerProxy,
    messages,
)
from player.codes import Interface

POSE = (1.0, 2.0, 3.0, 0.0, 0.0, 0.5)
SIZE = (0.4, 0.6, 0.2)  # on the wire: width, length, height
GEOMETRY = {"pose": POSE, "size": SIZE}
ELEMENTS = {
    "element_poses": [(0.0, 0, 0, 0, 0, a) for a in (-1, 0, 1)],
    "element_sizes": [SIZE] * 3,
}
LASER_CONFIG = LaserConfig(-1.5, 1.5, 0.5, 8.0, 0.25, True, 10.0)
RANGER_CONFIG = RangerConfig(-1.5, 1.5, 0.5, 0.1, 8.0, 0.25, 10.0)


def answer_ranger(talk):
    """What a RangerProxy asks when it is made."""
    reply = messages.encode(62, ACK, 5, **RANGER_CONFIG._asdict())
    talk.accept(Interface.RANGER, 5, reply)
    talk.accept(Interface.RANGER, 1, messages.encode(62, ACK, 1, **GEOMETRY, **ELEMENTS))


def talk_with(proxy_class, script, act):
    """Runs `act(proxy)` against a server that greets, subscribes, and then does `script`."""

    def whole(talk):
        talk.greet()
        talk.subscribe()
        if proxy_class is RangerProxy:
            answer_ranger(talk)
        script(talk)

    environ = {"PLAYER_ROBOT": "r1"}
    with scripted(whole) as sock, PlayerClient(sock=sock, environ=environ) as robot:
        return act(proxy_class(robot))
