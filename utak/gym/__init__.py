"""TABLETOP as a Gymnasium environment, for other minds. Needs the extra `gym`: `pip install gymnasium`.

    import gymnasium
    import utak.gym                                                             # registers utak/Tabletop-v0
    env = gymnasium.make("utak/Tabletop-v0", scenario="examples/go_next_room")

`gymnasium.make("utak.gym:utak/Tabletop-v0", ...)` imports this package by itself.

Modules in reading order:

registration  makes the environment known to Gymnasium
actions       how actions are written: as a dictionary, as a box of numbers, as one number
progress      which expectations are met, halt after halt
game          a table that is played on: commands, rewards, the end
environment   the environment
pixels        the table as an image
"""

from utak.gym.registration import register_environments

register_environments()
