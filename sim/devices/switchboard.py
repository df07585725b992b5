"""Which connection has which device: subscriptions, commands and requests in, data out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from player import messages
from player.codes import DeviceAddr, MessageType
from player.directory import Datum, Directory
from player.events import Command, Request
from player.server import Connection
from sim.devices.device import Context, Device, Refused
from sim.devices.rounds import Rounds
from sim.robot import Robot


class Port:
    """What one port serves, or one socket pair: a directory and the devices behind it."""

    def __init__(self) -> None:
        self.directory = Directory()
        self.devices: dict[DeviceAddr, Device] = {}
        self.robots: dict[Robot, None] = {}
        self.counts: Counter[int] = Counter()  # devices by interface
        self.first = 0
        """The index at which clients over TCP find a robot's drive, or else its first device: other
        than 0 only where all robots share a port."""

    def serve(self, devices: Iterable[Device]) -> dict[Device, DeviceAddr]:
        """Serve devices at the next free index of their interfaces; where each is found."""
        found = {}
        for device in devices:
            interface = device.addr.interf
            addr = DeviceAddr(interface, self.counts[interface])
            self.counts[interface] += 1
            self.devices[addr] = device
            self.directory.add(addr)
            self.robots[device.robot] = None
            found[device] = addr
        return found


class Switchboard:
    """All ports and all subscriptions of a run. `say(line)` is given what is meant for people."""

    def __init__(self, context: Context, say: Callable[[str], None]) -> None:
        self.context = context
        self.say = say
        self.complained: dict[Connection, set[Robot]] = {}  # people have been told, of these robots
        self.ports: dict[Directory, Port] = {}
        self.reached: dict[Port, None] = {}  # those that clients can come to
        self.connections: dict[Connection, dict[Device, DeviceAddr]] = {}
        """What each has subscribed, and at which address."""
        self.changed = True  # what is wanted has changed since `wanted` was last read
        self.rounds = Rounds()
        self.stale = True  # who is told what may have changed since `rounds` were planned
        self.paused_by: Connection | None = None
        """Who has stopped the clock."""

    def add_port(self) -> Port:
        """A new port that serves nothing yet."""
        port = Port()
        self.ports[port.directory] = port
        return port

    def port(self, connection: Connection) -> Port:
        """The port that a connection came in by."""
        return self.ports[connection.session.directory]

    def stamp(self, time: float) -> None:
        """Replies carry this simulated time from now on."""
        for port in self.reached:
            port.directory.time = time

    def reach(self, *ports: Port | None) -> None:
        """Clients can come to these ports from now on."""
        self.reached.update(dict.fromkeys(port for port in ports if port is not None))
        self.stale = True

    def subscribe(self, connection: Connection, addr: DeviceAddr) -> Device:
        """A connection gets a device's data from now on."""
        device = self.port(connection).devices[addr]
        self.connections.setdefault(connection, {})[device] = addr
        self.changed = self.stale = True
        return device

    def unsubscribe(self, connection: Connection, addr: DeviceAddr) -> Device:
        """A connection does not get a device's data any more."""
        device = self.port(connection).devices[addr]
        self.connections.get(connection, {}).pop(device, None)
        self.changed = self.stale = True
        return device

    def addresses(self, connection: Connection, robot: Robot) -> list[DeviceAddr]:
        """What a connection has subscribed of a robot's devices."""
        had = self.connections.get(connection, {})
        return [addr for device, addr in had.items() if device.robot is robot]

    def forget(self, connection: Connection) -> None:
        """A connection is gone: its subscriptions end, and so does a pause that it has asked for.

        Nobody else may know that the clock was stopped, or be there to let it go on.
        """
        self.connections.pop(connection, None)
        self.complained.pop(connection, None)
        self.changed = self.stale = True
        if self.paused_by is connection:
            self.context.paused = False
            self.paused_by = None

    def command(self, connection: Connection, event: Command) -> Device:
        """Pass a command to its device, which is returned."""
        context = self.context
        device = self.ports[connection.session.directory].devices[event.addr]
        paused = context.paused
        context.client = connection
        try:
            device.command(event.name, event.message)
        finally:
            context.client = None
        if context.complaints:
            self.tell_complaints(connection)
        if context.paused != paused:
            self.paused_by = connection if context.paused else None
        return device

    def request(self, connection: Connection, event: Request) -> None:
        """Have a device answer a request: exactly one ACK or NACK goes out."""
        device = self.port(connection).devices[event.addr]
        self.context.client = connection
        try:
            if event.name == "capabilities":
                known = messages.find(
                    event.addr.interf, event.message["type"], event.message["subtype"]
                )
                if known is None or event.message["type"] not in (MessageType.CMD, MessageType.REQ):
                    raise Refused
                reply = None
            else:
                reply = device.request(event.name, event.message)
                self.note_answer(device)
        except Refused:
            connection.session.refuse(event)
            return
        finally:
            self.context.client = None
            self.tell_complaints(connection)
        connection.session.acknowledge(event, None if reply is None else dict(reply))

    def note_answer(self, device: Device) -> None:
        """A device has answered a client's or a function's request: it may tell other data now."""
        self.stale |= self.rounds.changed(device)

    def tell_complaints(self, client: Connection) -> None:
        """Tell people, once of each client and robot, what it was sent that makes no sense."""
        for robot, what in self.context.complaints:
            told = self.complained.setdefault(client, set())
            if robot not in told:
                told.add(robot)
                who = "its program" if client.peer == robot.name else client.peer
                self.say(f"{robot.name}: {who} sent {what}")
        self.context.complaints.clear()

    def wanted(self) -> list[Device]:
        """The devices that somebody has subscribed."""
        return list(dict.fromkeys(device for have in self.connections.values() for device in have))

    def publish(self, time: float, round: int) -> list[tuple[Connection, Exception]]:
        """Hand one tick's data to every session that has subscribed it, and let it go out.

        One connection after the other: the first client can work while the others are served.
        Whose data could not be made is given back, with the reason. `round`: of perceiving.
        """
        failed = []
        ready = self.ready_rounds(time, round)
        for connection, devices in self.connections.items():
            piece = ready.get(connection)
            if piece is not None and connection.take_round(piece, len(devices)):
                continue
            data: list[Datum] = []
            try:
                for device, addr in devices.items():
                    for subtype, payload in device.publish():
                        data.append((addr, subtype, payload))
            except Exception as error:
                failed.append((connection, error))
            connection.publish_round(data, time)
        return failed

    def ready_rounds(self, time: float, round: int) -> Mapping[Connection, memoryview]:
        """The rounds that are written together; none where something in them cannot be made."""
        try:
            if not self.stale:
                ready = self.rounds.write(time, round)
                if ready is not None:
                    return ready
            clients = ((c, c.session.directory, have) for c, have in self.connections.items())
            self.rounds.plan(clients, round)
            self.stale = False
            return self.rounds.write(time, round) or {}
        except Exception:
            self.stale = True
            return {}  # whose data it is comes out where each is served alone

    def rehearse(self, round: int) -> None:
        """Write rounds for nobody, so that what is compiled for them is ready."""
        nobody: Any = None
        rounds = Rounds()
        for port in self.ports.values():
            devices = {device: addr for addr, device in port.devices.items()}
            rounds.plan([(nobody, port.directory, devices)], round)
        rounds.write(self.context.time, round)

    def show_again(self, connection: Connection, time: float) -> None:
        """Hand one client this tick's data once more; raises what a device of its raises."""
        session = connection.session
        for device, addr in self.connections.get(connection, {}).items():
            for subtype, payload in device.publish():
                session.publish(addr, subtype, payload, time)
        session.end_of_round()
