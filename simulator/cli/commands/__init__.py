"""The subcommands of `utak`, one a module, whose function `execute` runs it and returns the exit code.

given   what several subcommands are given
run     run the robot on a scenario
test    run scenarios as tests
sweep   run scenarios with many seeds and noises
query   ask what Utak believes
plan    show what the robot means to do
repl    step through a run and ask
explain tell why: facts, commands, verdicts, cells
replay  show a recorded episode
routes  find distinct routes on a map
schema  print the JSON Schema of episodes and answers
warm    compile the geometry kernels
files   the subcommands that read, write and check files: check, show, new, import, verify
"""
