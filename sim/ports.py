"""Where robots are served: who shares a port, which are opened, and at which addresses.

Rules: nothing is opened unless the world, `--listen` or a controller needs it. An address that is
taken ends a run at its start; later it costs the robot its chosen port, and nobody anything else.
"""

from __future__ import annotations

import errno
import ipaddress
import math
from collections.abc import Callable, Mapping

from player.codes import DEFAULT_PORT, DeviceAddr
from player.directory import Directory
from player.server import Server
from sim.devices.device import Context, Device
from sim.devices.simulation import Simulation
from sim.devices.switchboard import Port, Switchboard
from sim.robot import Robot
from sim.worldfile.schema import Controller, Player

CONNECTIONS = 512
"""Connections over TCP at a time, whoever they are."""
CONNECTIONS_PER_ROBOT = 4
"""So many more for each robot: its controller, and some who look on."""
MOST_TOLD = 32
"""Robots whose ports are told one by one where they follow each other."""
LAST_PORT = 65535


class Ports:
    """The ports of a run.

    `listen`: host and port of the first robot, in place of the world file's. `patience`:
    wall-clock seconds that a robot's client is waited for, None: it is not waited for. `say` and
    `warn` are given lines that are meant for people.
    """

    def __init__(
        self,
        player: Player,
        controllers: Mapping[str, Controller],
        listen: tuple[str, int] | None,
        context: Context,
        switchboard: Switchboard,
        server: Server,
        *,
        patience: float | None,
        say: Callable[[str], None],
        warn: Callable[[str], None],
    ) -> None:
        self.host, self.base = listen or (player.host, player.port)
        self.open = self.base is not None  # to everybody, and not for controllers alone
        self.shares = player.layout == "shared"
        self.hands = any(controller.external for controller in controllers.values())
        self.context = context
        self.switchboard = switchboard
        self.server = server
        self.patience = patience
        self.say = say
        self.warn = warn
        self.shared: Port | None = None  # of all robots, where they share one
        self.simulation: Simulation | None = None  # of that port
        self.warned = False  # of an address that others can reach
        self.hand_told = False  # how to drive a robot by hand
        self.awaited = 0  # robots whose clients are waited for at ports that nobody has chosen

    def place(self, port: Port, robot: Robot, devices: list[Device]) -> None:
        """Put a robot's devices at its own port (whether or not that is opened)."""
        found = port.serve(devices)
        port.directory.time = self.context.time
        if self.shares:
            found = self.share(devices, robot, full=robot.model.simulation == "full")
        port.first = found[devices[0]].index

    def share(self, devices: list[Device], robot: Robot, full: bool) -> dict[Device, DeviceAddr]:
        """The robot's devices at the port of all robots, where there is one simulation:0."""
        if self.shared is None or self.simulation is None:
            self.shared = self.switchboard.add_port()
            self.simulation = Simulation(self.context, robot, full)
            self.shared.serve([self.simulation])
        self.simulation.admit(robot, full)
        self.shared.directory.time = self.context.time
        return self.shared.serve(d for d in devices if not isinstance(d, Simulation))

    def serves(self, robot: Robot) -> bool:
        """Whether a robot is to be reached from outside."""
        return self.open or robot.driver.kind in ("command", "external")

    def serve(self, robot: Robot) -> int | None:
        """Open the robot's port, if it is to be reached from outside; the port's number."""
        self.server.max_connections = CONNECTIONS + CONNECTIONS_PER_ROBOT * (robot.index + 1)
        driver = robot.driver
        if not self.serves(robot):
            return None
        if self.shared is not None:
            number = self.shared.directory.port
            if not number:
                if self.base is None:
                    number = self.bind_free(self.shared, external=self.hands)
                else:
                    number = self.bind(self.base, self.shared)
                self.say(f"robots are served at {self.host}:{number}, by index")
        else:
            if self.base is None:
                number = self.bind_free(robot.port, external=driver.kind == "external")
            else:
                number = self.bind(self.base + robot.index if self.base else 0, robot.port)
            if not self.base or robot.index < MOST_TOLD:
                self.say(f"{robot.name} is served at {self.host}:{number}")
            elif robot.index == MOST_TOLD:
                self.say(f"further robots are served at {self.host}:{number} and the ports above")
        if driver.kind == "external":
            where = f"a Player client at {self.host}:{number}"
            if self.patience is None:
                self.say(f"{robot.name}: {where} may come at any time")
            else:
                index = robot.port.first
                what = f"position2d:{index} or another of " if driver.drives else ""
                self.say(
                    f"{robot.name}: waiting for {where} that reads {what}its devices "
                    f"({how_long(self.patience)})"
                )
            if driver.drives and robot.port.first == 0 and not self.hand_told:
                self.hand_told = True
                self.say(
                    f"  by hand: python -m controllers.keyboard {reachable(self.host)}:{number}"
                )
        return number

    def bind_free(self, port: Port, external: bool) -> int:
        """Listen at a port that nobody has chosen; its number.

        Programs are told it. An `external` client, such as `controllers.keyboard`, looks for its
        robot at Player's own port unless it is told another: so the first of the robots that wait
        for one is served there, and the next at the next ports, where these are free.
        """
        if not external:
            return self.bind(0, port)
        wanted = DEFAULT_PORT + self.awaited
        self.awaited += 1
        try:
            return self.bind(wanted, port)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            self.say(f"{error.strerror}: a free port is taken instead")
            return self.bind(0, port)

    def bind(self, wanted: int, port: Port) -> int:
        """Listen at a port, 0 for any free one; its number.

        While a run is going on, the port of a robot that enters may have been taken by somebody
        else: then it gets a free one.
        """
        if not is_loopback(self.host) and not self.warned:
            self.warned = True
            self.warn(
                f"listening on {self.host}: anybody who reaches this address can drive the robots"
            )
        if wanted > LAST_PORT:
            raise beyond(self.host, wanted, self.base)
        try:
            _, number = self.server.listen(self.host, wanted, port.directory)
        except OSError as error:
            if self.context.time == 0.0:
                raise
            self.say(f"{error}: a free port is taken instead")
            _, number = self.server.listen(self.host, 0, port.directory)
        return number


def beyond(host: str, port: int, base: int | None) -> OSError:
    """There is no such port for a robot."""
    return OSError(
        f"cannot listen on {host}:{port}: the robots' ports begin at {base}, "
        f"and {LAST_PORT} is the last one there is. Begin lower, or use "
        "`player: {layout: shared}` in the world file"
    )


def try_ports(player: Player, listen: tuple[str, int] | None, robots: int) -> None:
    """Raises OSError where so many robots could not be served at the start; nothing stays open.

    For those who have something to lose when a run cannot begin.
    """
    host, base = listen or (player.host, player.port)
    if base is None:
        return
    one = player.layout == "shared" or base == 0
    for port in range(base, base + (1 if one else max(1, robots))):
        if port > LAST_PORT:
            raise beyond(host, port, base)
        try_address(host, port)


def try_address(host: str, port: int) -> None:
    """Raises OSError where nobody can listen there."""
    with Server() as server:
        server.listen(host, port, Directory())


def reachable(host: str) -> str:
    """The address by which programs on this machine reach a server that listens on `host`."""
    return {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}.get(host, host)


def how_long(patience: float) -> str:
    """How long somebody is waited for."""
    return "for ever" if patience == math.inf else f"for {patience:g} s at the most"


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach that address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
