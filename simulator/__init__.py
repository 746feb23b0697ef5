"""TABLETOP, the simulated world of the robot, and the command line `utak`.

Rooms in reading order:

world     the true table: its contents, physics and the robot's senses
scenario  a folder with a world, a task and expectations: reading and checking
episode   the record of a run as JSON lines: writing, reading and checking
run       the robot in a world: sessions, tests and stories
replay    views of a recorded episode: a page, a moving picture, text
terminal  what users see: streams, exit codes, the prompt
cli       the command `utak` and its subcommands
"""
