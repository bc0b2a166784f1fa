"""Calibrating a screen: from photometer readings to the display that stimuli are made for."""

from gloss_experiments.calibration.checks import check_additivity, check_stray_light, check_uniformity, check_warm_up
from gloss_experiments.calibration.export import luminance_csv, scene_section, write_luminance
from gloss_experiments.calibration.figure import draw_calibration, save_figure
from gloss_experiments.calibration.fit_table import fit_table
from gloss_experiments.calibration.gain_offset_gamma import fit_gain_offset_gamma
from gloss_experiments.calibration.measuring import Pace, measure, simulated_pace
from gloss_experiments.calibration.patches import Patch, standard_patches
from gloss_experiments.calibration.photometer import Photometer, open_plugin_photometer, plugin_photometers
from gloss_experiments.calibration.readings import Reading, Readings, read_readings, write_readings
from gloss_experiments.calibration.record import (
    Calibration,
    StoredCalibration,
    calibrate,
    read_calibration,
    save_calibration,
)
from gloss_experiments.calibration.screen_identity import ScreenIdentity, connected_edid_sha256
from gloss_experiments.calibration.screen_model import fit_screen, verify
from gloss_experiments.calibration.simulated import SimulatedPhotometer, SimulatedScreen, simulated_readings

__all__ = [
    "Calibration",
    "Pace",
    "Patch",
    "Photometer",
    "Reading",
    "Readings",
    "ScreenIdentity",
    "SimulatedPhotometer",
    "SimulatedScreen",
    "StoredCalibration",
    "calibrate",
    "check_additivity",
    "check_stray_light",
    "check_uniformity",
    "check_warm_up",
    "connected_edid_sha256",
    "draw_calibration",
    "fit_gain_offset_gamma",
    "fit_screen",
    "fit_table",
    "luminance_csv",
    "measure",
    "open_plugin_photometer",
    "plugin_photometers",
    "read_calibration",
    "read_readings",
    "save_calibration",
    "save_figure",
    "scene_section",
    "simulated_pace",
    "simulated_readings",
    "standard_patches",
    "verify",
    "write_luminance",
    "write_readings",
]
