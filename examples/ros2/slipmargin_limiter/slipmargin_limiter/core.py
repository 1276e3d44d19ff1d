"""The limiter without ROS: commands and odometry in, limited commands out, all in REP 103 axes.

x forward, y to the left, yaw counter-clockwise; times in seconds of any clock that does not go back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import slipmargin as sm

#: So far apart [m/s] are what was sent and what odometry says where a robot was stopped or pushed.
LOST_M_S = 0.3


@dataclass(frozen=True)
class Twist:
    """Body velocity: forward and to the left [m/s], yaw rate [rad/s]."""

    vx: float = 0.0
    vy: float = 0.0
    wz: float = 0.0

    @property
    def finite(self) -> bool:
        """Whether every number is finite."""
        return math.isfinite(self.vx) and math.isfinite(self.vy) and math.isfinite(self.wz)


class LimiterCore:
    """Keeps the last command, the last odometry and what was sent last.

    Parameters
    ----------
    robot, surface, margin
        As for :class:`slipmargin.Limiter`.
    timeout_s : float
        Without a command for so long the robot is braked, within the margin.
    lost_m_s : float, optional
        Where odometry is so far from what was sent, the limiter begins again from odometry: the robot was
        stopped, pushed or switched off.  Turning counts at the wheels.  By default 0.3 m/s, or half of the
        motors' top speed where that is less: what drives slowly never is 0.3 m/s apart.
    longest_s : float
        A longer pause between two ticks counts as this.
    """

    def __init__(
        self,
        robot: str,
        surface: str,
        *,
        margin: float = 0.1,
        timeout_s: float = 0.5,
        lost_m_s: float | None = None,
        longest_s: float = 0.1,
    ) -> None:
        self.limiter = sm.Limiter(robot, surface, margin=margin)
        self._convention = sm.read_robot(robot).robot.convention
        self._arm = float(abs(self.limiter.table.along[2]).mean())
        self._lost_m_s = _lost_m_s(self.limiter) if lost_m_s is None else lost_m_s
        self._timeout_s, self._longest_s = timeout_s, longest_s
        self._wanted, self._wanted_at = Twist(), -math.inf
        self._odometry: Twist | None = None
        self._yaw, self._sent, self._ticked = 0.0, Twist(), math.nan

    def command(self, now_s: float, wanted: Twist) -> None:
        """A wanted velocity; one that is no number counts as a stop."""
        self._wanted, self._wanted_at = (wanted if wanted.finite else Twist()), now_s

    def odometry(self, twist: Twist, yaw_rad: float = 0.0) -> None:
        """Measured body velocity and yaw; numbers that are not finite are not used."""
        if twist.finite and math.isfinite(yaw_rad):
            self._odometry, self._yaw = twist, yaw_rad

    def tick(self, now_s: float) -> tuple[Twist, str]:
        """The next command to send, and what was done, in words."""
        dt = now_s - self._ticked
        dt = min(dt, self._longest_s) if dt > 0.0 else 0.02 if math.isnan(dt) else 0.0
        self._ticked = now_s
        if dt == 0.0:
            return self._sent, "no time passed"
        wanted = self._wanted if now_s - self._wanted_at <= self._timeout_s else Twist()
        start = self._sent
        if self._odometry is not None and self._apart(self._odometry, start) > self._lost_m_s:
            start = self._odometry
        heading = float(self._convention.phi_of_yaw(self._yaw))
        twist, code = self.limiter.limit_twist(self._file(start), self._file(wanted), dt, heading)
        self._sent = self._ros(twist)
        return self._sent, self.limiter.meaning(code)

    def _apart(self, one: Twist, two: Twist) -> float:
        turning = abs(one.wz - two.wz) * self._arm
        return math.hypot(one.vx - two.vx, one.vy - two.vy) + turning

    def _file(self, twist: Twist) -> list[float]:
        """REP 103 to the robot file's axes."""
        x, y = self._convention.from_right_forward(-twist.vy, twist.vx)
        return [float(x), float(y), twist.wz]

    def _ros(self, twist: object) -> Twist:
        x, y, w = (float(v) for v in twist)  # type: ignore[attr-defined]
        right, forward = self._convention.right_forward(x, y)
        return Twist(forward, -right, w)


def _lost_m_s(limiter: sm.Limiter) -> float:
    """A difference of velocities [m/s] that a robot on its way does not have."""
    table = limiter.table
    if table.top_speed_rad_s is None:
        return LOST_M_S
    fastest = max(math.hypot(x, y) for x, y in table.rolling[:, :2])  # rad/s for each m/s along its row
    return min(LOST_M_S, 0.5 * float(table.top_speed_rad_s) / fastest)
