"""Replay: views of a recorded episode. Each is a function of the episode alone: header, steps and result.

Modules in reading order:

events      the steps at which something happened
changes     what changed in the facts from step to step
transcript  an episode as text
delta       differences between JSON values
outlines    facts with their outlines apart, so that little changes
decisions   decisions as far as a page keeps them
packing     an episode packed for a page
page        the page of an episode; its parts for the browser lie in the folder page_parts
gif         an episode as a moving picture
output      reading episodes and writing pages and pictures
watching    the table in a terminal while a run goes on
"""
