"""Stage's world files and Player's driver tables, read and turned into world files of Troupe."""

from troupe.stagefile.convert import Converted, convert
from troupe.stagefile.notes import Note
from troupe.stagefile.tokens import StageError

__all__ = ["Converted", "Note", "StageError", "convert"]
