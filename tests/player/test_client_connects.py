"""Where a client connects: arguments, environment, inherited sockets; and its generator."""

import os
import socket
import struct

import numpy as np
import pytest
from scripted_server import scripted, scripted_port
from wire_talk import (
    BANNER,
    LASER,
)

from player import (
    LaserProxy,
    PlayerClient,
    PlayerDisconnected,
    PlayerTimeout,
)


def test_over_tcp_by_arguments_and_by_the_environment():
    for use_environment in (False, True):
        with scripted_port(lambda talk: talk.greet()) as (host, port):
            environ = {"PLAYER_HOST": host, "PLAYER_PORT": str(port), "PLAYER_ROBOT": "r1"}
            if use_environment:
                client = PlayerClient(environ=environ)
            else:
                client = PlayerClient(host, port, environ={"PLAYER_FD": "77"})
            assert client.timeout == 5.0  # as Player's own client waits
            assert client.name == ("r1" if use_environment else "")
            assert str(port) in repr(client)
            client.close()


def test_nobody_listening_is_said_with_the_address():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(PlayerDisconnected, match=f"127.0.0.1:{port}: .*refused .*is it running"):
        PlayerClient("127.0.0.1", port)


def test_a_server_that_says_nothing_times_out():
    with (
        socket.create_server(("127.0.0.1", 0)) as mute,
        pytest.raises(PlayerTimeout, match="the banner"),
    ):
        PlayerClient(*mute.getsockname(), timeout=0.01)


@pytest.mark.parametrize(("told", "seconds"), [("", 5.0), ("2.5", 2.5), ("60", 60.0), ("0", None)])
def test_the_time_limit_of_a_server_over_tcp_is_the_environments(told, seconds):
    for given in ({}, {"timeout": 7.0}):
        with scripted_port(lambda talk: talk.greet()) as (host, port):
            environ = {"PLAYER_HOST": host, "PLAYER_PORT": str(port), "PLAYER_TIMEOUT": told}
            with PlayerClient(environ=environ, **given) as robot:
                assert robot.timeout == given.get("timeout", seconds)


def test_an_inherited_socket_is_found_taken_once_and_not_handed_on():
    with scripted(lambda talk: talk.greet()) as sock:
        fd = os.dup(sock.fileno())
        os.set_inheritable(fd, True)
        environ = {"PLAYER_FD": str(fd), "PLAYER_ROBOT": "r2", "PLAYER_SEED": "42"}
        robot = PlayerClient(environ=environ)
        assert robot.timeout is None
        assert (robot.name, robot.seed, robot.index) == ("r2", 42, 0)
        assert not os.get_inheritable(fd)
        with pytest.raises(PlayerDisconnected, match="has the robot's socket already"):
            PlayerClient(environ=environ)
        robot.close()
        with pytest.raises(PlayerDisconnected, match=f"PLAYER_FD={fd}"):
            PlayerClient(environ=environ)


def test_proxies_take_the_robots_index_unless_told():
    def script(talk):
        talk.greet()
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", LASER, 3)
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", LASER, 0)

    with scripted(script) as sock:
        environ = {"PLAYER_FD": str(os.dup(sock.fileno())), "PLAYER_INDEX": "3"}
        with PlayerClient(environ=environ) as robot:
            LaserProxy(robot)
            LaserProxy(robot, 0)


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("PLAYER_PORT", "port"),
        ("PLAYER_PORT", "70000"),
        ("PLAYER_FD", "-1"),
        ("PLAYER_SEED", "x"),
        ("PLAYER_TIMEOUT", "soon"),
        ("PLAYER_TIMEOUT", "-1"),
        ("PLAYER_TIMEOUT", "inf"),
    ],
)
def test_a_variable_that_makes_no_sense_is_named(variable, value):
    with pytest.raises(PlayerDisconnected, match=f"{variable}='{value}'"):
        PlayerClient(environ={variable: value})


def test_a_file_is_not_a_robot(tmp_path):
    with (
        (tmp_path / "file").open("w") as file,
        pytest.raises(PlayerDisconnected, match="is not a socket"),
    ):
        PlayerClient(environ={"PLAYER_FD": str(file.fileno())})


def test_the_random_generator_repeats_by_seed_and_is_one():
    draws = []
    for seed in ("7", "7", "8"):
        with scripted(lambda talk: talk.greet()) as sock:
            environ = {"PLAYER_FD": str(os.dup(sock.fileno())), "PLAYER_SEED": seed}
            with PlayerClient(environ=environ) as robot:
                assert robot.rng() is robot.rng()
                draws.append(robot.rng().random(3))
    assert np.array_equal(draws[0], draws[1])
    assert not np.array_equal(draws[0], draws[2])


def test_the_mode_is_one_of_two():
    with (
        scripted(lambda talk: talk.sock.sendall(BANNER)) as sock,
        pytest.raises(ValueError, match="'pull' or 'push'"),
    ):
        PlayerClient(sock=sock, mode="poll")
