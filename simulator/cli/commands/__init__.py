"""The subcommands of `utak`, one a module: `add` declares it, `execute` runs it and returns the exit code.

run     run the robot on a scenario
test    run scenarios as tests
check   check the files of scenarios
show    print a world as a picture
new     write a small scenario
query   ask what Utak believes
repl    step through a run and ask
routes  find distinct routes on a map
warm    compile the geometry kernels
"""
