"""Benchmarks about recorded episodes.

explanations  trees of reasons, confirmed node by node
planned       whether each command is the first step of what was planned
killing       runs and sweeps that are killed at random moments, and resumed
columns       which columns of a replay page need its bytes
replay        size and speed of replay pages
"""
