"""Priors, counted: how often each alternative was true in random worlds, given what was measured.

Modules, in reading order:

measures  what confidences are conditioned on, with what is true
bins      into which bins measures fall
count     how often each alternative was true
written   the files kb/asp/priors.lp and kb/asp/place_priors.lp
__main__  the program
labelled_floors  rooms of labelled floors, cut by kb/asp/rooms.lp: a program of its own
"""
