"""Stage's world files and Player's driver tables, read and turned into world files of Troupe."""

from troupe.importers.stage.convert import Converted, convert
from troupe.importers.stage.notes import Note
from troupe.importers.stage.tokens import StageError

__all__ = ["Converted", "Note", "StageError", "convert"]
