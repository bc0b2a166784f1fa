"""Reflectance models with one interface, Fresnel's equations, and a check of any model.

========================  ==================================================================================
`Lambert`                 perfectly diffuse
`Ward`                    isotropic or anisotropic, in three normalisations
`Phong`                   the normalised lobe around the mirror direction
`CookTorrance`            as the glossmeter paper writes it, or with Beckmann's distribution of facets
`Ggx`                     with Smith's masking
`Tabulated`               a gonio-spectrophotometer's table; `grid_from_rows` makes one from rows
`Sum`                     of any of these, also written ``a + b``
========================  ==================================================================================

`check_model` tells whether a model, also one's own, is reciprocal, conserves energy, draws what it says and stays
finite.
"""

from glossspace.reflectance.check import ModelCheck, check_model
from glossspace.reflectance.cook_torrance import CookTorrance
from glossspace.reflectance.fresnel import fresnel_reflectance
from glossspace.reflectance.ggx import Ggx
from glossspace.reflectance.gonio_table import grid_from_rows
from glossspace.reflectance.lambert import Lambert
from glossspace.reflectance.model import ReflectanceModel, Sample, direction
from glossspace.reflectance.phong import Phong
from glossspace.reflectance.spectrum import at_wavelengths
from glossspace.reflectance.sum import Sum
from glossspace.reflectance.tabulated import Tabulated
from glossspace.reflectance.ward import Ward

__all__ = [
    "CookTorrance",
    "Ggx",
    "Lambert",
    "ModelCheck",
    "Phong",
    "ReflectanceModel",
    "Sample",
    "Sum",
    "Tabulated",
    "Ward",
    "at_wavelengths",
    "check_model",
    "direction",
    "fresnel_reflectance",
    "grid_from_rows",
]
