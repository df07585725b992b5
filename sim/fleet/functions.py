"""Controllers that are Python functions, called once a tick in this process.

A function gets the robot's own end of Player's protocol without a socket between: the same
proxies, the same devices, the same payloads. So what it reads and commands is, to the last bit,
what a program in a process of its own would read and command.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from player import DeviceAddr, PlayerRefused, messages
from player.codes import MessageType
from player.header import HEADER, HEADER_SIZE
from sim.devices.device import Context, Device, Refused
from sim.devices.switchboard import Port
from sim.result import Result

if TYPE_CHECKING:
    from player import PlayerClient, Proxy, Robot

Controller = Callable[["Robot"], None]
Controllers = bool | Mapping[str, Controller | bool]
"""True: those of the world; False: none; or by name, whether one is started, or a function."""


class FunctionError(Exception):
    """A controller function has raised: which robot's, and at which tick."""

    def __init__(self, robot: str, tick: int, time: float, cause: BaseException) -> None:
        self.robot, self.tick = robot, tick
        self.result: Result | None = None  # of the run until then
        super().__init__(
            f"the controller of {robot} raised at tick {tick} ({time:g} s): "
            f"{type(cause).__name__}: {cause}"
        )


class DirectClient:
    """What proxies need of a PlayerClient, joined to a robot's devices without a socket.

    `sense(device)` is called when a device is subscribed, so that its reading of this tick is
    there at once, and `answered(device)` when it has answered a request.
    """

    index = 0

    def __init__(
        self,
        name: str,
        seed: int,
        port: Port,
        sense: Callable[[Device], None],
        answered: Callable[[Device], None],
        context: Context,
    ) -> None:
        self.name = name
        self.seed = seed
        self.time = 0.0
        self.port = port
        self.address = f"{name}, in this process"
        self.ending = ""
        self._sense = sense
        self._answered = answered
        self._context = context
        self._routes: dict[Device, tuple[DeviceAddr, list[Proxy]]] = {}
        self._rng: np.random.Generator | None = None

    def rng(self) -> np.random.Generator:
        """The robot's random generator: the same one at each call."""
        if self._rng is None:
            self._rng = np.random.default_rng([self.seed])
        return self._rng

    def devices(self) -> list[DeviceAddr]:
        """The robot's devices."""
        return list(self.port.devices)

    def _device(self, addr: DeviceAddr) -> Device:
        device = self.port.devices.get(DeviceAddr(int(addr.interf), addr.index))
        if device is None:
            there = ", ".join(map(str, self.devices())) or "none"
            raise PlayerRefused(f"{self.name} has no device {addr} (its devices: {there})")
        return device

    def subscribe(self, proxy: Proxy) -> str:
        """The proxy has the device's data from now on, and that of this tick at once."""
        device = self._device(proxy.addr)
        new = device not in self._routes
        self._routes.setdefault(device, (proxy.addr, []))[1].append(proxy)
        if new:
            self._sense(device)
        if self.time > 0.0:
            for subtype, payload in device.publish():
                proxy.take(subtype, payload, self.time)
        return "troupe"

    def unsubscribe(self, proxy: Proxy) -> None:
        """The proxy keeps its last data."""
        device = self._device(proxy.addr)
        _, proxies = self._routes[device]
        proxies.remove(proxy)
        if not proxies:
            del self._routes[device]

    @property
    def subscribed(self) -> list[Device]:
        """The devices whose data the function reads."""
        return list(self._routes)

    def deliver(self, time: float) -> None:
        """Hand this tick's data to the proxies."""
        self.time = time
        for device, (_, proxies) in self._routes.items():
            for proxy in proxies:
                proxy.fresh = False
            for subtype, payload in device.publish():
                for proxy in proxies:
                    proxy.take(subtype, payload, time)

    def command(self, addr: DeviceAddr, subtype: int, message: Mapping[str, Any]) -> None:
        """Obey a command as if it had come over the wire."""
        spec = messages.find(addr.interf, MessageType.CMD, subtype)
        assert spec is not None
        self._obey(addr, subtype, spec.encode(message))

    def queue(self, data: bytes) -> None:
        """Obey a command that is encoded already, header and all."""
        _, _, interf, index, _, subtype, *_ = HEADER.unpack_from(data)
        self._obey(DeviceAddr(interf, index), subtype, data[HEADER_SIZE:])

    def _obey(self, addr: DeviceAddr, subtype: int, payload: bytes) -> None:
        spec = messages.find(addr.interf, MessageType.CMD, subtype)
        assert spec is not None
        self._device(addr).command(spec.name, spec.decode(payload))
        self._complain()

    def _complain(self) -> None:
        """What makes no sense is an error where it was said, and not a line for people."""
        complaints = [what for _, what in self._context.complaints]
        self._context.complaints.clear()
        if complaints:
            raise ValueError(f"{self.name} was sent {complaints[0]}")

    def request(
        self, addr: DeviceAddr, subtype: int, message: Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        """Answer a request as if it had come over the wire; raises PlayerRefused."""
        spec = messages.find(addr.interf, MessageType.REQ, subtype)
        assert spec is not None
        device = self._device(addr)
        try:
            reply = device.request(spec.name, spec.decode(spec.encode(message or {})))
        except Refused:
            self._complain()
            raise PlayerRefused(f"{self.name} refused the request {spec.name} of {addr}") from None
        self._answered(device)
        answer = messages.find(addr.interf, MessageType.ACK, subtype)
        if reply is None or answer is None:
            return {}
        return dict(answer.decode(answer.encode(reply)))


class Functions:
    """The controllers of a run that are functions, in the order of robots."""

    def __init__(self) -> None:
        self.robots: dict[int, tuple[Robot, DirectClient, Controller]] = {}

    def add(self, index: int, client: DirectClient, function: Controller) -> None:
        """Robot `index` is driven by a function from the next tick on."""
        from player import Robot  # noqa: PLC0415 - loads all proxies, which few runs need

        self.robots[index] = (Robot(cast("PlayerClient", client)), client, function)

    def subscribed(self) -> list[Device]:
        """The devices that functions read."""
        return [d for _, client, _ in self.robots.values() for d in client.subscribed]

    def call(self, tick: int, time: float) -> list[int]:
        """Call every function with this tick's data; the robots whose work is done.

        Raises FunctionError for the first that raises.
        """
        done = []
        for index, (robot, client, function) in list(self.robots.items()):
            client.deliver(time)
            try:
                function(robot)
            except Exception as error:
                raise FunctionError(client.name, tick, time, error) from error
            if robot.finished:
                done.append(index)
                del self.robots[index]
        return done


__all__ = ["Controller", "Controllers", "DirectClient", "FunctionError", "Functions"]
