"""Virtual instruments that measure reflectance models: the gonio-spectrophotometer and the glossmeter.

`glossmeter.gloss_units` reads gloss, `inversion.invert_gloss` goes back to parameters,
`paint_gloss` across to the gloss
space; `goniospectrophotometer` gives flux, scans and spectra through `apertures.Aperture`, `colorimetry` their
colour.
"""
