"""A good robot file as text, which tests break in one place at a time."""

from __future__ import annotations

GOOD = """schema = 1
name = "kiwi"

[body]
mass_kg = 3.0
inertia_kg_m2 = 0.027
com_m = [0.0, 0.0]
com_height_m = 0.0

[loads]
model = "equal"

[friction]
law = "atan"
k_s_per_m = 1000.0
grip = "box"

[motor]
max_speed_rad_s = 60.0
stall_torque_N_m = 0.9

[[wheel]]
name = "right"
position_m = [0.091763, 0.024588]
drive_direction_deg = 105.0
radius_m = 0.0254
roller_angle_deg = 0.0
rollers = 8
rigid_fraction = 0.1

[[wheel]]
name = "left"
position_m = [-0.091763, 0.024588]
drive_direction_deg = -105.0
radius_m = 0.0254
roller_angle_deg = 0.0
rollers = 8
rigid_fraction = 0.1

[[wheel]]
name = "rear"
position_m = [0.0, -0.095]
drive_direction_deg = 0.0
radius_m = 0.0254
roller_angle_deg = 0.0
rollers = 8
rigid_fraction = 0.1

[surface.paper]
roller = { drive = 0.26, transverse = 0.09 }
rigid = { drive = 0.47, transverse = 0.47 }

[[effect]]
name = "stribeck"
dynamic_ratio = 0.8
stribeck_speed_m_s = 0.02
wheels = ["rear"]
"""


def broken(old: str, new: str, count: int = 1) -> str:
    """The good file with ``old`` replaced by ``new`` (the first ``count`` times)."""
    assert old in GOOD, f"{old!r} is not in the good file"
    return GOOD.replace(old, new, count)
