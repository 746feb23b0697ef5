"""Navigation: which subgoal to pursue, and by which route.

Modules, in reading order:

subgoals      Subgoal, choose: what is worth doing now, and the choice among it (planner/asp/deciding)
network       Network: the links of the pathgraph between two squares, and the shortest ways over them
walks         Walks: links and ways by one of three path-finders, and the choice among them (planner/asp/deciding)
encircle      routes that wind once around an object
sticky_route  StickyRoute: the route under way, kept while it holds
fewest_moves  FewestMoves: subgoals that one or two straight moves reach
loop_guard    LoopGuard: loop detection, and which subgoals led in a loop
"""
