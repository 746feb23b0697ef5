"""A benchmark of tasks with several things, in which order and places matter.

Modules, in reading order:

asked        which tasks are asked for: random worlds and puzzles, and what is known of them
relaxed      what a carry needs at least, and what lies in its way
search       a search that knows the true world
carried_out  what the search has found, carried out in the simulated world
row          the result of one run
run          one run of the robot, judged
table        the table of results, and why runs failed
__main__     the program
planning    task plans in worlds that are known: how near to the best, and how long they take
meanings    plans for equal things: what it saves that the plan chooses what parameters mean
strategies  strategies of clingo for the best answer, compared on task plans
"""
