"""Random worlds for what lies between parts of the program: doubt about walls, goals of two things, doors and rules.

Modules, in reading order:

walls       walls made of things, and openings that fill no whole square
references  goals that name two things, or a thing and a place, in both orders
doors       several doors between two rooms, with constraints and with rules of users
enclosed    a C or a U about the robot, and things against walls that are to be circled
crowded     rooms packed with boxes
headings    corners of rooms off the grid, at any heading
kinds       all of these by name
"""
