"""Calibration: whether what is believed with so many percent is true so often, in random worlds of all kinds.

Modules, in reading order:

dealt       which worlds
figures     the class of a polygon
necks       which necks of a floor are doors by geometry
truth       what a believed node is in truth
moments     what is believed at one moment, with what is true
places      what is true of doors, rooms and corners
statements  the table of predicates whose statements are compared with the truth
runs        runs of the robot that are looked at
table       reliability: the table and JSON, and runs with their statements as JSON lines
picture     the same as an SVG picture
__main__    the program
"""
