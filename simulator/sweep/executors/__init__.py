"""Executors: the one seam through which independent pieces of work are carried out, here or elsewhere.

Modules in reading order:

tasks           a task, its outcome, and what an executor is
worker          the program of a worker process
task_process    the handle of a worker process: limit of time, death, restart
processes       several worker processes on this machine
code_identity   which state of Utak's code this is, and the libraries that decide results
cluster         the workers of a Dask scheduler
"""
