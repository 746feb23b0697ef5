"""Questions to geometry, put in states that plans lead to, and their answers.

problem       TaskProblem, TableState: things, places and goals of one stage; how everything lies, as predicted
carry         CarryOracle: whether a thing can be brought to a place, or the robot go there; verified or refuted
spots         places where a thing can lie, out of the way of others or within a region
"""
