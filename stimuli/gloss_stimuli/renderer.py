"""What a renderer is: anything that turns stimuli into luminance with an honest error; set rendering asks no more."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.code_error import CodeError
from glossspace.stimulus_set import Stimulus

__all__ = ["Renderer", "Rendering", "Step", "alphas_of", "passes_of"]


class Step(Protocol):
    """One step of the work is done."""

    def __call__(self, *, more: int = 0) -> None:
        """Advance by one; `more` steps than were expected have turned out to be needed."""


@dataclass(frozen=True)
class Rendering:
    """One stimulus, rendered.

    Attributes
    ----------
    stimulus : Stimulus
    luminance : array of float64, shape (H, W)
        Scene luminance in cd/m².
    error : CodeError
        Estimate of its error in code values, from independent randomisations.
    details : dict
        What the manifest shall say of this image, such as its number of samples; JSON types only.
    white_luminance : array of float64, shape (H, W), or None
        Luminance of the same scene with a perfect diffuser in place of the paint, where the renderer knows it.
    """

    stimulus: Stimulus
    luminance: NDArray[np.float64]
    error: CodeError
    details: dict[str, Any] = field(default_factory=dict)
    white_luminance: NDArray[np.float64] | None = None


class Renderer(Protocol):
    """One way to render the stimuli of one scene; it decides for itself how much work its error target needs."""

    method: str
    """Name of the method, as the manifest and the terminal give it."""

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the luminance of a stimulus: same key, same bits."""

    def steps(self, stimuli: Sequence[Stimulus]) -> int:
        """Number of times that `render` is likely to call its `step`, for a progress display."""

    def render(self, stimuli: Sequence[Stimulus], *, step: Step) -> Iterator[Rendering]:
        """Render stimuli one after the other, in an order that suits the method; each is complete when it is given."""

    def describe(self) -> dict[str, Any]:
        """Parameters for the manifest, such as seed and samples."""


def passes_of(stimulus: Stimulus) -> tuple[float | None, ...]:
    """The parts of an image that renderers share between stimuli: None, which knows no lobe, and the roughness.

    Without a specular term α is not seen.
    """
    return (None, stimulus.alpha) if stimulus.rho_s > 0 else (None,)


def alphas_of(stimuli: Sequence[Stimulus]) -> list[float]:
    """The roughnesses that are seen, ascending."""
    return sorted({stimulus.alpha for stimulus in stimuli if stimulus.rho_s > 0})
