"""Readers of other simulators' files, which become world files of Troupe."""
