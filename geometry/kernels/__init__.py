"""Kernels: compiled loops, and the small data structures that they share.

Modules in reading order:

    arrays          the array types of the engine, each named once
    jit             functions that compile themselves when first called (numba)
    cache           compiled code on disk: damaged files count as missing
    heap            a binary heap in two arrays
    bucket_queue    a priority queue for costs that are small whole numbers

Public names: ``compiled``, ``bare`` (jit), and the types of arrays.
"""
