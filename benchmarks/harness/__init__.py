"""The harness of the campaign: trials in random worlds, their comparison with the truth, and their tables.

Modules, in reading order:

trial       one trial: the robot in one random world, judged and compared with the truth
judging     the independent judge of episodes
beliefs     the robot's beliefs compared with the truth
knowing     a robot that knows the table from the start
shortest    the length of the shortest walk, by an exact visibility graph
narrowness  the passage named in a verdict, compared with the true one
stopwatch   the time of the robot's thinking
drawing     a world drawn in letters
browser     a small driver of Chromium, for pages
tally       the table of a campaign
"""
