"""Proposals: explanations of an observation, one kind a module, each by `propose(situation)`.

In the order in which they are asked for:

blocked  the newest motion went as commanded or was blocked: every possible end, with its chance
contradicted_motion  a carrying motion was blocked, where the observation contradicts only what it itself settles
smaller_object  a held object does not fill the squares in which it was seen
larger_object  a held object goes on in what seemed to be wall
parted_object  a held object is only a part of what seemed one thing
frame  another frame
origin_from_turns  another origin, as turned objects tell it
earlier_motion  an earlier motion ended elsewhere, or slipped
origin  a motion was blocked, and the origin lies elsewhere
others  others moved, took or brought things
lifted  others put the robot elsewhere
"""
