"""Names of patches: kept by overlap, and by things that others moved."""

from utak.kb.mapping.patch import Patch, patch_of_squares
from utak.kb.world.object_names import ObjectNames


def block(x: int, y: int, width: int, height: int) -> Patch:
    return patch_of_squares({(x + i, y + j) for i in range(width) for j in range(height)})


def test_a_patch_keeps_the_name_of_the_patch_that_it_overlaps() -> None:
    names = ObjectNames()
    assert names.assign([block(0, 0, 3, 3), block(9, 0, 2, 2)]) == ["o1", "o2"]
    assert names.assign([block(9, 1, 2, 2), block(1, 0, 3, 3)]) == ["o2", "o1"]
    assert names.assign([block(30, 1, 2, 2)]) == ["o3"]


def test_a_missing_thing_is_the_new_patch_that_is_most_nearly_as_large() -> None:
    names = ObjectNames()
    names.assign([block(0, 0, 3, 3)])
    names.miss({"o1": 9})
    assert names.missing == ("o1",)
    assert names.assign([block(40, 0, 9, 9)]) == ["o2"]  # nine times as large: another thing
    assert names.assign([block(40, 0, 9, 9), block(20, 0, 1, 4), block(30, 0, 4, 3)]) == ["o2", "o3", "o1"]
    assert names.missing == ()


def test_names_given_on_another_map_are_not_given_again() -> None:
    one, other = ObjectNames(), ObjectNames()
    one.assign([block(0, 0, 3, 3)])
    other.assign([block(0, 0, 1, 1), block(5, 0, 1, 1)])
    assert one.counted(other).assign([block(0, 0, 3, 3), block(9, 0, 2, 2)]) == ["o1", "o3"]
