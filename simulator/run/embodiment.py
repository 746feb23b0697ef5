"""The only bridge between robot and world: commands go in, impressions come out, nothing else passes."""

from dataclasses import astuple

from utak.kb.body import Command, Impression
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
    """Execute one command on a table, as far as the world allows: the table has a method of each command's name."""
    getattr(table, type(command).__name__.lower())(*astuple(command))
