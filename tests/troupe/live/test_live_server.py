"""Who is let in, who is cut off, and that whoever watches changes nothing."""

from __future__ import annotations

import http.client
import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from typer.testing import CliRunner
from watching import STILL, Viewer, Watched, stepped, watched
from websockets.exceptions import ConnectionClosed, InvalidStatus

import troupe
from sim.view.frames import STATUS
from tests.patience import PATIENCE
from troupe.app import app
from troupe.live.entrance import answer, known_host


def get(address: str, path: str | None = None, **headers: str) -> http.client.HTTPResponse:
    """Ask for a path at the view's address."""
    parts = urlsplit(address)
    assert parts.hostname is not None
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=PATIENCE)
    connection.request("GET", parts.path if path is None else path, headers=headers)
    return connection.getresponse()


@pytest.fixture(scope="module")
def paused(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    """A run that stands, for all that try to get in."""
    world = tmp_path_factory.mktemp("paused") / "still.yaml"
    world.write_text(STILL)
    with watched(world, paused=True) as run:
        yield run


def test_the_page_is_served_below_its_token_and_nowhere_else(paused: Watched) -> None:
    page = get(paused.address)
    assert page.status == 200
    assert b"<canvas" in page.read()
    assert "script-src 'self'" in (page.headers["Content-Security-Policy"] or "")
    assert get(paused.address, urlsplit(paused.address).path + "main.js").status == 200
    for path in ("/", "/wrong/", "/main.js", urlsplit(paused.address).path + "../../etc/passwd"):
        assert get(paused.address, path).status == 404


def test_no_page_of_another_site_gets_in(paused: Watched) -> None:
    assert get(paused.address, Host="evil.example").status == 421
    assert get(paused.address, Host="localhost:9999").status == 200  # as with ssh -L
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1"):
        with pytest.raises(InvalidStatus):
            Viewer(paused.address, Origin=origin)
    own = f"http://{urlsplit(paused.address).netloc}"
    assert Viewer(paused.address, Origin=own).message().kind == 1
    with pytest.raises(InvalidStatus):
        Viewer(paused.address.rstrip("/") + "x/")


@pytest.mark.parametrize(
    ("host", "bound", "known"),
    [
        ("127.0.0.1:7000", "127.0.0.1", True), ("localhost", "127.0.0.1", True),
        ("[::1]:7000", "::1", True), ("rebound.example:7000", "127.0.0.1", False),
        ("192.168.1.5:7000", "127.0.0.1", False), ("192.168.1.5:7000", "0.0.0.0", True),
        ("rebound.example", "0.0.0.0", False), ("", "127.0.0.1", False),
    ],
)  # fmt: skip
def test_only_hosts_that_are_this_machine_are_known(host: str, bound: str, known: bool) -> None:
    assert known_host(host, bound) is known
    found = answer("t", bound, "/t/", {"Host": host})
    assert (found is not None and found.status == 200) is known


def test_who_floods_is_cut_off_alone(paused: Watched) -> None:
    other, flood = Viewer(paused.address), Viewer(paused.address)
    with pytest.raises(ConnectionClosed):
        flood.flood()
    assert stepped(other)


@pytest.mark.parametrize(
    "data", ["nonsense", b"\0\1\2", "x" * 100_000, '{"do": "fly"}', "[" * 4000]
)
def test_who_sends_garbage_is_cut_off_alone(paused: Watched, data: str | bytes) -> None:
    other, garbler = Viewer(paused.address), Viewer(paused.address)
    garbler.socket.send(data)
    with pytest.raises(ConnectionClosed):
        garbler.until(lambda m: False)
    assert stepped(other)


def test_bytes_that_are_no_http_hold_nobody_up(paused: Watched) -> None:
    parts = urlsplit(paused.address)
    with socket.create_connection((parts.hostname, parts.port)) as raw:
        raw.sendall(b"\xff" * 10_000)
        viewer = Viewer(paused.address)
        assert stepped(viewer)


def test_who_may_only_watch_reaches_nothing(still: Path) -> None:
    with watched(still, read_only=True, realtime=2) as run:
        viewer = Viewer(run.address)
        assert viewer.message().json(1)["read_only"] is True
        viewer.ask(do="pause")
        viewer.ask(do="put", robot=0, pose=[3.0, 5.0, 0.0])
        viewer.ask(do="select", robots=[0])
        found = viewer.until(lambda m: 17 in m.sections)
        assert found.json(17)["0"]["name"] == "anna"
        assert viewer.until(lambda m: m.tick > found.tick + 2).poses[0, 0] == 2.0
    assert run.result().touched == []


def test_a_selected_robot_shows_all_its_sensors_and_who_looks_changes_nothing(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[1])
        found = viewer.until(lambda m: 17 in m.sections)
        (fan,) = found.fans
        assert (fan.robot, fan.sensor, len(fan.ranges)) == (1, 0, 91)
        assert fan.ranges[45] == pytest.approx(2.0, abs=1e-6)  # to the wall at x = 10
        card = found.json(17)["1"]
        assert [sensor["kind"] for sensor in card["sensors"]] == [
            "scan", "elements", "blobs", "fiducials", "bits",
        ]  # fmt: skip
        assert all(len(found.sections[number]) > 0 for number in (7, 8, 9, 10, 11))


def test_what_the_run_ended_with_arrives() -> None:
    with watched("wander", duration=1.0, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="go")
        last = viewer.until(
            lambda m: STATUS in m.sections and m.json(STATUS)["outcome"] is not None
        )
        assert last.json(STATUS)["outcome"] == "completed"
        assert last.tick == 10
        with pytest.raises(ConnectionClosed) as caught:
            viewer.message()
    assert caught.value.rcvd is not None
    assert caught.value.rcvd.reason == "the run is over"


def test_without_a_view_there_is_no_server_and_nothing_of_it_is_loaded() -> None:
    code = (
        "import sys, troupe; troupe.run('wander', duration=0.2); "
        "print([m for m in sys.modules if m.split('.')[0] == 'websockets' "
        "or m.startswith(('troupe.live', 'asyncio'))])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert done.stdout.strip() == "[]", done.stderr


def test_the_command_tells_the_address_and_takes_one() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = ["run", "wander", "--duration", "0.5", "--json", "--no-open"]
    done = CliRunner().invoke(app, [*words, "--view", f"127.0.0.1:{port}"])
    assert done.exit_code == 0, done.stderr
    assert f"watch it at http://127.0.0.1:{port}/" in done.stderr
    assert json.loads(done.stdout)["touched"] == []


@pytest.mark.parametrize("address", ["nowhere.invalid:1", "127.0.0.1:99999", "127.0.0.1:1"])
def test_an_address_that_cannot_be_had_is_bad_usage(address: str) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        if address == "127.0.0.1:1":
            address = f"127.0.0.1:{taken.getsockname()[1]}"
        done = CliRunner().invoke(app, ["run", "wander", "--view", address, "--no-open"])
    assert done.exit_code == 2, done.stderr
    assert f"cannot listen on {address}" in done.stderr or "must be HOST:PORT" in done.stderr
    assert ("another port" in done.stderr) == ("in use" in done.stderr)
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("option", ["--no-open", "--read-only"])
def test_a_page_that_is_not_there_is_not_spoken_of(option: str) -> None:
    done = CliRunner().invoke(app, ["run", "wander", "--duration", "0.3", option])
    assert done.exit_code == 2
    assert option in done.stderr
    assert "--view" in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["wander", "--view", "no:where"],
        ["--view", "no:where", "wander"],
        ["wander", "--view=no:where"],
        ["wander", "--view", "nowhere"],
    ],
)
def test_an_address_that_is_none_is_named(words: list[str]) -> None:
    done = CliRunner().invoke(app, ["run", *words, "--no-open"])
    assert done.exit_code == 2
    assert "must be HOST:PORT" in done.stderr
    assert "where'" in done.stderr


def test_the_address_of_a_view_is_named_as_it_was_given(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    troupe.run("wander", duration=0.3, log=log)
    for what in ("wander", str(log)):
        done = CliRunner().invoke(app, ["view", what, "--at", "no:where", "--no-open"])
        assert done.exit_code == 2
        assert done.stderr.startswith("at 'no:where': must be HOST:PORT")


@pytest.mark.parametrize("where", ["nan", "-1", "1e99", "", "inf", "3s", "1_0", "\u0661"])
def test_where_a_log_is_to_begin_is_a_number_of_seconds(where: str) -> None:
    done = CliRunner().invoke(app, ["view", f"run.mcap#t={where}", "--no-open"])
    assert done.exit_code == 2
    assert "run.mcap#t=12.5" in done.stderr
    assert "no such world" not in done.stderr
