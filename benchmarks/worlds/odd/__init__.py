"""Odd random worlds: kinds of floors and objects that ordinary random worlds do not have.

Modules, in reading order:

houses       floors of rooms and doors at any angle
lying        places of objects and of the robot
tasks        goals, and what is true at the end
offgrid      walls, doors and objects off the grid
slanted      slanted walls
circular     round rooms
plugged      doors that objects fill
touching     objects that touch
openings     wide openings that are no doors
fixtures     fixed objects beside movable ones
constraints  constraints and contradictory goals
kinds        all kinds by name
"""
