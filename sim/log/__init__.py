"""Logs: a run kept as an MCAP file of ROS 2 messages, and read again."""
