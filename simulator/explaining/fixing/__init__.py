"""The smallest changes with which a run that failed would have worked, each proved by running the robot again.

This is a tool for people: it reads the true world. Nothing of that reaches the robot.

Modules in reading order:

recorded    the scenario and the options of a recorded run
gaps        the passages of the true floor, the places for new doors, and how they are made wider
changes     the changes of a scenario, and how they are applied
leading     a robot that is led to a place before it acts by itself
bounds      which widths are too small by geometry alone
proving     runs of changed scenarios within a budget
candidates  which changes are tried
search      the search for the smallest changes that work
report      the answer in words and as JSON values
writing     a changed scenario as a folder

Public names: `find_fixes`, `FixReport`, `Fix`, `Budget`, `recorded_run`, `write_scenario`.
"""
