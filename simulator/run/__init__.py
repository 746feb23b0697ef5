"""Runs: the robot of the planner in the simulated world.

Modules in reading order:

session     one run, step by step, with its record
embodiment  the robot's body: commands in, impressions out
robots      the robot of the planner, made for a body and a task
trial       a run as a test, judged by expect.lp
forking     a recorded run, repeated up to a step, which goes on otherwise
story       a run or a recorded episode, read step by step, back and forth, and changed on the way
changes     assumptions and other goals, from a step on
interrupts  Ctrl-C during a step
time_limit  a limit of wall-clock time for a run
warming     compilation of geometry's kernels before the first run

Public names: `Session`, `Result`, `make_robot`, `run_trial`, `open_story`, `Story`, `repeat_stages`, `warm`.
"""
