"""Room: diagnose."""
