"""The state of localisation, and the situation in which an observation is to be explained.

In reading order:

state  what is believed after an observation, as one frozen value: pose, frame hypotheses, occupancy map, held objects
situation  a state with the observation after it, and with the explanations of it that were found so far
frames_left  another frame that the observations leave, where they refute the believed one before any object was moved
"""
