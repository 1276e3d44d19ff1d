"""Package data: one TOML a machine, named by its source."""
