"""A photocell, a sensor of one's own: how bright yellow lamps shine on it."""

import numpy as np

from sensors import Scalars, SensorSettings, View, parse_color, sensor

YELLOW = parse_color("yellow")


class PhotocellSettings(SensorSettings):
    """Where it sits and looks: `pose`, as all sensors have it."""


def dark(settings: PhotocellSettings, robots: int) -> Scalars:
    return Scalars.empty(robots, names=("brightness",), units=("1",))


@sensor("photocell", kind="scalars", settings=PhotocellSettings, readings=dark)
def see_light(settings: PhotocellSettings, view: View, readings: Scalars) -> None:
    """How bright yellow lamps shine on it."""
    lamps = np.flatnonzero(view.scene.colors == YELLOW)
    for row in view.rows:
        x, y, heading = view.origins[row]
        dx, dy = view.scene.poses[lamps, 0] - x, view.scene.poses[lamps, 1] - y
        slant = np.cos(np.arctan2(dy, dx) - heading)  # a lamp behind shines on its back
        readings.values[row, 0] = (np.clip(slant, 0, None) / (1 + dx**2 + dy**2)).sum()
