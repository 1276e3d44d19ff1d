"""What runs on the robot: a limiter that keeps the direction, a slip monitor, stopping distances."""
