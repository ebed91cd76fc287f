"""What the benchmark makes of its measurements: spreads, fits, tables, interpolation."""

import numpy as np
import pytest

from addon.engine.bvh import build, sah_cost
from benchmarks import cycles, results, tests_a_ray
from benchmarks.measuring import Spread, geometric_mean, in_turn, power_law
from benchmarks.tables import Table, digits
from benchmarks.whitted import differing


def test_programs_run_in_turn_and_one_that_fails_does_not_end_the_others():
    order = []

    def runner(name, values):
        def run():
            order.append(name)
            return values.pop(0)

        return run

    spreads, reasons = in_turn({"a": runner("a", [3.0, 1.0, 2.0]), "b": runner("b", [1.0])}, 3)
    assert order == ["a", "b", "a", "b", "a"]
    assert spreads == {"a": Spread(2.0, 1.0, 3.0, 3)}
    assert reasons["b"].startswith("IndexError")


def test_geometric_mean_and_power_law():
    assert geometric_mean([0.5, 2.0, 8.0]) == pytest.approx(2.0)
    exponent, factor = power_law([10, 100, 1000], [2.0 * n**0.3 for n in (10, 100, 1000)])
    assert (exponent, factor) == pytest.approx((0.3, 2.0))


@pytest.mark.parametrize(
    "value, text", [(0, "0"), (1234.4, "1234"), (12.345, "12.3"), (1.0, "1.00"), (0.01234, "0.0123"), (1e-6, "1.0e-06")]
)
def test_digits(value, text):
    assert digits(value) == text


def test_tables_as_text_and_markdown():
    table = Table("Title", ("scene", "s"))
    table.add("balls", 1.5)
    table.notes.append("why")
    assert table.text() == "Title\nscene    s\nballs  1.5\n- why"
    assert table.markdown() == "**Title**\n\n| scene | s |\n| --- | ---: |\n| balls | 1.5 |\n\n- why"
    with pytest.raises(ValueError, match="3 cells"):
        table.add(1, 2, 3)


def test_results_are_written_and_read(tmp_path):
    results.save("some", {"seconds": 2.0}, [Table("Title", ("a",))], tmp_path)
    assert results.load("some", tmp_path)["seconds"] == 2.0
    assert results.load("some", tmp_path)["machine"]["cores"] > 0
    assert results.load("other", tmp_path) is None


def test_noise_falls_with_the_root_of_the_samples():
    reached = cycles.reaching({1: 0.2, 16: 0.05}, {1: 1.0, 16: 4.0}, 0.01)
    assert reached["samples"] == pytest.approx(400.0)
    assert reached["seconds"] == pytest.approx(1.0 + 0.2 * 399.0)
    assert not reached["measured"]


def test_pictures_differ_in_the_pixels_that_are_far_apart():
    picture = np.zeros((2, 2, 3))
    other = picture.copy()
    other[0, 0, 1], other[1, 1] = 0.5, 0.01
    assert differing(picture, other) == 0.25


def test_lines_through_a_hierarchy_test_as_much_as_its_sah_cost_says():
    random = np.random.default_rng(1)
    center = random.random((500, 3))
    bvh = build(center - 0.02, center + 0.02)
    nodes, primitives = tests_a_ray.tested(
        bvh, *tests_a_ray.lines_through(bvh.bounds.astype(np.float64), 20_000, random)
    )
    assert nodes + 0.5 * primitives == pytest.approx(sah_cost(bvh), rel=0.03)
