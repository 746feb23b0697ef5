"""TABLETOP, the simulated world of the robot, and the command line `utak`.

Rooms in reading order:

world     the true table: its contents, physics and the robot's senses
scenario  a folder with a world, a task and expectations: reading and checking
episode   the record of a run as JSON lines: writing, reading and checking
run       the robot in a world: sessions, tests and stories
terminal  what users see: streams, exit codes
repl      the prompt of `utak repl`
cli       the command `utak` and its subcommands
"""
