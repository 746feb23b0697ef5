"""Rasters of squares: what shapes cover, how far squares are from walls and from each other, what sees what.

A raster is indexed [row, column]; row 0 is in the south. Square (column, row) covers column..column + 1 by row..row +
1.

Modules in reading order:

    rasterize             the squares that a shape covers
    components            connected components, and the rectangles that contain them
    runs                  runs of squares along rows, and the polygon that a mask covers
    contours              boundary rings of a region of squares
    distance_transform    exact distance of every square from the nearest blocked one
    distance_rows         the same, faster, row by row where walls are near
    geodesic              length of the shortest 8-connected path from a start to every square
    line_of_sight         squares that a straight move of a unit square leads to
    surroundings          marked squares around a square, counted by groups
    winding               shortest paths that wind about a point a given number of times

Public names: the functions that those modules define; each is imported from its module.
"""
