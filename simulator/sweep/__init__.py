"""Sweeps: scenarios run with many seeds and noises, in parallel, and what came out.

Modules in reading order:

contents     the texts of a scenario's files, which travel to the workers
plan         the runs of a sweep, in order, and the name of each
one_run      one run on a worker: contents in, result out
results      results as JSON lines that are appended
carrying_out a sweep from its plan to its results
summary      counts, rates with intervals, and steps by scenario and noise
picture      the summary as an SVG picture
executors    where runs are carried out: processes here, or the workers of a Dask scheduler
"""
