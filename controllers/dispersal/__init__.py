"""Uniform dispersal (FCDFS and others): the rules, the grid, and a program for a robot."""
