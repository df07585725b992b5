"""Judges of the controller `paint`: its runs in the world, and its mind without physics."""
