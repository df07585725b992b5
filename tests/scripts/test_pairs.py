"""What something costs a run is measured by pairs, of which the one or the other goes first."""

from __future__ import annotations

from scripts.measures.pairs import pairs


def test_each_of_a_pair_goes_first_in_turn_and_the_first_ones_do_not_count() -> None:
    order: list[str] = []

    def run(name: str) -> int:
        order.append(name)
        return len(order)

    found = pairs(3, lambda: run("without"), lambda: run("with"))
    assert order[:2] == ["without", "with"]
    assert order[2:] == ["without", "with", "with", "without", "without", "with"]
    assert found == [(3, 4), (6, 5), (7, 8)]
