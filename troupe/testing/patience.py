"""How long is waited for what must happen: a limit against hanging for ever, and nothing else.

What is waited for ends by what happens, however loaded the machine.
"""

PATIENCE = 600.0
"""Wall-clock seconds."""
