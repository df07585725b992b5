"""How long a test waits for what must happen: a limit against hanging for ever, and nothing else.

What a test waits for ends by what happens, however loaded the machine. Who needs the clock (a
client that gives up after a while, say) says in the test why no result depends on it.
"""

from troupe.testing.patience import PATIENCE

__all__ = ["PATIENCE"]
