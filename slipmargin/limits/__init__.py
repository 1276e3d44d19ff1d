"""Room: limits."""
