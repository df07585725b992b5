"""Algorithm Paint: a swarm divides a known region into strips, and each robot paints its own."""
