"""Runs that others disturb.

Modules in reading order:

run  one world, run as it is and disturbed
"""
