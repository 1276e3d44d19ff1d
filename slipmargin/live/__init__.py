"""The local page with sliders: a robot's limits as its numbers are changed."""
