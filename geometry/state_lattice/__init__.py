"""The state lattice of carrying: a body moves by whole squares and quarter turns about the robot that holds it.

Modules in reading order:

    footprints    the squares that a body covers, meets in a push, meets in a turn
    lattice       the state lattice: where the body can lie, what each push and turn costs, where the robot can walk
    heuristic     the exact cost to go without the robot's own body and walks (admissible)
    astar         the cheapest path on the lattice: pushes, turns, letting go, walking, grasping again

A pose is a quarter turn 0..3 and the square in which the body's centroid lies. Costs are whole numbers, see lattice.
"""
