"""A slip limiter for ROS 2."""
