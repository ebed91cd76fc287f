# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that materials and images keep."""

import pytest

from addon.sync.places import Places


@pytest.fixture
def places():
    return Places("vacant", spare=1)


def test_what_is_put_again_stands_where_it_stood(places):
    assert [places.put(key, [key]) for key in "abc"] == [0, 1, 2]
    assert places.put("b", ["new"]) == 1
    assert places.things == ["a", "new", "c"]
    assert list(places.of("b")) == [1] and not places.of("unknown")


def test_things_of_a_key_stand_together_and_move_where_they_are_more(places):
    places.put("a", ["a"])
    assert places.put("tiles", [1, 2]) == 1
    assert places.put("tiles", [3, 4]) == 1 and places.things == ["a", 3, 4]
    assert places.put("tiles", [5, 6, 7]) == 3 and places.things == ["a", "vacant", "vacant", 5, 6, 7]
    assert list(places.of("tiles")) == [3, 4, 5]


def test_a_single_thing_takes_a_vacant_place(places):
    for key in "abc":
        places.put(key, [key])
    places.drop("b")
    assert places.things == ["a", "vacant", "c"]
    assert places.put("d", ["d"]) == 1 and places.put("e", ["e"]) == 3


def test_a_renamed_key_keeps_its_place(places):
    places.put("frame 1", ["x"])
    places.rename("frame 1", "frame 2")
    assert places.put("frame 2", ["y"]) == 0 and places.things == ["y"] and list(places.keys()) == ["frame 2"]


def test_some_that_nobody_uses_are_spared(places):
    for key in "abc":
        places.put(key, [key])
    places.drop_unused(lambda key: key != "a")
    assert places.things == ["a", "b", "c"]
    places.drop_unused(lambda key: key == "b")
    assert places.things == ["vacant", "b", "vacant"] and list(places.keys()) == ["b"]
