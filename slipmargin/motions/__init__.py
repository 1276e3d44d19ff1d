"""Room: motions."""
