"""The mutation tool: what it changes, what it leaves alone, and that a sample can be had again."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from tests.mutation.__main__ import EQUIVALENT, ROOMS, report, share, stale
from tests.mutation.places import Mutation, places, sample
from tests.mutation.trees import CHECKOUT, PACKAGE, Outcome, stages


def shown(tmp_path: Path, source: str) -> set[str]:
    """What the lines of a file become, one mutation each."""
    (tmp_path / "one.py").write_text(source)
    return {mutation.shown(source)[1] for each in places(tmp_path, ["one.py"])
            for mutation in each}


@pytest.mark.parametrize(("source", "after"), [
    ("a + b", {"a - b"}), ("a ** b", {"a * b"}), ("(a) * (b)", {"(a) / (b)"}),
    ("a < b", {"a <= b", "a >= b"}), ("a is not b", {"a is b"}), ("a in b", {"a not in b"}),
    ("a and b and c", {"a or b and c"}), ("-a", {"a"}), ("not a", {"a"}), ("True", {"False"}),
    ("0", {"1"}), ("2.0", {"2.2"}), ("0.0", {"1.0"}), ("min(a, b)", {"max(a, b)", "None"}),
    ("np.sin(a)", {"np.cos(a)", "None"}), ("abs(a - b)", {"(a - b)", "abs(a + b)", "None"}),
    ("a.any(axis=1)", {"a.all(axis=1)", "a.any(axis=2)", "None"}), ("a[:n]", {"a[:n - 1]"}),
    ("range(a, b)", {"range(a, b - 1)", "None"}), ("a += b", {"a -= b"}),
    ("a if b else c", {"a if (not (b)) else c"}), ("é = 'ü' in a", {"é = 'ü' not in a"}),
    ("for a in b:\n    continue", {"pass"}),
])
def test_a_place_is_changed_in_one_way_at_a_time(tmp_path, source, after):
    assert shown(tmp_path, source) == after


@pytest.mark.parametrize("source", [
    '"""A text: 1 + 2."""', 'f"{a + 1:.3f} of {b}"', "raise ValueError(a + 1)", "assert a > 0",
    "def f(a: dict[str, 3]) -> list[2]: ...", "@cache(1)\ndef f(): ...", "from a import b",
    "class A:\n    def __repr__(self):\n        return 1 + 2", "zip(a, b, strict=True).c",
    "isinstance(a, Pin | Slot).b", "a = 'x' + b", "a = b + [c]", "a = (b  # why: c\n     + d)",
])
def test_what_no_test_can_be_asked_to_notice_is_left_alone(tmp_path, source):
    assert shown(tmp_path, source) == set()


def test_the_same_seed_draws_the_same_places_and_another_draws_others():
    drawn = [sample(PACKAGE, ["control"], seed, 20) for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2]
    assert len(set(drawn[0])) == 20
    for mutation in drawn[0]:
        source = (PACKAGE / mutation.file).read_text()
        changed = mutation.of(source)
        compile(changed, mutation.file, "exec")
        assert changed != source
        assert len(changed) - len(source) == len(mutation.text) - (mutation.end - mutation.start)


@pytest.mark.parametrize("room", ROOMS)
def test_every_room_has_places_and_tests_that_are_asked_first(room):
    files = sorted((PACKAGE / room).rglob("*.py"))
    assert places(PACKAGE, [room])
    for path in files:
        asked = stages(path.relative_to(PACKAGE).as_posix(), whole=True)
        assert len(asked) == len(set(asked)) > 3
        assert all((CHECKOUT / stage).exists() for stage in asked)
    assert stages("scene/values/units.py", whole=False)[0] == "tests/scene/test_units.py"


def test_the_report_counts_survivors_with_a_reason_apart():
    mutations = [Mutation("audit/rest.py", 1, i, i + 1, "") for i in range(4)]
    outcomes = [Outcome(one, state, "", 1.0) for one, state in zip(
        mutations, ("killed", "timeout", "survived", "survived"), strict=True)]
    source = (PACKAGE / "audit/rest.py").read_text()
    known = {("audit/rest.py", *mutations[2].shown(source)): "it is the same"}
    assert share(outcomes, {}) == 0.5
    assert share(outcomes, known) == pytest.approx(2 / 3)
    assert share([], {}) == 1.0
    lines = report(outcomes, known).splitlines()
    assert lines[2].split() == ["audit", "4", "1", "1", "1", "1", "66.7", "%"]
    assert lines[3].split()[0] == "all"
    assert sum(line.startswith("audit/rest.py:1") for line in lines) == 1


def test_every_equivalent_mutant_says_why_and_a_changed_line_is_told():
    known = tomllib.loads(EQUIVALENT.read_text())["mutant"]
    assert [each for each in known if len(each["reason"]) < 20] == []
    kept = {(each["file"], each["before"], each["after"]): each["reason"] for each in known}
    assert len(kept) == len(known)
    gone = ("audit/rest.py", "a = b + c", "a = b - c")
    assert gone in stale({**kept, gone: "it is the same"})
    assert stale(kept) == []
