"""Which topics of a bag hold pose and wheels, and which joints are which wheels, by types and names."""

from __future__ import annotations

import re
from collections.abc import Sequence

from slipmargin.errors import InputError

#: Types of messages by what they tell, best first: odometry is often made from the wheels themselves.
TYPES = {
    "--pose-topic": (
        ("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"),
        ("geometry_msgs/msg/TransformStamped",),
        ("nav_msgs/msg/Odometry",),
        ("tf2_msgs/msg/TFMessage",),
    ),
    "--joint-topic": (("sensor_msgs/msg/JointState",),),
}
#: Topics that are never the measured motion.
_NOT = ("tf_static", "goal", "initialpose", "command", "cmd")
#: Short words of wheels' names.
_SHORT = {
    "fl": "front left",
    "fr": "front right",
    "rl": "rear left",
    "rr": "rear right",
    "bl": "rear left",
    "br": "rear right",
    "lf": "front left",
    "rf": "front right",
    "lr": "rear left",
    "lb": "rear left",
    "rb": "rear right",
    "back": "rear",
    "forward": "front",
}


def guessed_topic(types: dict[str, str], option: str) -> tuple[str, str]:
    """The topic that an option would name, by the types of a bag's topics, and a note that says so.

    Raises
    ------
    InputError
        Placed at the option where no topic, or more than one, has a type that fits.
    """
    for kinds in TYPES[option]:
        found = sorted(
            name
            for name, kind in types.items()
            if kind in kinds and not any(word in name.lower() for word in _NOT)
        )
        if len(found) == 1:
            (topic,) = found
            note = f"{topic} ({types[topic]}) is taken as the {option.split('-')[2]} topic by its type"
            if types[topic] == "nav_msgs/msg/Odometry":
                note += "; if it is computed from the wheels, it cannot show that they slip"
            return topic, note
        if found:
            raise InputError(
                option, f"{len(found)} topics fit: {', '.join(found)}", "name one of them", "command line"
            )
    wanted = ", ".join(kind for kinds in TYPES[option] for kind in kinds)
    have = ", ".join(f"{name} ({kind})" for name, kind in sorted(types.items())) or "none"
    raise InputError(
        option, f"no topic of the bag is one of {wanted} (it has: {have[:300]})", "record one", "command line"
    )


def joints_of_wheels(wheels: Sequence[str], joints: Sequence[str], topic: str) -> tuple[str, ...]:
    """The joint of each wheel: the one that has its name, or all words of its name (fl: front left).

    Raises
    ------
    InputError
        Placed at the option ``--joint`` where a wheel has no joint, or several.
    """
    if not joints:
        raise InputError(topic, "holds no joint", "record the wheels too")
    found = []
    for wheel in wheels:
        fit = [j for j in joints if j == wheel] or [j for j in joints if _words(wheel) <= _words(j)]
        if len(fit) != 1:
            raise InputError(
                "--joint",
                f"no joint is clearly wheel {wheel!r}"
                if not fit
                else f"{', '.join(fit)} all fit wheel {wheel!r}",
                f"give --joint once for each of {', '.join(wheels)}, in this order (there are: "
                f"{', '.join(joints)})",
                "command line",
            )
        found.append(fit[0])
    if len(set(found)) < len(found):
        raise InputError(
            "--joint",
            f"one joint fits two wheels: {', '.join(found)}",
            "give --joint once a wheel",
            "command line",
        )
    return tuple(found)


def _words(name: str) -> frozenset[str]:
    """The words of a name, short ones in full: ``fl_wheel_joint`` → front, left, wheel, joint."""
    parts = re.findall(r"[a-z]+|[0-9]+", re.sub(r"([a-z])([A-Z])", r"\1 \2", name).lower())
    return frozenset(word for part in parts for word in _SHORT.get(part, part).split())
