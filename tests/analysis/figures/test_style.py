"""Looks of families: the same in every figure, and one for those that nobody listed."""

from granstudy.analysis.figures.front import benchmark_front
from granstudy.analysis.figures.lines import looks
from granstudy.analysis.figures.style import FAMILY_COLOURS, family_styles


def test_listed_families_look_the_same_whatever_stands_beside_them():
    alone, beside = family_styles(["fast"]), family_styles(["radial", "new", "fast"])
    assert alone["fast"] == beside["fast"]
    assert alone["fast"].colour == FAMILY_COLOURS["fast"]
    assert list(beside) == ["fast", "radial", "new"]


def test_others_come_last_in_colours_of_their_own():
    names = ["zeta", "alpha", "direct", "fast"]
    styles = family_styles(names)
    assert list(styles) == ["direct", "fast", "alpha", "zeta"]
    assert len({style.colour for style in styles.values()}) == len(names)


def test_a_front_shows_a_method_that_nobody_listed(front):
    methods = ["literal", "new", "new", "fast", "fast"]
    table = front.assign_coords(method=("run", methods), rtol=("run", [-1.0] * 5))
    labels = [text.get_text() for text in benchmark_front([table]).legends[0].get_texts()]
    assert labels[:2] == ["literal", "new"]


def test_the_papers_line_lies_under_one_other():
    two = looks([("literal",), ("new",)])
    assert two["literal",]["linewidth"] > two["new",]["linewidth"]
    assert len({look["color"] for look in two.values()}) == 2
