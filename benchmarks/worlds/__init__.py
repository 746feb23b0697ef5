"""Random worlds for the nine tasks.

Modules, in reading order:

scenes      RandomScenario: a scenario as a frozen value, and its files
furniture   objects of all shape classes
floorplans  random floor plans of one to three, or six, rooms
placing     places of objects and of the robot
walking     worlds for the tasks (i) to (iv)
carrying    worlds for the tasks (v) to (ix)
plain       plain worlds: one or two rooms, everything on whole squares
loose       worlds with objects off the grid
makers      all of these by kind, task and seed
six_rooms   worlds of six rooms
odd         odd worlds (a package)
filled      worlds whose doorways are filled (a package)
seams       worlds for what lies between parts of the program (a package)
"""
