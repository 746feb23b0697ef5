"""References for measuring the geometry engine: exact answers by brute force, and other libraries.

In reading order:

    exact       exact answers about small floors, in whole numbers
    sightlines  an exact visibility graph of a large map, searched up to a given length
    peers       scikit-image, sknw, scipy, networkx and w9-pathfinding
    ompl_peer   motion planners of OMPL
"""
