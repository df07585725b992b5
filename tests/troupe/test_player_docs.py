"""docs/player.md says what is served, request by request, and names only Python that exists."""

from __future__ import annotations

import inspect
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

import player
from player import DeviceAddr, Interface, MessageType, PlayerClient, PlayerRefused, messages
from player.xdr import Array, Octets, Record, Text
from tests.patience import PATIENCE
from tests.processes import ROOT, environment, troupe_command

PAGE = (ROOT / "docs" / "player.md").read_text(encoding="utf-8")

WORLD = """\
size: [10, 10]
models:
  report: &model
    body: {shape: box, size: [1, 1]}
    fiducial: 3
    sensors:
      - {type: laser, samples: 5}
      - {type: ranger, samples: 9}
      - {type: ranger, elements: [[0, 0, 0], [0, 0, 90]]}
      - {type: blobfinder}
      - {type: fiducial}
      - {type: bumper}
    actuators: [{type: sprayer}, {type: gripper}]
    battery: {capacity: 100}
  full:
    <<: *model
    simulation: full
robots:
  - {name: report, model: report, pose: [3, 3, 0], controller: hand}
  - {name: full, model: full, pose: [7, 7, 0], controller: hand}
controllers: {hand: {external: true}}
"""


def sections(page: str) -> dict[str, list[list[str]]]:
    """Interface -> the rows of its table of messages, each a list of cells."""
    found: dict[str, list[list[str]]] = {}
    for part in re.split(r"^### ", page, flags=re.MULTILINE)[1:]:
        heading = re.match(r"`(\w+)`", part)
        if heading:
            rows = re.findall(r"^\| (\w+ \d+ .*) \|$", part.split("\n## ")[0], re.MULTILINE)
            found[heading[1]] = [[cell.strip() for cell in row.split(" | ")] for row in rows]
    return found


SECTIONS = sections(PAGE)


