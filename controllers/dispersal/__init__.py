"""Uniform dispersal (FCDFS and others): the rules, and the program that drives a robot by them."""
