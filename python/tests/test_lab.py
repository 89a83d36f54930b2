"""Scores, compared with each other and with what their figures mean."""

import pytest

import ademan


def test_people_with_more_scatter_make_more_errors(program):
    steady = ademan.lab.score("qwerty-flat", people=3, tier="T0", count=2)
    unsteady = ademan.lab.score("qwerty-flat", people=3, tier="T3", count=2)
    for score in (steady, unsteady):
        row = score.figures.loc["cer"]
        assert row["low"] <= row["value"] <= row["high"]
        assert len(score.people) == 3
        errors = score.people[["substitutions", "insertions", "deletions"]].to_numpy().sum()
        assert row["value"] == pytest.approx(errors / score.people["characters"].sum())
        assert score.keys["meant"].sum() == score.people["strokes"].sum()
        assert score.keys["hit_rate"].between(0, 1).all()
        assert score.phrases["errors"].sum() == errors
        assert score.phrases.groupby("person")["phrase"].max().eq(1).all()
    assert unsteady.figures.loc["cer", "value"] > steady.figures.loc["cer", "value"] + 0.1


def test_a_pointer_has_rows_of_its_own(program):
    score = ademan.lab.score("direct", people=2, source="ideal")
    assert list(score.figures.columns) == ["value", "low", "high"]
    assert not score.figures.isna().to_numpy().any()
    throughput = score.figures.loc["pointing_throughput"]
    assert 0 < throughput["low"] <= throughput["value"] <= throughput["high"]


def test_the_same_seed_has_the_same_result(program):
    first, second = (ademan.lab.score("numpad", people=2, phrases="digits", count=2, seed=7) for _ in range(2))
    assert first.result == second.result


def test_what_the_program_refuses_is_an_error(program):
    with pytest.raises(ademan.ProgramError, match="qwerty-no-such: there is no such file"):
        ademan.lab.score("qwerty-no-such")
