# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear RGB of light of one wavelength and of black bodies, from what the CIE's standard observer sees."""

import numpy as np

#: Of the observer's table, nm.
FIRST, LAST, _STEP = 380.0, 780.0, 5.0
#: Temperatures, K, beyond which Cycles shows the same color.
COLDEST, HOTTEST = 800.0, 12000.0
#: CIE 1931 color matching functions of the 2 degree observer from FIRST to LAST, (x, y, z) in 1 / 10 000.
_OBSERVER = np.array(
    """
    14 0 65  22 1 105  42 1 201  76 2 362  143 4 679  232 6 1102
    435 12 2074  776 22 3713  1344 40 6456  2148 73 10391  2839 116 13856  3285 168 16230
    3483 230 17471  3481 298 17826  3362 380 17721  3187 480 17441  2908 600 16692  2511 739 15281
    1954 910 12876  1421 1126 10419  956 1390 8130  580 1693 6162  320 2080 4652  147 2586 3533
    49 3230 2720  24 4073 2123  93 5030 1582  291 6082 1117  633 7100 782  1096 7932 573
    1655 8620 422  2257 9149 298  2904 9540 203  3597 9803 134  4334 9950 87  5121 10000 57
    5945 9950 39  6784 9786 27  7621 9520 21  8425 9154 18  9163 8700 17  9786 8163 14
    10263 7570 11  10567 6949 10  10622 6310 8  10456 5668 6  10026 5030 3  9384 4412 2
    8544 3810 2  7514 3210 1  6424 2650 0  5419 2170 0  4479 1750 0  3608 1382 0
    2835 1070 0  2187 816 0  1649 610 0  1212 446 0  874 320 0  636 232 0
    468 170 0  329 119 0  227 82 0  158 57 0  114 41 0  81 29 0
    58 21 0  41 15 0  29 10 0  20 7 0  14 5 0  10 4 0
    7 2 0  5 2 0  3 1 0  2 1 0  2 1 0  1 0 0
    1 0 0  1 0 0  0 0 0
    """.split(),
    np.float64,
).reshape(-1, 3) / 1e4  # fmt: skip
#: From CIE XYZ to linear RGB of Rec. 709.
_TO_RGB = np.array(
    ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
)
#: What Cycles divides by so that no wavelength has a component above 1.
_BRIGHTEST = 2.52
_PLANCK, _LIGHT, _BOLTZMANN = 6.62607015e-34, 2.99792458e8, 1.380649e-23  # J s, m / s, J / K


def of_wavelengths():
    """The RGB (81, 3) of the wavelengths from FIRST to LAST, at even places."""
    return np.maximum(_OBSERVER @ _TO_RGB.T / _BRIGHTEST, 0.0)


def blackbody(temperature):
    """The RGB (n, 3) of luminance 1 of bodies of temperatures (n,), K."""
    wavelength = np.linspace(FIRST, LAST, len(_OBSERVER)) * 1e-9
    kelvin = np.clip(temperature, COLDEST, HOTTEST)[:, None]
    exponent = _PLANCK * _LIGHT / (_BOLTZMANN * kelvin * wavelength)
    power = 1.0 / (wavelength / wavelength[-1]) ** 5 / np.expm1(exponent)
    xyz = power @ _OBSERVER
    return np.maximum(xyz @ _TO_RGB.T / xyz[:, 1:2], 0.0)
