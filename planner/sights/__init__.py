"""Sights: where something may be seen or felt that is not known yet.

Modules, in reading order:

frontiers   Viewpoint: frontiers, gaps, unsettled boundaries, and the squares from which given squares are seen
walls       FeelingPlace: walls that were never felt and may be things, and from where they are felt
passages    WalkThroughWall: straight walks through walls that may have an opening which fills no whole square
things      rims_to_feel: things that may be several, and from where they are felt all round
viewpoints  Approach: the squares from which an object is inspected, or taken
"""
