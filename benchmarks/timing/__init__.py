"""Timing: the processor time of action cycles and of the way to the first command.

Modules, in reading order:

growth          the time of a cycle by the area that the robot has seen
sixrooms        the time from the task to the first command, cold
sixrooms_child  one cold run of sixrooms
"""
