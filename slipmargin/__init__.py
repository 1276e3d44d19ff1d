"""How hard a wheeled omnidirectional robot can push, turn and accelerate before a wheel slips.

Everything that the ``slipmargin`` command can do is a function here; ``dir(slipmargin)`` is the table of
contents, and ``help(slipmargin.sweep)`` shows an example.

>>> import slipmargin as sm
>>> robot = sm.read_robot("ohio-kiwi")
>>> sm.sweep(robot, "paper")
<sweep of ohio-kiwi on paper: weakest 4.92 N at φ = 0°, recommended 4.42 N>

Each function is loaded when it is first used, so that ``import slipmargin`` stays quick.  The package opens
no window, prints nothing, and opens files only in :mod:`slipmargin.io`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

#: Public function → the module that holds it.
_CONTENTS = {
    "SlipMonitor": "slipmargin.api.monitor",
    "Limiter": "slipmargin.api.limiter",
    "bounds": "slipmargin.api.bounds",
    "built_in_robots": "slipmargin.api.robots",
    "check": "slipmargin.api.check",
    "check_robot": "slipmargin.api.robot_files",
    "compare": "slipmargin.api.compare",
    "describe_effect": "slipmargin.api.effects",
    "describe_robot": "slipmargin.api.robots",
    "describe_surface": "slipmargin.api.surfaces",
    "design": "slipmargin.api.design",
    "diagnose": "slipmargin.api.diagnose",
    "explore": "slipmargin.api.explore",
    "export_simulator": "slipmargin.api.export_simulator",
    "export_c": "slipmargin.api.limiter",
    "export_trajectory": "slipmargin.api.trajectories",
    "trajectory_text": "slipmargin.api.trajectories",
    "import_logs": "slipmargin.api.import_logs",
    "known_effects": "slipmargin.api.effects",
    "new_robot": "slipmargin.api.robot_files",
    "next_run": "slipmargin.api.next_run",
    "known_quantities": "slipmargin.api.design",
    "known_surfaces": "slipmargin.api.surfaces",
    "measure": "slipmargin.api.measure",
    "plan": "slipmargin.api.plan",
    "polytope": "slipmargin.api.polytope",
    "read_robot": "slipmargin.api.robots",
    "reproduce": "slipmargin.api.reproduce",
    "robot_from_urdf": "slipmargin.api.robot_files",
    "simulate": "slipmargin.api.simulate",
    "stop": "slipmargin.api.stop",
    "sweep": "slipmargin.api.sweep",
}

if TYPE_CHECKING:
    from slipmargin.api.bounds import bounds as bounds
    from slipmargin.api.check import check as check
    from slipmargin.api.compare import compare as compare
    from slipmargin.api.design import design as design, known_quantities as known_quantities
    from slipmargin.api.diagnose import diagnose as diagnose
    from slipmargin.api.effects import describe_effect as describe_effect, known_effects as known_effects
    from slipmargin.api.explore import explore as explore
    from slipmargin.api.export_simulator import export_simulator as export_simulator
    from slipmargin.api.import_logs import import_logs as import_logs
    from slipmargin.api.limiter import Limiter as Limiter, export_c as export_c
    from slipmargin.api.measure import measure as measure
    from slipmargin.api.monitor import SlipMonitor as SlipMonitor
    from slipmargin.api.next_run import next_run as next_run
    from slipmargin.api.plan import plan as plan
    from slipmargin.api.polytope import polytope as polytope
    from slipmargin.api.reproduce import reproduce as reproduce
    from slipmargin.api.robot_files import (
        check_robot as check_robot,
        new_robot as new_robot,
        robot_from_urdf as robot_from_urdf,
    )
    from slipmargin.api.robots import (
        built_in_robots as built_in_robots,
        describe_robot as describe_robot,
        read_robot as read_robot,
    )
    from slipmargin.api.simulate import simulate as simulate
    from slipmargin.api.stop import stop as stop
    from slipmargin.api.surfaces import describe_surface as describe_surface, known_surfaces as known_surfaces
    from slipmargin.api.sweep import sweep as sweep
    from slipmargin.api.trajectories import (
        export_trajectory as export_trajectory,
        trajectory_text as trajectory_text,
    )


def __getattr__(name: str) -> Any:
    if name not in _CONTENTS:
        raise AttributeError(f"slipmargin has no attribute {name!r}; dir(slipmargin) lists what it has")
    function = getattr(importlib.import_module(_CONTENTS[name]), name)
    globals()[name] = function
    return function


def __dir__() -> list[str]:
    return ["__version__", *_CONTENTS]
