"""The commands of `troupe`, one file each, with the name of the command."""
