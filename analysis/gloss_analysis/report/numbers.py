"""Numbers in words and text: digits, signs, intervals and lists as the report writes them."""

from collections.abc import Sequence

import numpy as np

__all__ = ["counted", "fixed", "interval", "joined", "p_value"]

_WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")


def fixed(value: float | None, digits: int) -> str:
    """A number with so many decimals, a real minus sign, and no sign at a rounded zero; a dash for NaN and None.

    Examples
    --------
    >>> fixed(-0.0004, 3), fixed(-1.5, 1), fixed(None, 2)
    ('0.000', '−1.5', '–')
    """
    if value is None or np.isnan(value):
        return "–"
    if np.isinf(value):
        return "∞" if value > 0 else "−∞"
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0 else text.replace("-", "−")


def interval(ends: Sequence[float] | None, digits: int) -> str:
    """An interval as "1.60 to 1.95"; "not known" without one.

    Examples
    --------
    >>> interval((1.6, 1.949), 2), interval(None, 2)
    ('1.60 to 1.95', 'not known')
    """
    return "not known" if ends is None else f"{fixed(ends[0], digits)} to {fixed(ends[1], digits)}"


def p_value(p: float) -> str:
    """A probability with its sign of equality, never 0.

    Examples
    --------
    >>> p_value(0.19), p_value(1e-9)
    ('= 0.19', '< 0.001')
    """
    return "< 0.001" if p < 0.001 else f"= {p:.2g}"


def counted(number: int, what: str, several: str | None = None) -> str:
    """A number of things, small ones in words.

    Examples
    --------
    >>> counted(9, "participant"), counted(1, "study", "studies"), counted(62, "stimulus", "stimuli")
    ('nine participants', 'one study', '62 stimuli')
    """
    word = _WORDS[number] if 0 <= number < len(_WORDS) else str(number)
    return f"{word} {what if number == 1 else several or what + 's'}"


def joined(words: Sequence[str]) -> str:
    """Words as a list: "a, b and c"."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
