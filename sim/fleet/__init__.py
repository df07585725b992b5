"""Controller processes: their start, their output, their end."""
