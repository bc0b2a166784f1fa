import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from gloss_stimuli.coefficients import Coefficients, average

EXPONENTS = ((0, 1), (1, 1), (0, 2), (2, 1), (1, 2))


def estimates(count: int = 40) -> np.ndarray:
    rng = np.random.default_rng(2)
    mixing = rng.normal(size=(len(EXPONENTS), len(EXPONENTS)))
    return (5 + np.einsum("ab,kbp->kap", mixing, rng.normal(size=(count, len(EXPONENTS), 3)))).astype(np.float32)


def test_luminance_is_the_polynomial() -> None:
    mean = np.array([[1.0], [2.0], [3.0], [4.0], [5.0]], dtype=np.float32)
    luminance = Coefficients(EXPONENTS, mean, np.zeros((10, 1), np.float32)).luminance(0.5, 0.1)
    # By hand: .1·1 + .05·2 + .01·3 + .025·4 + .005·5
    assert luminance[0] == pytest.approx(0.1 + 0.1 + 0.03 + 0.1 + 0.025, rel=1e-14)


def test_mean_and_variance_are_those_of_the_composed_images() -> None:
    """Composing every estimate first and taking its scatter is another way to the same numbers."""
    drawn = estimates()
    drawn[:, 4] = 1.0  # a term beyond the covariance: constant, so that it adds no variance
    rho_d, rho_s = 0.6, 0.2
    composed = sum(rho_d**i * rho_s**j * drawn[:, m].astype(float) for m, (i, j) in enumerate(EXPONENTS))
    result = average(EXPONENTS, iter(drawn))
    # float32 storage
    np.testing.assert_allclose(result.luminance(rho_d, rho_s), composed.mean(0), rtol=1e-6)
    np.testing.assert_allclose(result.variance(rho_d, rho_s), composed.var(0, ddof=1) / len(drawn), rtol=1e-4)


def test_zero_reflectance_leaves_nothing_of_a_specular_pass() -> None:
    result = average(EXPONENTS, iter(estimates()))
    assert (result.luminance(0.5, 0.0) == 0).all()
    assert (result.variance(0.5, 0.0) == 0).all()


def test_the_threads_of_a_linear_algebra_library_change_no_bit() -> None:
    # A size at which OpenBLAS, given several threads, rounds a product of matrices in another way.
    rows = np.random.default_rng(1).normal(size=(10, 1022 * 770)).astype(np.float32)
    exponents, bits = EXPONENTS * 2, set()
    for threads in (1, 2, 3):
        with threadpool_limits(threads):
            bits.add(Coefficients(exponents, rows, rows).luminance(0.2, 0.1).tobytes())
    assert len(bits) == 1


def test_one_estimate_has_no_error() -> None:
    with pytest.raises(ValueError, match="at least two"):
        average(EXPONENTS, iter(estimates(1)))
