"""The plan that is being looked for, in words, to be shown while it takes long. No decision reads it."""


class UnderWay:
    """The plan that is being looked for, and how far the search is."""

    words = ""


UNDER_WAY = UnderWay()  # of this process: a thread that reports reads it while another one plans
