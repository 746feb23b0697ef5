"""Replay: views of a recorded episode. Each is a function of the episode alone: header, steps and result.

Modules in reading order:

changes     the facts that changed from step to step
transcript  an episode as text
events      the steps at which something happened
page        the page of an episode; its parts for the browser lie in the folder page_parts
drawing     pictures of the table and of what is believed, as SVG
gif         an episode as a moving picture
output      reading episodes and writing pages and pictures
watching    the table in a terminal while a run goes on
"""
