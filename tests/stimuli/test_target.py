import numpy as np
import pytest
from scipy.stats import norm

from gloss_stimuli.code_error import CodeError
from gloss_stimuli.target import DEFAULT_TARGET, TARGETS, ErrorTarget, find_target
from glossspace.errors import GlossError


def uniform_error(sigma: float) -> CodeError:
    return CodeError(np.array([sigma]), np.array([1.0]))


def test_the_two_names_are_the_projects_targets() -> None:
    # Issue 3: half a code value on 99.9 % of the pixels is the default, draft and exact are names for two targets.
    assert DEFAULT_TARGET == "exact"
    assert find_target("exact") == ErrorTarget(max_code_error=0.5, fraction=0.999)
    assert find_target("draft") == ErrorTarget(max_code_error=2.0, fraction=0.99)
    assert set(TARGETS) == {"draft", "exact"}


def test_one_or_both_numbers_of_a_named_target_can_be_replaced() -> None:
    assert find_target("exact", max_code_error=0.25) == ErrorTarget(max_code_error=0.25, fraction=0.999)
    assert find_target("draft", fraction=0.5) == ErrorTarget(max_code_error=2.0, fraction=0.5)
    assert find_target("draft", max_code_error=3, fraction=0.5) == ErrorTarget(max_code_error=3, fraction=0.5)
    assert TARGETS["exact"] == ErrorTarget(max_code_error=0.5, fraction=0.999)


def test_a_target_is_reached_where_enough_pixels_stay_within_it() -> None:
    target = ErrorTarget(max_code_error=0.5, fraction=0.999)
    largest_sigma = 0.5 / norm.ppf(0.9995)  # 99.9 % of a normal distribution lie within so many of it
    assert target.is_reached(uniform_error(largest_sigma * 0.999))
    assert not target.is_reached(uniform_error(largest_sigma * 1.001))


def test_the_manifest_gets_both_numbers() -> None:
    assert find_target("exact").to_dict() == {"max_code_error": 0.5, "fraction": 0.999}


@pytest.mark.parametrize("value", [0, -0.5, float("nan"), float("inf")])
def test_an_error_that_cannot_be_is_refused(value: float) -> None:
    with pytest.raises(GlossError, match=f"max-code-error must be a finite number above 0, but is {value}"):
        find_target("exact", max_code_error=value)


@pytest.mark.parametrize("value", [0, 1, 99.9, -0.1, float("nan")])
def test_a_fraction_that_cannot_be_is_refused(value: float) -> None:
    # 1 would be an error that no pixel ever exceeds, which no estimate can promise.
    with pytest.raises(GlossError, match=f"fraction must lie between 0 and 1, both excluded, but is {value}"):
        find_target("exact", fraction=value)


def test_an_unknown_name_is_told() -> None:
    with pytest.raises(GlossError, match="Unknown quality 'best'. Allowed are draft and exact"):
        find_target("best")
