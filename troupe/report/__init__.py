"""Reports of what has been run, in one file."""