def test_the_page_lists_every_message_of_every_interface_that_is_served() -> None:
    for interface, rows in SECTIONS.items():
        listed = {row[0] for row in rows}
        known = {
            f"{MessageType(spec.type).name} {spec.subtype} {spec.name}"
            for spec in messages.specs()
            if spec.interf == Interface[interface.upper()]
            and spec.type in (MessageType.DATA, MessageType.CMD, MessageType.REQ)
        }
        assert listed == known, interface


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, PlayerClient]]:
    """Clients of two robots in a run, with `simulation: report` and `full`."""
    world = tmp_path_factory.mktemp("served") / "world.yaml"
    world.write_text(WORLD.replace("<<: *model", _indented(WORLD)).replace(" &model", ""))
    run = subprocess.Popen(
        troupe_command("run", str(world), "--listen", "127.0.0.1:0"),
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    clients: dict[str, PlayerClient] = {}
    try:
        assert run.stderr is not None
        for line in run.stderr:
            served = re.search(r"(\w+) is served at 127\.0\.0\.1:(\d+)", line)
            if served:
                clients[served[1]] = PlayerClient(
                    "127.0.0.1", int(served[2]), timeout=PATIENCE, environ={}
                )
            if len(clients) == 2:
                break
        yield clients
    finally:
        for client in clients.values():
            client.close()
        run.terminate()
        run.communicate(timeout=PATIENCE)


def _indented(world: str) -> str:
    """The lines of the first model, for the second: world files have no merge keys."""
    return world.split("&model\n")[1].split("  full:", maxsplit=1)[0].strip()


def test_the_page_has_a_section_for_every_interface_that_a_run_serves(
    robots: dict[str, PlayerClient],
) -> None:
    served = {Interface(addr.interf).name.lower() for addr in robots["full"].devices()}
    assert served <= set(SECTIONS)
    assert set(SECTIONS) - served <= {"player", "log", "aio"}  # aio: only a sensor of one's own


@pytest.mark.parametrize("interface", [name for name in SECTIONS if name not in ("player", "aio")])
def test_every_request_is_answered_as_the_page_says(
    robots: dict[str, PlayerClient], interface: str
) -> None:
    for row in SECTIONS[interface]:
        kind, subtype, name = row[0].split()
        if kind != "REQ":
            continue
        answers = {
            robot: answer(client, Interface[interface.upper()], int(subtype), robot)
            for robot, client in robots.items()
        }
        said = row[1].split()[0]
        meant = dict.fromkeys(robots, said)
        if "`full`" in row[1]:
            meant["report"] = "NACK"
        assert answers == meant, f"{interface} {name}"


def test_requests_of_any_interface_are_answered_as_the_page_says(
    robots: dict[str, PlayerClient],
) -> None:
    for client in robots.values():
        for addr in client.devices():
            for subtype in range(247, 255):
                answers = answer(client, Interface(addr.interf), subtype, "", addr.index)
                assert answers == "NACK", f"{addr}, property request {subtype}"
            for type_, subtype, known in ((3, 1, True), (2, 1, True), (3, 99, False)):
                listed = messages.find(addr.interf, type_, subtype) is not None and known
                message = {"type": type_, "subtype": subtype}
                if listed:
                    client.request(addr, 255, message)
                else:
                    with pytest.raises(PlayerRefused):
                        client.request(addr, 255, message)


def answer(
    client: PlayerClient, interface: Interface, subtype: int, robot: str, index: int = 0
) -> str:
    """ACK or NACK; every request of the table is sent to a real run."""
    addr = DeviceAddr(interface, index)
    spec = messages.find(interface, MessageType.REQ, subtype)
    assert spec is not None
    values = {name: example(name, kind, robot) for name, kind in spec.fields}
    if spec.name == "set_config":
        getter = {Interface.LASER: 3, Interface.RANGER: 5}[interface]
        values = client.request(addr, getter)
    try:
        client.request(addr, subtype, values)
    except PlayerRefused:
        return "NACK"
    return "ACK"


def example(name: str, kind: Any, robot: str) -> Any:
    """What a field of a request carries: something sensible."""
    if isinstance(kind, Record):
        return kind.make(*[1.0] * len(kind.scalars))
    if isinstance(kind, Octets):
        return bytes(16)  # a colour's four floats
    if isinstance(kind, Text):
        return {"name": robot, "property": "color"}.get(name, "x")
    return [] if isinstance(kind, Array) else 0


# -- the table of libplayerc++ ------------------------------------------------------------------

CALLS = [
    [cell.strip() for cell in row.split(" | ")]
    for row in re.findall(
        r"^\| (`\w+.*) \|$", PAGE.split("## libplayerc++ and Python")[-1], re.MULTILINE
    )
]


def test_every_python_name_beside_a_call_of_libplayercpp_exists() -> None:
    assert len(CALLS) > 60
    for cpp, python, *_ in CALLS:
        for name in re.findall(r"`([^`]+)`", python):
            words = re.match(r"(\w+)(?:\.(\w+))?", name)
            assert words, (cpp, name)
            owner = getattr(player, words[1], None)
            assert owner is not None, f"{cpp}: {name}"
            if words[2]:
                assert words[2] in members(owner), f"{cpp}: {name}"


@cache
def members(owner: Any) -> set[str]:
    """Attributes of a class, those that `__init__` sets and fields of named tuples too."""
    found = set(dir(owner))
    for base in owner.__mro__:
        if base.__module__.startswith("player."):
            body = inspect.getsource(base)
            found |= set(re.findall(r"self\.(\w+)(?:: [^=]+)? = ", body))
    return found


def test_every_public_member_of_our_proxies_is_in_the_table() -> None:
    named = set(
        re.findall(r"(\w+Proxy|PlayerClient)\.(\w+)", " ".join(" ".join(row[1:]) for row in CALLS))
    )
    own = {"decode", "take", "alike", "varying", "subscribe", "unsubscribe", "command", "queue"}
    own |= {"request", "lie", "settle"}
    for name in player.__all__:
        if name.endswith("Proxy") and name != "Proxy":
            public = {
                member for member in vars(getattr(player, name)) if not member.startswith("_")
            }
            missing = public - own - {"interface", "addr"} - {m for p, m in named if p == name}
            assert not missing, f"{name}: {missing}"
