"""The one error of this room: a video or a picture that cannot be made."""


class VideoError(ValueError):
    """Says which file or setting is at fault, and what would do."""
