"""The Stage half: worlds, bodies, clock, devices, processes, video."""
