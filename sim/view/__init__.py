"""What a moment of a run shows to those who watch it, and the bytes by which it reaches them."""
