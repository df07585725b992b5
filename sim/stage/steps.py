"""A tick's steps of physics as one compiled loop around Chipmunk's own step."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.stage import drive
from sim.stage.compiled import bare, compiled
from sim.stage.intrinsics import (
    floats_at,
    for_each,
    ints_at,
    set_iterations,
    step_space,
    words_at,
)
from sim.stage.limits import DEEPEST
from sim.stage.may_touch import count_calm_ticks
from sim.stage.memory import read_bodies
from sim.stage.substeps import count_substeps

STEP, EACH_ARBITER, SET_ITERATIONS, READ_ARBITER = range(4)
"""Where the addresses of functions stand in `machine`: first, as `chipmunk.FUNCTIONS` has them."""
SPACE, TOUCH_DATA, TOUCH_WORDS, TOUCH_FLOATS = range(4, 8)
"""Then come the addresses of what they work on: see `chipmunk`."""
PARTS = 8
"""The length of `machine`."""

CONTACT = 12
"""Numbers of a contact: the ids of two bodies, how many points they share, x and y of up to two
points on either's surface (2, 2, 2), and in which of the tick's substeps it was."""

Place = tuple[int, float, bool]
"""How far a tick has come: see `run_steps`."""
BEGIN: Place = (0, -1.0, False)


@compiled
def _widened(array: Any, rows: int) -> Any:
    wider = np.empty((max(2 * array.shape[0], rows, 16), *array.shape[1:]), dtype=array.dtype)
    wider[: array.shape[0]] = array
    return wider


@compiled
def _read_contacts(machine: Any, contacts: Any, rows: int, more: int, number: int) -> None:
    """Write the contacts that Chipmunk has told to the `more` rows from `rows` on."""
    words = words_at(words_at(machine[TOUCH_WORDS])[1])
    floats = floats_at(words_at(machine[TOUCH_FLOATS])[1])
    for k in range(more):
        contact = contacts[rows + k]
        for column in range(3):
            contact[column] = words[3 * k + column]
        for column in range(8):
            contact[3 + column] = floats[8 * k + column]
        contact[CONTACT - 1] = number


@compiled
def run_steps(
    place: Any,
    traced: Any,
    machine: Any,
    state: Any,
    movers: Any,
    first: int,
    count: int,
    order: Any,
    cells: Any,
    frame: Any,
    outlines: Any,
    sides: Any,
    interval: float,
    steps: int,
    poses: Any,
    velocities: Any,
    distances: Any,
    stalls: Any,
) -> Any:
    """Make `steps` steps in `interval` seconds, each cut as finely as bodies that meet need.

    machine (PARTS,): addresses. movers: `first` movable obstacles, then robots up to `count`, with
    their state (count, 6) as `memory` reads it. order (count,): the movers by x, kept from step to
    step. cells, frame: the distance field of what stands. outlines (s, k, 2) with sides (s,): the
    movers' shapes. poses, velocities, distances, stalls: the robots', written at the end of the
    tick. traced (k,): the movers whose poses are noted. Those out of Chipmunk's space make a step
    in one.

    place: the step to go on with, how fast (m/s) the fastest may be that was assumed when it was
    found who may meet something (negative: look around first), and whether the drives have taken
    this step in already. Where movers must come into the space or leave it the loop returns, to be
    called again with the place that it returns; at the end that is behind the last step.

    Returns the place; the contacts (t, CONTACT) of all substeps; and the notes (m, k, 3) of x, y
    and yaw, at the beginning of the tick and after every substep.
    """
    machine, state, movers, order = bare(machine), bare(state), bare(movers), bare(order)
    cells, outlines, sides = bare(cells), bare(outlines), bare(sides)
    contacts = np.empty((0, CONTACT))
    notes = np.empty((0, len(traced), 3))
    rows, noted, number = 0, 0, 0
    step, fastest, led = place
    dt = interval / steps
    space = machine[SPACE]
    if fastest < 0.0:
        changes, fastest = count_calm_ticks(state, movers, count, order, cells, frame, interval)
        if changes > 0:
            return (0, fastest, False), contacts, notes
    if step == 0 and not led and len(traced) > 0:
        notes = _widened(notes, 1)
        for k in range(len(traced)):
            notes[0, k] = state[traced[k], :3]
        noted = 1
    while step < steps:
        if not led:
            drive.want(state, movers, count, dt)
        cuts, rounds, quickest = count_substeps(
            state, movers, count, order, cells, frame, outlines, sides, dt
        )
        # Thrown by something that turns, so that it could meet who was not looked at.
        if not led and (quickest - fastest) * interval > DEEPEST:
            changes, fastest = count_calm_ticks(state, movers, count, order, cells, frame, interval)
            if changes > 0:
                led = True
                break
            cuts, rounds, quickest = count_substeps(
                state, movers, count, order, cells, frame, outlines, sides, dt
            )
        led = False
        substep = dt / max(1, cuts)
        drive.lead(state, movers, count, dt, substep)
        moving = quickest >= 0.0
        set_iterations(machine[SET_ITERATIONS], space, np.int32(rounds))
        for _ in range(max(1, cuts)):
            if moving:
                step_space(machine[STEP], space, substep)
            if len(traced) > 0:
                read_bodies(state, movers, count)
                if noted == notes.shape[0]:
                    notes = _widened(notes, noted + 1)
                for k in range(len(traced)):
                    notes[noted, k] = state[traced[k], :3]
                noted += 1
            if cuts == 0:
                continue
            words, floats = ints_at(machine[TOUCH_WORDS]), ints_at(machine[TOUCH_FLOATS])
            words[0], floats[0] = 0, 0
            for_each(machine[EACH_ARBITER], space, machine[READ_ARBITER], machine[TOUCH_DATA])
            more = words[0] // 3
            if more == 0:
                continue
            if rows + more > contacts.shape[0]:
                contacts = _widened(contacts, rows + more)
            _read_contacts(machine, contacts, rows, more, number)
            rows += more
            number += 1
        if len(traced) == 0:
            read_bodies(state, movers, count)
        drive.account(state, movers, count, dt)
        step += 1
    if step == steps:
        drive.report(state, movers, first, count, interval, poses, velocities, distances, stalls)
    return (step, fastest, led), contacts[:rows], notes[:noted]
