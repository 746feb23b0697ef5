"""What is being planned, in words, for whoever waits; nothing that decides reads it."""


class UnderWay:
    """The plan that is being looked for, and how far that is."""

    words = ""


UNDER_WAY = UnderWay()  # of this process: a thread that reports reads it while another one plans
