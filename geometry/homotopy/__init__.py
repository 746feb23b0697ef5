"""Homotopy classes of paths over free squares: strips, words of portals, and the shortest path of a class.

Modules, in reading order:

strips  Free space cut into horizontal strips; portals between them; words that name homotopy classes.
portals  The word of a polyline; words joined and reduced; crossing numbers of a word.
funnel  String pulling: the shortest path through a word of portals.
landmarks  What routing precomputes on a pathgraph: words and tight lengths of chains, distances from landmark nodes.

Public names: `Strips`, `find_strips`, `word_of_line`, `crossings_of`, `tighten_word`, `Landmarks`,
`compute_landmarks`, `Anchor`.
"""
