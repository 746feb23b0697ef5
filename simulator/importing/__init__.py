"""Worlds and tasks of other formats, made into scenarios (docs/importing.md).

Modules in reading order:

imported        what a reader returns, and the options it is given
text_file       the text of a file of another format
raster          worlds of cells: walls, objects and the robot as a picture or as outlines
pushworld       PushWorld puzzles, .pwp
sokoban         Sokoban levels, .xsb
movingai_map    Moving AI maps, .map
ros_head        the head of a ROS map, .yaml
ros_map         ROS maps, .yaml with an image
xml_tree        XML with places, without entities
svg_outlines    outlines that SVG draws
namosim         NAMOSIM scenarios, .svg

Public names: `Imported`, `ImportOptions`, and `read` of each format.
"""
