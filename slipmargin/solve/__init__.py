"""Room: solve."""
