"""Readings for tests: of simulated screens, some passed off as a photometer's so that a session takes them."""

from dataclasses import replace

from gloss_experiments.calibration import Readings, SimulatedScreen, simulated_readings, standard_patches

PAPER = SimulatedScreen()  # 0.7 to 108 cd/m² with a gamma of 2.35: section 3.2.3.2 of the gloss paper
SKEWED = SimulatedScreen(gamma=(2.2, 2.35, 2.5), offset=(0.05, -0.03, 0.02))


def readings_of(screen=PAPER, *, patches=None, photometer=None, **noise):
    found = simulated_readings(screen, patches, **noise)
    return found if photometer is None else Readings(found.items, photometer)


def gray_only():
    """The standard patches without those of single channels."""
    return [patch for patch in standard_patches() if patch.is_gray]


def changed(readings, change):
    """Readings with the luminance of each put through ``change(patch, luminance)``; None leaves the reading out."""
    items = []
    for reading in readings.items:
        luminance = change(reading.patch, reading.luminance_cd_m2)
        if luminance is not None:
            items.append(replace(reading, luminance_cd_m2=luminance))
    return Readings(tuple(items), readings.photometer)
