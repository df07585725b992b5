"""What a robot says."""

from __future__ import annotations

from player.codes import Interface
from player.proxies.base import Proxy


class SpeechProxy(Proxy):
    """Player's speech: what a robot says goes into the result, and into the video."""

    interface = Interface.SPEECH

    def say(self, text: str) -> None:
        """Says `text`, at the time of the next reading."""
        self._command(1, text=text)
