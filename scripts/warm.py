"""Have every kernel compiled, and the machine code kept, as `troupe warm` does."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from troupe.warm import tell, warm_once

if __name__ == "__main__":
    warm_once(tell)
