"""The account of the 160 fields of an impression: what the map allowed each of them to show, and what they showed."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Square
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.frames import FieldRanges
from kb.mapping.occupancy import OCCUPIED, OPEN, OccupancyMap
from kb.perception.frame import Samples
from kb.perception.retina import FIELDS, MAX_GRAY_LEVEL, OWN_FIELD

FIELD_AREAS = np.array([field.side**2 for field in FIELDS])  # squares under each of the 160 fields


class CellStatus(StrEnum):
    """The status of a field of an impression: predicted, explained by squares that were open, or noise."""

    PREDICTED = "predicted"
    EXPLAINED = "explained"
    NOISE = "noise"


class FieldAccount(NamedTuple):
    """The account of the 160 fields, in the order of an impression, by the map as it was before the impression.

    The impression counts as received where the chosen explanation says, in its frame.

    Attributes
    ----------
    status : the status of each field.
    least, most : the least and the greatest gray level, 0 to 7, that the map and the held objects allowed each field.
    occupied : whether each field shows anything occupied, that is a gray level above 0.
    square : the square on which the impression was received, map frame.
    samples : the squares under each field, as offsets from that square, map frame; those of held objects left out.
    """

    status: tuple[CellStatus, ...]
    least: tuple[int, ...]
    most: tuple[int, ...]
    occupied: tuple[bool, ...]
    square: Square
    samples: Samples


class Accommodation(NamedTuple):
    """The result of localisation for one impression.

    Attributes
    ----------
    explanation : the chosen one.
    fields : how each of the 160 fields of the retina is accounted for.
    """

    explanation: Explanation
    fields: FieldAccount


def account_for_fields(
    occupancy: OccupancyMap, samples: Samples, ranges: FieldRanges, left: FieldRanges, square: Square
) -> FieldAccount:
    """Return the account of an impression, before it is integrated into the map.

    A field is noise when it contradicts the map; it is explained when it covers a square that was settled neither as
    free nor as occupied; else it is predicted.

    Parameters
    ----------
    occupancy : the map; it grows to hold all that is in sight.
    samples : the squares under each field, in the believed frame, held objects left out.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field.
    left : the same, held objects left out.
    square : the square from which the impression was received, map frame.
    """
    noise = occupancy.misfits(samples, left, *square)
    row, column = occupancy.index(*square)
    state = occupancy.state[samples.rows + row, samples.columns + column]
    is_open = (state == OPEN) & (samples.weight > 0)
    status = tuple(
        CellStatus.NOISE if wrong else CellStatus.EXPLAINED if new else CellStatus.PREDICTED
        for wrong, new in zip(noise.tolist(), is_open.any(1).tolist(), strict=True)
    )
    full = (samples.weight * (state == OCCUPIED)).sum(1)
    least = full + ranges[:, 1] - left[:, 1]
    most = full + (samples.weight * is_open).sum(1) + samples.slack + ranges[:, 0] - left[:, 0]
    occupied = tuple((ranges[:, 0] > 0).tolist())
    return FieldAccount(status, gray_levels(least), gray_levels(most), occupied, square, samples)


def gray_levels(counts: NDArray[np.integer]) -> tuple[int, ...]:
    """Return the gray levels, 0 to 7, that the 160 fields show for so many occupied squares; the own field shows 7.

    counts : (160,) integers; those beyond what a field can hold count as what it can hold.
    """
    levels = (2 * MAX_GRAY_LEVEL * np.clip(counts, 0, FIELD_AREAS) + FIELD_AREAS) // (2 * FIELD_AREAS)
    levels[OWN_FIELD] = MAX_GRAY_LEVEL
    return tuple(levels.tolist())
