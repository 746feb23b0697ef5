"""Localisation: what happened on the last motion, where Utak is, and how the grid of the map lies in Utak's own frame.

Explanations of an observation are proposed, scored, chosen in ASP, and applied by one writer. In reading order:

tracker  the one owner of the state; it applies the chosen explanation and integrates the observation
proposals  the table of proposals, in the order in which they are asked, each with its condition
score  the scores of explanations, and the choice among all that were found
held_object_state  the held object after the chosen explanation: where it lies, and against what
standing  the squares in which the robot may stand, with their shares of the likelihood
field_account  what the map allowed each of the 160 fields to show, and what they showed
hypotheses  the values: frames, outcomes, contacts, explanations, and maps remapped to another frame
known  what is known: the state, and the situation in which an observation is to be explained
propose  the proposals, one kind a module; each takes a situation and returns explanations

Public names: `tracker.Tracker`, `known.state.TrackerState`, `standing.Standing`, `field_account.Accommodation`.

Two frames: the map frame has its axes along the grid and its origin at the corner of the square of waking; Utak's own
frame has its origin where Utak woke, with north the way it faced. Constants marked "tuned" were tuned on random worlds
(benchmarks.campaign).
"""
