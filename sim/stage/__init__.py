"""What stands and moves in a world: layout, bodies, floor, doors."""
