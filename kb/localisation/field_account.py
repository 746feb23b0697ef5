"""The account of the 160 fields of an impression: what the map allowed each of them to show, and what they showed."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import FIELDS, MAX_GRAY_LEVEL, OWN_FIELD
from utak.geometry.kernels.arrays import Square
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges
from utak.kb.mapping.occupancy import OCCUPIED, OPEN, OccupancyMap
from utak.kb.perception.frame import Samples

FIELD_AREAS = np.array([field.side**2 for field in FIELDS])  # squares under each of the 160 fields


class CellStatus(StrEnum):
    """The status of a field of an impression: predicted, explained by squares that were open, or noise."""

    PREDICTED = "predicted"
    EXPLAINED = "explained"
    NOISE = "noise"


class FieldAccount(NamedTuple):
    """The account of the 160 fields, in the order of an impression, by the map as it was before the impression."""

    status: tuple[CellStatus, ...]  # the status of each field
    # The least and the greatest gray level, 0 to 7, that the map and the held objects allowed each field
    least: tuple[int, ...]
    most: tuple[int, ...]
    occupied: tuple[bool, ...]  # whether each field shows anything occupied, that is a gray level above 0
    square: Square  # the square on which the impression was received, map frame
    # The squares under each field, as offsets from that square, map frame; those of held objects left out
    samples: Samples


class Accommodation(NamedTuple):
    """The result of localisation for one impression."""

    explanation: Explanation  # the chosen one
    fields: FieldAccount  # how each of the 160 fields of the retina is accounted for


def account_for_fields(
    occupancy: OccupancyMap, samples: Samples, ranges: FieldRanges, left: FieldRanges, square: Square
) -> FieldAccount:
    """Return the account of an impression, before it is integrated into the map."""
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
    """Return the gray levels, 0 to 7, that the 160 fields show for so many occupied squares; the own field shows 7."""
    levels = (2 * MAX_GRAY_LEVEL * np.clip(counts, 0, FIELD_AREAS) + FIELD_AREAS) // (2 * FIELD_AREAS)
    levels[OWN_FIELD] = MAX_GRAY_LEVEL
    return tuple(levels.tolist())
