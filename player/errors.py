"""What can go wrong between a client and a Player server, as exceptions."""


class PlayerError(Exception):
    """Any failure of a Player connection; the other errors here are kinds of it."""


class PlayerTimeout(PlayerError):
    """The server did not answer within the client's timeout."""


class PlayerRefused(PlayerError):
    """The server answered a request with a NACK: no such device, or not supported by it."""


class PlayerDisconnected(PlayerError):
    """There is no connection: it could not be made, it broke, or it has been closed."""


class NoReading(PlayerError):
    """A proxy was asked for what its device has not sent yet: `read` comes first."""


class ProtocolError(PlayerError):
    """Bytes that are not Player's protocol: a bad header, a wrong size, counts that differ."""


class XdrError(ProtocolError, ValueError):
    """A payload that does not have its message's layout, or a value that does not fit in it."""
