"""Explaining a run: why facts are believed, why commands were given, what each cell is laid to.

Modules in reading order:

questions      questions about a run or an episode, answered with trees of reasons
certified      certificates in words
missing_rules  what is said when rules of a run are not given
trees          trees for the steps of a whole episode, cut to what a page can hold
fixing         the smallest changes with which a run that failed would have worked

Public names: `Questions`, `questions_of_episode`.
"""
