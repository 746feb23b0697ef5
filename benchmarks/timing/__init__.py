"""Timing: action cycles, the way to the first command, explanations, and the environment for learners.

Modules, in reading order:

growth          the time of a cycle by the area that the robot has seen
sixrooms        the time from the task to the first command, cold
sixrooms_child  one cold run of sixrooms
environment     the speed of the Gymnasium environment and of the bare table
explaining      the time to explain recorded decisions
paired          the processor time of two checkouts, by turns
"""
