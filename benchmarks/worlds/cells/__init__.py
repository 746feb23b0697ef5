"""Puzzles of cells: things that are brought to places past each other, and whether that can be done.

Modules, in reading order:

pushing  whether things can be brought to places, found by breadth-first search over the cells
puzzles  random puzzles by kind, of which the search shows that they can be done
"""
