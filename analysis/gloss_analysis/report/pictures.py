"""A picture of the report, and the files that are made of it: the same figure gives the same bytes."""

import base64
import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Picture", "data_uri", "drawn", "finished"]

# No date: it would change the bytes of an unchanged figure.
_METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
    "png": {"Software": None},
}
_STYLE: Any = {
    "svg.hashsalt": "glossspace",
    # Letters as outlines in SVG and as embedded TrueType in PDF: both look alike on any machine.
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}
_STRIP_INCHES = 0.2


@dataclass(frozen=True)
class Picture:
    """A figure as the report shows it and as files hold it.

    Attributes
    ----------
    name : str
        Of its files, without ending.
    files : mapping of str to bytes
        By their endings; `svg` at least, which the page shows unless there is a `png`.
    alternative : str
        Text for those who cannot see it.
    caption : str
    """

    name: str
    files: dict[str, bytes]
    alternative: str
    caption: str

    @property
    def source(self) -> str:
        """The picture itself, for the `src` of an image."""
        if "png" in self.files:
            return data_uri(self.files["png"], "image/png")
        return data_uri(self.files["svg"], "image/svg+xml")

    @property
    def exported(self) -> dict[str, bytes]:
        """File names with their content: what is left beside the report."""
        return {f"{self.name}.{kind}": content for kind, content in self.files.items() if kind != "png"}


def drawn(
    name: str, figure: "Figure", alternative: str, caption: str, *, observers: str = "human", raster: bool = False
) -> Picture:
    """Make a picture of a figure.

    Parameters
    ----------
    name : str
        Of its files, without ending.
    figure : Figure
        Is changed where it must say that observers are simulated.
    alternative, caption : str
    observers : str
        Whose judgements it shows; other than "human" it is written into the figure, which may leave the report.
    raster : bool
        Whether the page shows pixels, as photographs need, instead of outlines.

    Returns
    -------
    Picture
    """
    if observers != "human":
        _mark(figure, f"{observers} observers")
        caption = f"{caption} {observers.capitalize()} observers."
    kinds = ("svg", "pdf", "png") if raster else ("svg", "pdf")
    return Picture(name, {kind: _encoded(figure, kind) for kind in kinds}, alternative, caption)


def finished(name: str, folder: Path, stem: str, alternative: str, caption: str) -> Picture | None:
    """Take a picture that lies in a folder as SVG, and perhaps as PDF; None where it does not."""
    files = {kind: path.read_bytes() for kind in ("svg", "pdf") if (path := folder / f"{stem}.{kind}").is_file()}
    return Picture(name, files, alternative, caption) if "svg" in files else None


def data_uri(content: bytes, kind: str) -> str:
    """Content of a file as an address that needs no network."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def _mark(figure: "Figure", words: str) -> None:
    """Write words at the top left, in a strip that the figure grows by."""
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + _STRIP_INCHES)
    part = _STRIP_INCHES / (height + _STRIP_INCHES)
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.set(rect=(0, 0, 1, 1 - part))  # type: ignore[call-arg]
    figure.text(0.01, 1 - part / 2, words, ha="left", va="center", fontsize=7, color="0.35")


def _encoded(figure: "Figure", kind: str) -> bytes:
    import matplotlib

    buffer = io.BytesIO()
    with matplotlib.rc_context(_STYLE), warnings.catch_warnings():
        # Names in a script that the font lacks show as boxes; whoever looks sees that.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        figure.savefig(buffer, format=kind, dpi=170, metadata=_METADATA[kind])
    return buffer.getvalue()
