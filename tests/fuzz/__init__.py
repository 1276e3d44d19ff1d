"""Mutated input for every command: nothing may break it, hang it or make it lie (``make fuzz``)."""
