"""Room: sets."""
