"""Spatial reasoning: shapes, screens, skeletons, pathgraphs, ropes and rigid motion. Imports nothing else of Utak."""
