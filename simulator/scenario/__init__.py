"""Scenarios: folders with the true world, the task and what is expected of the end.

Modules in reading order:

scenario     a scenario folder
worldfile    world.lp, the world as facts
picture      world.txt, the world as a picture, and the picture of any world
expectation  expect.lp, and the comparison with the truth
points       the outcome of each expectation, and its points
trialfile    trial.lp: how a test runs the scenario, and what it asks
cautions     warnings of `utak check`: what can be run but is hardly meant
disturbances  changes of the table by others while the robot acts
settings     the options of a run
untrusted    the refusal of links that lead out of a scenario
folder_writer  new scenario folders

Public names: `Scenario`, `read_scenario`, `read_any_world`, `Settings`, `Snapshot`, `unmet`, `should_fail`.
"""
