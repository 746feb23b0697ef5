"""Priors, counted: how often each alternative was true in random worlds, given what was measured.

Modules, in reading order:

measures  what confidences are conditioned on, with what is true
whereabouts  the same of what may be besides what was seen
looks     the same of looks for what nobody saw
walls     the same of walls that are felt, and the worlds for that
bins      into which bins measures fall
count     how often each alternative was true
written   the files of priors
__main__  the program
labelled_floors  rooms of labelled floors, cut by kb/asp/rooms.lp: a program of its own
"""
