"""Which connection has which device: subscriptions, commands and requests in, data out."""

from __future__ import annotations

from collections.abc import Iterable

from player import messages
from player.codes import DeviceAddr, MessageType
from player.directory import Directory
from player.server import Connection
from player.session import Command, Request
from sim.devices.device import Device, Refused


class Port:
    """What one port serves, or one socket pair: a directory and the devices behind it."""

    def __init__(self) -> None:
        self.directory = Directory()
        self.devices: dict[DeviceAddr, Device] = {}
        self.robots: list[int] = []

    def add(self, device: Device, index: int | None = None) -> None:
        """Serve a device at its own index, or at another one."""
        addr = device.addr if index is None else DeviceAddr(device.addr.interf, index)
        self.devices[addr] = device
        self.directory.add(addr)
        if device.robot not in self.robots:
            self.robots.append(device.robot)

    def serve(self, devices: Iterable[Device]) -> None:
        """Serve devices at the next free index of their interfaces."""
        for device in devices:
            index = sum(addr.interf == device.addr.interf for addr in self.devices)
            self.add(device, index)


class Switchboard:
    """All ports and all subscriptions of a run."""

    def __init__(self) -> None:
        self.ports: dict[int, Port] = {}  # by the identity of the directory
        self.subscribers: dict[Device, dict[Connection, DeviceAddr]] = {}
        self.connections: dict[Connection, None] = {}
        self.changed = True  # what is wanted has changed since `wanted` was last read

    def add_port(self) -> Port:
        """A new port that serves nothing yet."""
        port = Port()
        self.ports[id(port.directory)] = port
        return port

    def port(self, connection: Connection) -> Port:
        """The port that a connection came in by."""
        return self.ports[id(connection.session.directory)]

    def stamp(self, time: float) -> None:
        """Replies carry this simulated time from now on."""
        for port in self.ports.values():
            port.directory.time = time

    def subscribe(self, connection: Connection, addr: DeviceAddr) -> Device:
        """A connection gets a device's data from now on."""
        device = self.port(connection).devices[addr]
        self.subscribers.setdefault(device, {})[connection] = addr
        self.connections[connection] = None
        self.changed = True
        return device

    def unsubscribe(self, connection: Connection, addr: DeviceAddr) -> Device:
        """A connection does not get a device's data any more."""
        device = self.port(connection).devices[addr]
        self.subscribers.get(device, {}).pop(connection, None)
        self.changed = True
        return device

    def forget(self, connection: Connection) -> list[Device]:
        """A connection is gone; the devices that it had subscribed."""
        had = [device for device, them in self.subscribers.items() if them.pop(connection, None)]
        self.connections.pop(connection, None)
        self.changed = True
        return had

    def command(self, connection: Connection, event: Command) -> None:
        """Pass a command to its device."""
        self.port(connection).devices[event.addr].command(event.name, event.message)

    def request(self, connection: Connection, event: Request) -> None:
        """Have a device answer a request: exactly one ACK or NACK goes out."""
        device = self.port(connection).devices[event.addr]
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
        except Refused:
            connection.session.refuse(event)
            return
        connection.session.acknowledge(event, None if reply is None else dict(reply))

    def wanted(self) -> list[Device]:
        """The devices that somebody has subscribed."""
        return [device for device, them in self.subscribers.items() if them]

    def publish(self, time: float) -> None:
        """Hand one tick's data to every session that has subscribed it."""
        for device, them in self.subscribers.items():
            if not them:
                continue
            for subtype, payload in device.publish():
                for connection, addr in them.items():
                    connection.session.publish(addr, subtype, payload, time)
        for connection in self.connections:
            connection.session.end_of_round()
