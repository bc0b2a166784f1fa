"""Where stimuli lie along the axes of a gloss space."""

import pandas as pd

from gloss_analysis.ratings.magnitude import mean_ratings
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint

__all__ = ["axis_coordinates", "rated_along"]


def axis_coordinates(stimuli: pd.DataFrame, names: list[str], space: GlossSpace = PAPER_SPACE) -> pd.DataFrame:
    """Coordinates c and d of the named stimuli, unweighted, one row each in the order of `names`.

    Parameters
    ----------
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`.
    names : list of str
    space : GlossSpace
        Whose axis functions they are.

    Returns
    -------
    DataFrame
        Columns `stimulus`, `c`, `d`.

    Raises
    ------
    GlossError
        A name is not among the stimuli, or its parameters are impossible.

    Examples
    --------
    >>> paints = pd.DataFrame({"stimulus": ["gray"], "rho_d": 0.193, "rho_s": 0.066, "alpha": 0.07})
    >>> axis_coordinates(paints, ["gray"])["c"].round(5).tolist()
    [0.08702]
    """
    indexed = stimuli.drop_duplicates("stimulus").set_index("stimulus")
    unknown = [name for name in names if name not in indexed.index]
    if unknown:
        raise GlossError(
            f"The stimulus {unknown[0]!r} was judged, but its rho_d, rho_s and alpha are not known "
            f"({len(unknown)} such). Give a table (`--stimuli`) or the stimulus set that describes it."
        )
    c, d = space.coordinates(Paint(*(indexed.loc[names, column].to_numpy() for column in ("rho_d", "rho_s", "alpha"))))
    return pd.DataFrame({"stimulus": names, "c": c, "d": d})


def rated_along(stimuli: pd.DataFrame, table: pd.DataFrame, space: GlossSpace = PAPER_SPACE) -> pd.DataFrame:
    """Mean ratings beside the coordinates: the columns of `mean_ratings`, `c` and `d`."""
    means = mean_ratings(table)
    return means.merge(axis_coordinates(stimuli, list(means["stimulus"]), space), on="stimulus", validate="one_to_one")
