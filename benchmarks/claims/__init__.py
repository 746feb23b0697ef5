"""A campaign that refutes claims: is what the robot says is done, done, and what it calls impossible, impossible?

Read `asked` (which worlds), `child` (one run in a process of its own), `refute` (claims against the truth), `row` (what
came of a world), `run` (one world from folder to row), `table` and `report` (what came of all), `__main__`.
"""
