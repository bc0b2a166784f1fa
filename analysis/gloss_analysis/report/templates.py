"""The texts of the report, and how numbers are written in them."""

from jinja2 import Environment, PackageLoader, StrictUndefined

from gloss_analysis.report.numbers import counted, fixed, interval, joined, p_value

__all__ = ["environment"]


def environment(*, escaped: bool) -> Environment:
    """Open the folder of templates; `escaped` for HTML, where a name from a file must not become a tag."""
    opened = Environment(
        loader=PackageLoader("gloss_analysis"),
        autoescape=escaped,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    opened.filters |= {
        "fixed": fixed,
        "interval": interval,
        "joined": joined,
        "p_value": p_value,
        "counted": counted,
    }
    return opened
