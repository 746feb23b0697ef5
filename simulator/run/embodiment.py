"""The only bridge between robot and world: commands go in, impressions come out, nothing else passes."""

from utak.kb.body import Command, Grasp, Impression, Move, Push, Release, Turn
from utak.simulator.world.physics import Tabletop


class Embodiment:
    """Utak's body on a table; satisfies the protocol `utak.kb.body.Body`."""

    def __init__(self, table: Tabletop) -> None:
        self.__table = table

    def wake(self) -> Impression:
        """Return the first impression."""
        return Impression(*self.__table.look())

    def act(self, command: Command) -> Impression:
        """Execute one command and return the impression at the place where Utak stops."""
        carry_out(self.__table, command)
        return Impression(*self.__table.look())


def carry_out(table: Tabletop, command: Command) -> None:
    """Execute one command on a table, as far as the world allows."""
    match command:
        case Move(east, north):
            table.move(east, north)
        case Push(east, north):
            table.push(east, north)
        case Turn(degrees):
            table.turn(degrees)
        case Grasp(direction):
            table.grasp(direction)
        case Release():
            table.release()
