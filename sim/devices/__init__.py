"""Robots' devices on Player's interfaces: what they publish, obey and answer."""
