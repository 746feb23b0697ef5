"""Figures of the prompt and of queries: how soon, how large, and whether every runaway is stopped.

Programs: runaways, speed, memory.
"""
