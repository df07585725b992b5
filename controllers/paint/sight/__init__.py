"""What a robot makes of its scans: walls, robots, where unseen ones may be, its own rank."""
