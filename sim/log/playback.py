"""A run that is played from its log: what there was to show at each tick, as the run itself had it.

What robots perceived is not in every log, and needs not be: it follows from where all stood, the
seed and the tick, so it is sensed again, and to the last bit.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, get_args

import numpy as np

from sim.log import contents
from sim.log.errors import LogError
from sim.log.reader import LogReader
from sim.log.source import DAMAGES
from sim.log.states import State, States, state_of
from sim.log.track import Paint, Track
from sim.log.world import loaded_again, own_sensors
from sim.showing import Backdrops, drawings_of, movables_of
from sim.stage.standing import Pose
from sim.surroundings import Surroundings
from sim.video.snapshot import DrawingKind
from sim.view.figure import Figure
from sim.view.present import ENDED, Present

KINDS = get_args(DrawingKind)


class Playback:
    """Shows the ticks of a log in any order; quickest in their own.

    Raises LogError for a log of whose run nothing can be shown.
    """

    def __init__(self, reader: LogReader) -> None:
        self.reader = reader
        files = reader.attachments()
        self.loaded = loaded_again(files, reader.path, reader.about.get("title"))
        self.own = own_sensors(files)
        self.seed = reader.whole("seed")
        self.interval = self.loaded.world.clock.interval
        self.states = States(reader, self.interval)
        if not len(self.states):
            raise LogError(f"{reader.path}: the run has no tick in it: there is nothing to show")
        self.entries = contents.entries(reader)
        models = self.loaded.world.models
        if any(entry.model not in models for entry in self.entries):
            raise reader.damaged("a robot is of no known model")
        self.names = [entry.name for entry in self.entries]
        self.models = [models[entry.model] for entry in self.entries]
        self.movables = movables_of(self.loaded)
        self._surroundings = Surroundings(self.loaded.layout, self.seed)
        self._said: dict[int, tuple[float, str]] = {}
        self._state: dict[int, str] = {}
        self._figures: dict[int, list[Figure]] = {}
        self._read: list[tuple[int, int]] = []
        self._fixtures: dict[int, Pose] = {}  # where hands have put them, by number
        self.layout = self.loaded.layout
        """What stands, where it stood in what was shown last."""
        self._backdrops = Backdrops(self.loaded)
        self._known = self.layout  # by the surroundings
        try:
            self._tracks: list[Track[Any]] = [
                Track(self._sayings(), self._take_said, self._said.clear),
                Track(self._drivers(), self._take_state, self._state.clear),
                Track(self._drawn(), self._take_drawn, self._figures.clear),
                Track(self._sensed(), self._take_sensed, lambda: self._take_sensed(())),
                Track(self._put(), self._take_put, lambda: self._take_put(None)),
            ]
        except LogError:
            raise
        except DAMAGES as error:
            raise reader.damaged(error) from None
        self._paint = Paint(reader)

    @cached_property
    def last(self) -> State | None:
        """How all stood when the run was over; None where it was killed before."""
        found = [one for _, one in self.reader.messages("/troupe/last")]
        return state_of(found[-1], self.interval) if found else None

    def present(self, k: int) -> Present:
        """What there was to show after the k-th tick of the log, from 0."""
        state = self.states[k]
        return self._present(state, state.tick, state)

    def end(self) -> Present:
        """What there was to show when the run was over."""
        state = self.states[len(self.states) - 1]
        until = state.tick if self.last is None else state.tick + 1
        return self._present(self.last or state, until, state)

    def _present(self, state: State, until: int, sensed: State) -> Present:
        """A state with all that had happened by a tick, and what was sensed in a state."""
        count = len(state.poses)
        if count > len(self.names):
            raise self.reader.damaged("a robot has never entered")
        for track in self._tracks:
            track.go(until)
        self._paint.go(until)
        paints = not np.isnan(state.coverage)
        settled = [self.driver_state(robot) in ENDED for robot in range(count)]
        return Present(
            time=state.time,
            tick=state.tick,
            names=self.names[:count],
            models=self.models[:count],
            poses=state.poses,
            colors=state.colors.astype(np.int64),
            settled=np.array(settled, bool),
            stalls=state.stalls,
            said=[self._said.get(robot) for robot in range(count)],
            drawings=drawings_of(self.figures(count), state.poses),
            groups=self.sense(sensed).suite.groups,
            movables=self.movables,
            movable_poses=state.movable_poses,
            floor=self._paint.owner if paints else None,
            resolution=self._paint.resolution or self.loaded.world.floor.resolution,
            coverage=float(state.coverage) if paints else None,
            backdrop=self._backdrops.of(self.layout),
        )

    def figures(self, count: int) -> list[list[Figure]]:
        """What the programs of the first robots had drawn in what was shown last."""
        return [self._figures.get(robot, []) for robot in range(count)]

    @property
    def worn(self) -> int:
        """A number that changes whenever the floor that is shown does."""
        return self._paint.at

    def running(self, count: int) -> int:
        """How many of the first robots' controllers drive, in what was shown last."""
        return sum(self.driver_state(robot) == "running" for robot in range(count))

    def driver_state(self, robot: int) -> str:
        """What a robot's controller was at in what was shown last, `running` say."""
        return self._state.get(robot, "")

    def sense(self, state: State, *, everything: frozenset[int] = frozenset()) -> Surroundings:
        """All that is perceived in a state; `everything`: robots with sensors that nobody read."""
        count = len(state.poses)
        if count < self._surroundings.count:  # robots that have not entered are not to be seen
            self._surroundings = Surroundings(self.loaded.layout, self.seed)
            self._known = self.loaded.layout
        around = self._surroundings
        for robot in range(around.count, count):
            around.add_robot(self.names[robot], self.models[robot], state.poses[robot])
        around.scene.colors[around.entities] = state.colors
        if self._known is not self.layout:
            self._known = self.layout
            for number, fixture in enumerate(self.layout.fixtures):
                around.put_fixture(number, fixture.pose)
        around.refresh(state.poses, state.movable_poses)
        suite = around.suite
        wanted = np.zeros(suite.slots, bool)
        firsts = [*suite.first_slot, suite.slots]
        for robot, sensor in self._read:
            if robot < count and sensor < firsts[robot + 1] - firsts[robot]:
                wanted[firsts[robot] + sensor] = True
        for robot in everything:
            if robot < count:
                wanted[firsts[robot] : firsts[robot + 1]] = True
        for robot in range(count) if self.own else ():
            for sensor in self.own.get(self.entries[robot].model, ()):
                wanted[firsts[robot] + sensor] = False
        suite.sense(state.tick, state.time, wanted)
        return around

    # --- what happened, and by which tick it showed

    def _sayings(self) -> Any:
        for _, one in self.reader.messages("/troupe/said"):
            # what is said between two ticks shows at the end of the second one
            tick = round(one["time"] / self.interval) + 1
            yield tick, (one["robot"], (one["time"], one["text"]))

    def _take_said(self, one: tuple[int, tuple[float, str]]) -> None:
        self._said[one[0]] = one[1]

    def _drivers(self) -> Any:
        for _, one in self.reader.messages("/troupe/entries"):
            yield one["tick"], (one["robot"], one["controller"])
        for _, one in self.reader.messages("/troupe/controllers"):
            yield one["tick"], (one["robot"], one["state"])

    def _take_state(self, one: tuple[int, str]) -> None:
        self._state[one[0]] = one[1]

    def _drawn(self) -> Any:
        for _, one in self.reader.messages("/troupe/drawings"):
            if any(shape["kind"] not in KINDS for shape in one["shapes"]):
                raise ValueError("a drawing is of no known kind")
            figures = [
                Figure(
                    shape["kind"],
                    shape["points"].reshape(-1, 2),
                    shape["color"],
                    shape["fill_color"] if shape["filled"] else None,
                )
                for shape in one["shapes"]
            ]
            yield one["tick"], (one["robot"], figures)

    def _take_drawn(self, one: tuple[int, list[Figure]]) -> None:
        self._figures[one[0]] = one[1]

    def _put(self) -> Any:
        first, count = len(self.movables), len(self.loaded.layout.fixtures)
        for _, one in self.reader.messages("/troupe/hands"):
            poses = one["poses"].reshape(-1, 3).tolist()
            things = zip(one["numbers"].tolist(), one["things"].tolist(), poses, strict=True)
            for number, thing, pose in things:
                if thing and first <= number < first + count:
                    yield one["tick"], (number - first, tuple(pose))

    def _take_put(self, one: tuple[int, Pose] | None) -> None:
        if one is None:
            self._fixtures.clear()
        else:
            self._fixtures[one[0]] = one[1]
        layout = self.loaded.layout
        self.layout = layout.moved(self._fixtures) if self._fixtures else layout

    def _sensed(self) -> Any:
        for _, one in self.reader.messages("/troupe/sensed"):
            pairs = zip(one["robots"].tolist(), one["sensors"].tolist(), strict=True)
            yield one["tick"], list(pairs)

    def _take_sensed(self, pairs: Any) -> None:
        self._read = list(pairs)
