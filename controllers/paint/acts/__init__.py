"""What a robot does in each phase: looking around, going, waiting, and painting its strip."""
