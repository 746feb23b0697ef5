"""The true table: its contents, physics, and what the robot senses of it.

Modules in reading order:

world    things on the table, as frozen values
placing  where a thing or the robot may be put
table    the table as an array of occupied squares
senses   retina and touch at a place
physics  the five commands and their effects, exact to the first contact

Public names: `World`, `Thing`, `Table`, `Senses`, `Tabletop`.
"""
