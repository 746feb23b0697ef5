"""Skeletons and pathgraphs: the ridges of the clearance, and the graph of their junctions, ends and chains.

In reading order:

    skeleton          cells in total order, saddles, and the steepest ways up from them
    sweep             clearance and skeleton of a whole screen, band by band
    bit_parallel      nodes counted and listed eight cells at a time
    lowest_cells      the lowest cells of many chains at once
    graph             the skeleton contracted to nodes and chains: SkeletonGraph
    chains            the same with the cells of the chains, for routes: Chains
    pathgraph_arrays  the same in coordinates, for users: PathgraphArrays
    networkx_export   the same as a networkx.MultiGraph
    thinning          the skeleton as a thin raster
    buffers           memory of dead screens, used again

Public names: ``pathgraph_arrays.PathgraphArrays``; the rest is reached through ``geometry.Screen``.
"""
