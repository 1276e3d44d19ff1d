"""ROS 2 node: ``cmd_vel`` and ``odom`` in, ``cmd_vel_limited`` out.  It was not run on a robot."""

from __future__ import annotations

import math

import rclpy
from geometry_msgs.msg import Twist as TwistMessage
from nav_msgs.msg import Odometry
from rclpy.node import Node

from slipmargin_limiter.core import LimiterCore, Twist


class LimiterNode(Node):
    """Subscribes commands and odometry, publishes the limited command at a fixed rate."""

    def __init__(self) -> None:
        super().__init__("slip_limiter")
        self.declare_parameter("robot", "")
        self.declare_parameter("surface", "")
        self.declare_parameter("margin", 0.1)
        self.declare_parameter("rate_hz", 50.0)
        self.declare_parameter("lost_m_s", 0.0)  # 0: as the robot's top speed says
        self._core = LimiterCore(
            self.get_parameter("robot").value,
            self.get_parameter("surface").value,
            margin=self.get_parameter("margin").value,
            lost_m_s=self.get_parameter("lost_m_s").value or None,
        )
        self._out = self.create_publisher(TwistMessage, "cmd_vel_limited", 10)
        self.create_subscription(TwistMessage, "cmd_vel", self._commanded, 10)
        self.create_subscription(Odometry, "odom", self._measured, 10)
        self.create_timer(1.0 / self.get_parameter("rate_hz").value, self._tick)

    def _now(self) -> float:
        return self.get_clock().now().nanoseconds * 1e-9

    def _commanded(self, message: TwistMessage) -> None:
        wanted = Twist(message.linear.x, message.linear.y, message.angular.z)
        self._core.command(self._now(), wanted)

    def _measured(self, message: Odometry) -> None:
        q, v = message.pose.pose.orientation, message.twist.twist
        yaw = math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))
        self._core.odometry(Twist(v.linear.x, v.linear.y, v.angular.z), yaw)

    def _tick(self) -> None:
        twist, _ = self._core.tick(self._now())
        message = TwistMessage()
        message.linear.x, message.linear.y, message.angular.z = twist.vx, twist.vy, twist.wz
        self._out.publish(message)


def main() -> None:
    """Run the node until it is stopped."""
    rclpy.init()
    node = LimiterNode()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()
