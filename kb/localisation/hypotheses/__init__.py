"""Hypotheses: the values that proposals are made of, and how each is evaluated.

In reading order:

frames  hypotheses: orientation and origin of the grid, judged by contradictions; which motion ended elsewhere
remap  all observations and held objects in another frame
map_prior  the description length of the simplest map in a frame
walk_outcomes  where a walk may have ended, at and beside grid lines
carry_outcomes  what a push or a turn may have led to
correction  how everything since is shifted where an earlier motion ended elsewhere than believed
explanation  an explanation of an observation, and the choice by kb/asp/accommodation.lp
reestimation  other ends of a remembered walk, when observations contradict each other
contacts  contact hypotheses: what may have blocked a held object, and where
recognition  where on a known map a look fits, once the robot was put elsewhere
"""
