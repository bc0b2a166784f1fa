"""Texts in any script: signs that the font lacks, and lines of right-to-left writing that break where they should.

PsychoPy turns right-to-left text into the order in which it is seen and joins Arabic letters, but only then breaks it
into lines, so that the first words of a paragraph would stand in its last line. It is broken here before.
"""

import re
import unicodedata
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from gloss_experiments.protocol import Protocol
from gloss_experiments.window.window import own_fonts
from glossspace.errors import GlossError

__all__ = [
    "break_lines",
    "composed",
    "is_right_to_left",
    "language_style",
    "protocol_texts",
    "require_font",
    "written",
]

# Families that every system has under a name of its own.
_GENERIC = ("serif", "sans-serif", "sans", "monospace", "system-ui")
_MOST_SIGNS = 12
# What a reader of these scripts can do without.
_POINTS = ("HEBREW", "ARABIC", "VARIATION SELECTOR")


def is_right_to_left(text: str) -> bool:
    """Whether a text has letters of a script that is written from right to left.

    Examples
    --------
    >>> is_right_to_left("Gloss 100"), is_right_to_left("ברק")
    (False, True)
    """
    return any(unicodedata.bidirectional(sign) in ("R", "AL") for sign in text)


def composed(text: str) -> str:
    """A text whose letters and marks are one sign where there is one: of a letter with marks the window draws one sign.

    Examples
    --------
    >>> len("u\u0308ber"), len(composed("u\u0308ber"))
    (5, 4)
    """
    # Word by word, and the shorter one: of some letters that are one sign, NFC makes two.
    return re.sub(r"\S+", lambda word: min(word[0], unicodedata.normalize("NFC", word[0]), key=len), text)


def language_style(texts: Iterable[str]) -> str:
    """How PsychoPy calls the way texts are written: ``"Arabic"`` for every right-to-left script, or ``"LTR"``."""
    return "Arabic" if any(map(is_right_to_left, texts)) else "LTR"


def break_lines(text: str, width_px: float, measure_px: Callable[[str], float]) -> str:
    """Break every paragraph at spaces so that no line is wider than `width_px`, unless one word alone is.

    Examples
    --------
    >>> break_lines("one two three", 8, len)
    'one two\\nthree'
    """
    lines = []
    for paragraph in text.split("\n"):
        line = ""
        for word in paragraph.split(" "):
            longer = f"{line} {word}" if line else word
            if line and measure_px(longer) > width_px:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    return "\n".join(lines)


def written(text: str, *, font: str, height_px: float, width_px: float) -> str:
    """A composed text, one from right to left broken into lines as wide as PsychoPy lets them be."""
    text = composed(text)
    if not is_right_to_left(text):
        return text
    return break_lines(text, width_px, partial(_width_px, font=font, height_px=height_px))


def require_font(window: Any, protocol: Protocol) -> None:
    """Let a window show a protocol's texts only in its own font, and only if that has every sign of them.

    Which signs a font has can be looked up on Linux alone.

    Parameters
    ----------
    window
        Of PsychoPy.
    protocol
        Its texts and their font.

    Raises
    ------
    GlossError
        The font is not here, so that texts would be shown in another; it lacks signs, which would be boxes; or letters
        have marks, as those of Thai, which would be left out.
    """
    from psychopy import visual
    from pyglet import font

    name, texts = protocol.texts.font, [composed(text) for text in protocol_texts(protocol)]
    # As PsychoPy shows them: Arabic letters in their joined forms, which are signs of their own.
    shown = visual.TextStim(
        window, text=" ".join(texts), font=name, fontFiles=own_fonts(), languageStyle=language_style(texts)
    ).text
    if not name.strip() or (name.lower() not in _GENERIC and not font.have_font(name)):
        raise GlossError(
            f"texts.font '{name}' is not installed here, so texts would be shown in another font. Install it, or name "
            "one that is: fc-list lists them."
        )
    signs = dict.fromkeys(sign for sign in shown if not _is_blank(sign))
    face = getattr(_load(name, protocol.texts.size_px), "face", None)
    missing = [] if face is None else [sign for sign in signs if not face.get_character_index(sign)]
    if missing:
        some = missing[:_MOST_SIGNS]
        listed = " ".join(some) + (" …" if len(missing) > len(some) else "")
        codes = " ".join(f"{ord(sign):x}" for sign in some)
        raise GlossError(
            f"texts.font '{name}' has no sign for: {listed}. Name an installed font that has them, such as "
            f"'fc-list \":charset={codes}\" family' lists."
        )
    undrawn = [] if face is None else _undrawn(shown)
    if undrawn:
        raise GlossError(
            f"The window draws no marks on letters on this system: of {' '.join(undrawn[:_MOST_SIGNS])} it would show "
            "the first sign alone. Write the texts without such marks."
        )


def protocol_texts(protocol: Protocol) -> list[str]:
    """Everything that a protocol lets an observer read."""
    texts = protocol.texts.model_dump(exclude={"font", "size_px"})
    return [*texts.values(), protocol.slider.low_label, protocol.slider.high_label]


def _undrawn(shown: str) -> list[str]:
    """Letters with marks that reading needs: pyglet takes them together, and FreeType draws the first sign alone."""
    from pyglet.font.base import get_grapheme_clusters

    clusters = dict.fromkeys(get_grapheme_clusters(shown))
    return [cluster for cluster in clusters if any(map(_is_needed, cluster[1:]))]


def _is_needed(sign: str) -> bool:
    is_seen = not sign.isspace() and unicodedata.category(sign) != "Cf"
    return is_seen and not unicodedata.name(sign, "").startswith(_POINTS)


def _width_px(line: str, *, font: str, height_px: float) -> float:
    return float(sum(glyph.advance for glyph in _load(font, height_px).get_glyphs(line))) if line else 0.0


def _is_blank(sign: str) -> bool:
    """Whether nothing is drawn for a sign: spaces, line ends, marks of direction."""
    return sign.isspace() or unicodedata.category(sign) in ("Cc", "Cf", "Mn")


def _load(font_name: str, height_px: float) -> Any:
    from pyglet import font

    return font.load(font_name, int(height_px), dpi=72)  # as PsychoPy loads it
