"""Episodes packed for a page: what changes from step to step, with what can be told from the rest left out.

Modules in reading order:

events       the steps at which something happened
delta        differences between JSON values
outlines     facts with their outlines apart, so that little changes
impressions  what the fields of the retina observe, what was predicted, how it was explained
decisions    decisions as far as a page keeps them
tracks       places and motions
short_texts  JSON values as short texts
packing      an episode as the texts that a page holds
"""
