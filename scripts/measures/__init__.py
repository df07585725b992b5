"""What `scripts/bench` measures: each function gives what stands in a row of its table."""
