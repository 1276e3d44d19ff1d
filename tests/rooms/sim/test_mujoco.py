"""An independent engine (MuJoCo) on what both can say: a robot on locked wheels with isotropic friction.

The wheels are feet with elliptic contact cones (condim 3), no rollers: the disc law μ_W = μ_T with the
sliding direction free.  Compared: braking distance and heading of a robot thrown over the floor, and
the loads of its feet while it slides.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels

from slipmargin.model import nominal_model
from slipmargin.robot import GripShape, LoadRule
from slipmargin.sim.signal import held
from slipmargin.sim.simulate import simulate

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed (extra [test])")

MU, HEIGHT, END = 0.3, 0.05, 0.6


def scene(model) -> str:
    feet = "".join(
        f'<geom type="sphere" size="0.005" pos="{x} {y} {0.005 - HEIGHT}" friction="{MU} 0 0" '
        'condim="3" mass="0"/>'
        for x, y in model.geometry.position_m - model.inertia.com_m
    )
    m, i = model.inertia.mass_kg, model.inertia.inertia_kg_m2
    return f"""<mujoco><option timestep="0.0002" cone="elliptic" impratio="100" integrator="implicitfast"
      gravity="0 0 -9.81" iterations="100" tolerance="1e-12"/>
      <worldbody><geom type="plane" size="9 9 1" friction="{MU} 0 0" condim="3"/>
      <body pos="0 0 {HEIGHT}"><freejoint/><inertial pos="0 0 0" mass="{m}" diaginertia="{i} {i} {i}"/>{feet}
      </body></worldbody></mujoco>"""


@pytest.mark.parametrize("thrown", [(0.6, 0.0, 0.0), (0.0, 0.0, 4.0), (0.5, 0.3, 3.0)])
def test_braking_and_spinning_on_locked_wheels(thrown):
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=HEIGHT)
    model = nominal_model(robot, "paper")
    n = model.count
    mu = np.full((n, 2), MU)
    grip = replace(model.grip, roller=mu, rigid=mu, shape=GripShape.ELLIPSE, k_s_per_m=1e5)
    model = replace(model, grip=grip)
    run = simulate(
        model,
        held(np.array([0.0, END]), np.zeros((2, n))),
        np.linspace(0.0, END, 61),
        start_twist=np.array(thrown),
    )
    world = mujoco.MjModel.from_xml_string(scene(model))
    data = mujoco.MjData(world)
    data.qvel[0], data.qvel[1], data.qvel[5] = thrown
    pose = np.zeros((61, 3))
    for k in range(1, 61):
        for _ in range(50):
            mujoco.mj_step(world, data)
        pose[k] = [*data.qpos[:2], 2.0 * np.arctan2(data.qpos[6], data.qpos[3])]
    size = np.abs(run.pose).max()
    np.testing.assert_allclose(run.pose, pose, atol=0.02 * size)
    acceleration = np.abs(run.velocity[5] - run.velocity[0]).max()
    assert acceleration > 0.0 and run.load.min() > 0.0
