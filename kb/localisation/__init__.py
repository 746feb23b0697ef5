"""Localisation: what happened on the last motion, where Utak is, and how the grid of the map lies in Utak's own frame.

Explanations of an observation are proposed, scored, chosen in ASP, and applied by one writer. In reading order:

tracker  the one owner of the state; it applies the chosen explanation and integrates the observation
state  the state as one frozen value: pose, frame hypotheses, occupancy map, held objects
after_walk  explanations of an observation after a walk, or on waking
after_carry  explanations of an observation after a push or a turn, and the held object after it
score  what contradicts an explanation, slower proposals, and the choice among all
standing  the squares in which the robot may stand, with their shares of the likelihood
field_account  what the map allowed each of the 160 fields to show, and what they showed
hypotheses  the values: frames, outcomes, contacts, explanations, and maps remapped to another frame
propose  the proposals, one kind a module

Public names: `tracker.Tracker`, `state.TrackerState`, `standing.Standing`, `field_account.Accommodation`.

Two frames: the map frame has its axes along the grid and its origin at the corner of the square of waking; Utak's own
frame has its origin where Utak woke, with north the way it faced. Constants marked "tuned" were tuned on random worlds
(benchmarks.campaign).
"""
