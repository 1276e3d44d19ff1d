"""Measured motion: records, pulls, data sets, and what the wheels alone say of them.  Opens no file."""
