"""Real robots: fixed splits, common metrics, rows that others can add."""
