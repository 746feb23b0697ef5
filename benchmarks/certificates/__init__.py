"""Whether certificates that are accepted are true: mutants of them, and walks that often miss their goals.

recorded  episodes of given commands in given worlds
drawn     random worlds and walks
gaps      random rooms with gaps, and whether something gets out
doors     random rooms with doors, and what is led through them
unable    worlds in which the task cannot be done, run whole
truth     whether goals hold on the true table
mutants   certificates changed in one place
__main__  counts of accepted ones whose claim is false
"""
