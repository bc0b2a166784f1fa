import itertools

import numpy as np
import pytest

from gloss_stimuli.lattice import lattice_generator


def worst_case_error(generator: tuple[int, ...], count: int) -> float:
    """Squared worst-case error by the double sum over frequencies' closed form, point by point (Sloan & Joe 1994)."""
    total = 0.0
    for n in range(count):
        product = 1.0
        for dimension, z in enumerate(generator):
            x = n * z % count / count
            product *= 1 + 0.8**dimension * 2 * np.pi**2 * (x * x - x + 1 / 6)
        total += product
    return total / count - 1


@pytest.mark.parametrize("count", [8, 16, 32])
def test_two_dimensions_are_as_good_as_the_best_that_repeats_nothing(count: int) -> None:
    best = min(worst_case_error((1, z), count) for z in range(1, count, 2))
    assert worst_case_error(lattice_generator(count, 2), count) == pytest.approx(best, rel=1e-9)  # ties by rounding


def test_no_dimension_repeats_a_value() -> None:
    count = 64
    for z in lattice_generator(count, 20):
        assert len({n * z % count for n in range(count)}) == count


def test_lattice_beats_chance_on_a_smooth_integral() -> None:
    count, dimensions = 256, 4
    points = np.outer(np.arange(count), lattice_generator(count, dimensions)) % count / count
    integral = np.prod(1 + np.sin(2 * np.pi * points) / 2, axis=1).mean()
    # Exactly 1. By chance the error would be sqrt((1.125^4 - 1) / 256) = 0.048.
    assert integral == pytest.approx(1.0, abs=0.002)


@pytest.mark.parametrize("count", [0, 3, 12, -4])
def test_only_powers_of_two(count: int) -> None:
    with pytest.raises(ValueError, match="power of two"):
        lattice_generator(count, 2)


def test_tiny_lattices() -> None:
    assert list(itertools.chain(lattice_generator(1, 3), lattice_generator(2, 2))) == [1, 1, 1, 1, 1]
