"""The screen: the world model projected on arrays of squares, and straight moves over them.

Modules, in reading order:

projection   CostMaps: which squares may be crossed at each certainty level, and how far they are
sweeps       the squares that a unit square sweeps along a straight line
moves        Pace, next_move: the longest safe straight move along a route
unseen_gain  expected_gain: how many unseen squares come into sight from each square
"""
