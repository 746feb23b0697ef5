"""Worlds whose doorways are filled.

Modules, in reading order:

doorplugs  doorways that movable things fill from jamb to jamb, and closed rooms without a door
"""
