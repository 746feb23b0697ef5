"""Shapes: the shape of each class that agrees best with a digital image of one object.

Modules, in reading order:

classes  The table of classes: one row for each.
fit  The best shape of every class.
misfit  How badly a shape agrees with an image; the descent that improves it.
candidates  Shapes to try: all with whole corners, and turned ones that descend.
shape_likelihood  How likely a class makes an image (Occam's factor).

Public names: `Fit`, `fit_shapes`.
"""
