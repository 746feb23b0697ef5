"""Malformed files, and what our readers make of them.

Modules in reading order:

mutate    a text, changed in its bytes, words, numbers, lines or parts
outcomes  what came of reading something: accepted, refused with a place, or a fault
samples   good files of other formats
episodes  malformed episodes, read as the prompt, questions and pictures read them
imports   malformed files of other formats
written   malformed files that we wrote, and read again or overwrite: pages, results of sweeps, compiled kernels
commands  malformed files given to commands, in this process and in processes of their own
"""
