"""The subcommands of `utak`, one a module: `add` declares it, `execute` runs it and returns the exit code.

run     run the robot on a scenario
test    run scenarios as tests
query   ask what Utak believes
repl    step through a run and ask
replay  show a recorded episode
routes  find distinct routes on a map
warm    compile the geometry kernels
files   the subcommands that read and write files of scenarios: check, show, new
"""
