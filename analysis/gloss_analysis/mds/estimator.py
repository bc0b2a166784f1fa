"""The scaling as an estimator that scikit-learn users know."""

from typing import Any

import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils import check_random_state

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.square_matrix import from_matrices
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.restriction import FREE, Restriction
from gloss_analysis.mds.search import scale
from gloss_analysis.mds.solution import MdsSolution, Model

__all__ = ["ThreeWayMDS"]


class ThreeWayMDS(BaseEstimator):
    """Weighted non-metric multidimensional scaling of one or more sources of dissimilarities.

    Parameters
    ----------
    n_components : int
        Number of dimensions.
    model : {"weighted", "identity", "generalised"}
        How participants may differ.
    level : {"ordinal", "spline", "interval", "ratio"}
        What of the dissimilarities is trusted.
    ties : {"primary", "secondary"}
        Ordinal only: whether equal dissimilarities may have different disparities.
    conditional : bool
        Whether each source has a transformation of its own.
    restriction : Restriction, optional
        Fixed stimuli, or coordinates made of external variables.
    n_init : int
        Number of starts.
    random_state : int, RandomState or None
        Seed of the random starts; None for others each time.
    n_jobs : int, optional
        Threads; the result does not depend on it.

    Attributes
    ----------
    solution_ : MdsSolution
        Everything that was found.
    embedding_ : ndarray, shape (n, n_components)
        The group space.
    dimension_weights_ : ndarray, shape (m, n_components)
    stress_ : float
        Stress-1, the root of the mean over sources of its square.
    n_features_in_ : int
        Number of stimuli.

    Notes
    -----
    See `scale` for the method, the conventions and what is refused.

    Examples
    --------
    >>> square = [[0, 1, 2, 1], [1, 0, 1, 2], [2, 1, 0, 1], [1, 2, 1, 0]]
    >>> ThreeWayMDS(n_components=2, model="identity", ties="secondary").fit_transform(square).shape
    (4, 2)
    """

    def __init__(
        self,
        n_components: int = 2,
        *,
        model: Model = "weighted",
        level: Level = "ordinal",
        ties: Ties = "primary",
        conditional: bool = True,
        restriction: Restriction | None = None,
        n_init: int = 100,
        random_state: Any = 1,
        n_jobs: int | None = None,
    ) -> None:
        self.n_components = n_components
        self.model = model
        self.level = level
        self.ties = ties
        self.conditional = conditional
        self.restriction = restriction
        self.n_init = n_init
        self.random_state = random_state
        self.n_jobs = n_jobs

    def fit(self, X: Any, y: Any = None, *, init: "np.ndarray | None" = None) -> "ThreeWayMDS":
        """Scale dissimilarities.

        Parameters
        ----------
        X : Dissimilarities, or array_like of shape (n, n) or (m, n, n)
            Square matrices, one a source; NaN where a pair was not judged.
        y : None
            Not used.
        init : ndarray, shape (n, n_components), optional
            A further start.

        Returns
        -------
        ThreeWayMDS
            Itself.

        Raises
        ------
        GlossError
            A parameter is not allowed, or the data cannot determine a configuration.
        """
        data = X if isinstance(X, Dissimilarities) else from_matrices(X)
        self.solution_: MdsSolution = scale(
            data,
            n_dims=self.n_components,
            model=self.model,
            level=self.level,
            ties=self.ties,
            conditional=self.conditional,
            restriction=FREE if self.restriction is None else self.restriction,
            n_starts=self.n_init,
            seed=self._seed(),
            initial=() if init is None else (init,),
            n_jobs=self.n_jobs or 1,
        )
        self.embedding_ = self.solution_.coordinates
        self.dimension_weights_ = self.solution_.dimension_weights
        self.stress_ = self.solution_.stress1
        self.n_features_in_ = len(data.stimuli)
        return self

    def _seed(self) -> int:
        if isinstance(self.random_state, int | np.integer):
            return int(self.random_state)
        return int(check_random_state(self.random_state).randint(2**31 - 1))

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.pairwise = True
        return tags

    def fit_transform(self, X: Any, y: Any = None, *, init: "np.ndarray | None" = None) -> np.ndarray:
        """Scale dissimilarities and return the group space, shape (n, n_components). See `fit`."""
        return self.fit(X, y, init=init).embedding_
