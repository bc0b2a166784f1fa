"""How exact a rendering must be: an error in code values that a fraction of the pixels of every image stays below."""

from dataclasses import asdict, dataclass

from gloss_stimuli.code_error import CodeError
from glossspace.errors import GlossError

__all__ = ["DEFAULT_TARGET", "TARGETS", "ErrorTarget", "find_target"]


@dataclass(frozen=True, kw_only=True)
class ErrorTarget:
    """The error that a rendering aims at.

    Attributes
    ----------
    max_code_error : float
        Largest error in 8-bit code values, before rounding.
    fraction : float
        Share of the pixels of every image that must stay within it, between 0 and 1.

    Raises
    ------
    GlossError
        A number is out of range.

    Examples
    --------
    >>> ErrorTarget(max_code_error=0.5, fraction=0.999)
    ErrorTarget(max_code_error=0.5, fraction=0.999)
    """

    max_code_error: float
    fraction: float

    def __post_init__(self) -> None:
        if not 0 < self.max_code_error < float("inf"):
            raise GlossError(f"max-code-error must be a finite number above 0, but is {self.max_code_error}.")
        if not 0 < self.fraction < 1:
            raise GlossError(f"fraction must lie between 0 and 1, both excluded, but is {self.fraction}.")

    def is_reached(self, error: CodeError) -> bool:
        """Whether an image with this estimated error meets the target."""
        return error.within(self.max_code_error) >= self.fraction

    def to_dict(self) -> dict[str, float]:
        """As JSON takes it."""
        return asdict(self)


DEFAULT_TARGET = "exact"
TARGETS = {
    "draft": ErrorTarget(max_code_error=2.0, fraction=0.99),
    "exact": ErrorTarget(max_code_error=0.5, fraction=0.999),
}


def find_target(name: str, *, max_code_error: float | None = None, fraction: float | None = None) -> ErrorTarget:
    """Target of that name, with one or both of its numbers replaced.

    Raises
    ------
    GlossError
        There is none of that name, or a number is out of range.
    """
    if name not in TARGETS:
        raise GlossError(f"Unknown quality '{name}'. Allowed are {' and '.join(TARGETS)}.")
    named = TARGETS[name]
    return ErrorTarget(
        max_code_error=named.max_code_error if max_code_error is None else max_code_error,
        fraction=named.fraction if fraction is None else fraction,
    )
