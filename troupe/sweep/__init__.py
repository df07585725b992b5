"""Runs by the thousand: worlds, settings and seeds multiplied, in a folder that survives."""
