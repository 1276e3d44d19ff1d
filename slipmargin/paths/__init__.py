"""Room: paths."""
