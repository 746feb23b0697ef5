"""TABLETOP, the simulated world of the robot, and the command line `utak`.

Rooms in reading order:

world       the true table: its contents, physics and the robot's senses
scenario    a folder with a world, a task and expectations: reading and checking
importing   worlds and tasks of other formats
episode     the record of a run as JSON lines: writing, reading and checking
certificates  why a verdict follows: written for a run, checked by a module that uses nothing else
run         the robot in a world: sessions, tests and stories
explaining  questions about a run: why facts, commands, verdicts and cells are as they are
testing     scenarios as tests: records, JUnit, the process for pytest
sweep       scenarios run with many seeds and noises, in parallel
replay      views of a recorded episode: a page, a moving picture, text
terminal    what users see: streams, exit codes
repl        the prompt of `utak repl`
cli         the command `utak` and its subcommands
"""
