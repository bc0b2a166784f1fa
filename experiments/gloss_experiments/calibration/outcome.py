"""What a calibration leaves: its files, and what it says on the terminal."""

from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from gloss_experiments.calibration.export import check_luminance_name, write_luminance
from gloss_experiments.calibration.figure import check_figure_name, save_figure
from gloss_experiments.calibration.record import Calibration, save_calibration
from glossspace.console import note, print_json, print_table
from glossspace.errors import GlossError
from glossspace.files import check_file_target

__all__ = ["check_targets", "keep", "report", "sentences"]


def check_targets(out: Path, luminance: Path | None, figure: Path | None) -> None:
    """Refuse files that cannot be written, before long work.

    Raises
    ------
    GlossError
        Two have one name, a suffix is not allowed, or a folder cannot be written to.
    """
    if figure is not None:
        check_figure_name(figure)
    if luminance is not None:
        check_luminance_name(luminance)
    targets = [path for path in (out, luminance, figure) if path is not None]
    if len({path.resolve() for path in targets}) < len(targets):
        raise GlossError("Two outputs have the same name. Give --out, --luminance and --figure different ones.")
    for path in targets:
        check_file_target(path)


def keep(found: Calibration, out: Path, luminance: Path | None, figure: Path | None) -> None:
    """Write the calibration, and the luminance table and the figure where they are wanted."""
    save_calibration(found, out)
    if luminance is not None:
        write_luminance(found, luminance)
        note(f"Luminance: {luminance}")
    if figure is not None:
        save_figure(found, figure)
        note(f"Figure: {figure}")


def report(found: Calibration, out: Path, *, json: bool) -> None:
    """Print a calibration: the residuals of its verification patches, and a sentence on everything else."""
    for remark in found.remarks():
        note(remark)
    if json:
        print_json(found.to_dict())
        return
    verification = found.verification
    rows = zip(
        verification.codes,
        verification.measured_cd_m2,
        verification.predicted_cd_m2,
        verification.error_cd_m2,
        verification.error_percent,
        verification.delta_l,
        strict=True,
    )
    table = pd.DataFrame(
        [(" ".join(map(str, codes)), *(round(number, 4) for number in numbers)) for codes, *numbers in rows],
        columns=["verification patch", "measured cd/m²", "predicted cd/m²", "error cd/m²", "error %", "ΔL*"],
    )
    said = " (SIMULATED)" if found.simulated else ""
    print_table(table, title=f"{found.screen.name}{said}, {found.measured_at:%Y-%m-%d}: {found.model.name}")
    print(found.reason())
    print("\n".join(sentences(found)))
    print(f"Calibration: {out}")


def sentences(found: Calibration) -> Iterator[str]:
    """What a calibration says beside its residuals."""
    display = found.display
    yield f"Black {display.black_cd_m2:.4g} cd/m², white {display.white_cd_m2:.4g} cd/m²."
    fitted = found.model.gain_offset_gamma
    if fitted is not None:
        for name, curve in fitted.curves.items():
            yield (
                f"{name.capitalize()}: gamma {curve.gamma:.4f} ± {curve.gamma_half_width:.2g}, gain {curve.gain:.4f}, "
                f"offset {curve.offset:.4f} ± {curve.offset_half_width:.2g}, range {curve.range_cd_m2:.4g} ± "
                f"{curve.range_half_width:.2g} cd/m² (95 %)."
            )
    for one in found.additivity:
        yield f"Additivity at code {one.code}: {one.error_percent:+.2f} % (ΔL* {one.delta_l:+.2f})."
    for uneven in found.uniformity:
        yield f"Right over left at code {uneven.code}: {uneven.right_over_left:.4f} (ΔL* {uneven.delta_l:+.2f})."
    stray = found.stray_light
    if stray.veiling_cd_m2 is not None:
        share = f"{stray.veiling_percent:.2g} % of white"
        yield f"Veiling light in a white field: {stray.veiling_cd_m2:.3g} cd/m² ({share})."
    if stray.ambient_cd_m2 is not None:
        share = "" if stray.ambient_percent_of_black is None else f" ({stray.ambient_percent_of_black:.2g} % of black)"
        yield f"Ambient light on the switched-off screen: {stray.ambient_cd_m2:.3g} cd/m²{share}."
    warm = found.warm_up
    if warm is not None:
        stable = "not stable yet" if warm.stable_after_min is None else f"stable after {warm.stable_after_min:g} min"
        yield f"Warm-up: {stable}, drift {warm.drift_percent:+.2f} % over {warm.minutes[-1]:g} min."
