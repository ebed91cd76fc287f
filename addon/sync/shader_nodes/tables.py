# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that look colors up: ramps, curves and spectra, as tables of rows at even places."""

from functools import cache

import numpy as np

from ...engine.expression import (
    Parameter,
    Table,
    as_type,
    call,
    component,
    is_constant,
    less,
    maximum,
    mix,
)
from . import spectra
from .registry import reads

#: Rows of ramps and curves, as Cycles has them.
_ROWS = 256
_PLACES = np.linspace(0.0, 1.0, _ROWS)


def _ramp_rows(ramp):
    """The colors (256, 4) of a ramp; for one of steps twice as many rows, see `color_of_steps`."""
    rows = np.array([ramp.evaluate(place) for place in _PLACES])
    if ramp.interpolation != "CONSTANT":
        return rows
    between = np.zeros_like(rows)
    for element in ramp.elements:
        row, between_rows = divmod(element.position * (_ROWS - 1), 1.0)
        between[min(int(row), _ROWS - 1), 0] = between_rows
    return np.concatenate([rows, between])


@reads("VALTORGB")
def color_ramp(n):
    ramp, factor = n.node.color_ramp, n.number("Factor", "Fac")
    if is_constant(factor):
        color = Parameter(tuple(ramp.evaluate(min(max(factor.value[0], 0.0), 1.0))))
    elif ramp.interpolation == "CONSTANT":
        color = call("color_of_steps", Table(_ramp_rows(ramp)), factor)
    else:
        color = call("color_of_table", Table(_ramp_rows(ramp)), _ROWS, 0, factor)
    return {"Color": as_type(color, "vec3"), "Alpha": component(color, 3)}


def _curve_table(mapping, curves, combined=None):
    """The rows (256, 4) of curves, each where the `combined` one leads to; the numbers that they start and end at."""
    mapping.initialize()
    used = [*curves, *([combined] if combined else [])]
    low, high = min(c.points[0].location.x for c in used), max(c.points[-1].location.x for c in used)
    rows = np.zeros((_ROWS, 4))
    for row, place in zip(rows, low + (high - low) * _PLACES, strict=True):
        place = mapping.evaluate(combined, place) if combined else place
        row[: len(curves)] = [mapping.evaluate(curve, place) for curve in curves]
    return Table(rows), Parameter(low), Parameter(high)


def _of_curves(n, curves, combined=None):
    """What three curves make of the color or vector of a node."""
    mapping = n.node.mapping
    table, low, high = _curve_table(mapping, curves, combined)
    color = n.color(1)
    places = (color - low) / (high - low)
    return mix(color, call("color_of_curves", table, mapping.extend == "EXTRAPOLATED", places), n.number(0))


@reads("CURVE_RGB")
def rgb_curves(n):
    *curves, combined = n.node.mapping.curves
    return _of_curves(n, curves, combined)


@reads("CURVE_VEC")
def vector_curves(n):
    return _of_curves(n, list(n.node.mapping.curves)[:3])


@reads("CURVE_FLOAT")
def float_curve(n):
    mapping = n.node.mapping
    table, low, high = _curve_table(mapping, list(mapping.curves)[:1])
    x = n.number(1)
    place = (x - low) / (high - low)
    bent = call("color_of_table", table, _ROWS, mapping.extend == "EXTRAPOLATED", place)
    return mix(x, component(bent, 0), n.number(0))


def _table_of(colors):
    return Table(np.concatenate([colors, np.ones((len(colors), 1))], axis=-1))


@cache
def _blackbody_table():
    """Rows of even steps in the inverse of the temperature, over which the color changes evenly."""
    return _table_of(spectra.blackbody(1.0 / np.linspace(1.0 / spectra.COLDEST, 1.0 / spectra.HOTTEST, _ROWS)))


@reads("BLACKBODY")
def blackbody(n):
    temperature = n.number("Temperature")
    if is_constant(temperature):
        return Parameter(spectra.blackbody(np.array(temperature.value))[0])
    coldest, hottest = 1.0 / spectra.COLDEST, 1.0 / spectra.HOTTEST
    place = (coldest - 1.0 / maximum(temperature, spectra.COLDEST)) / (coldest - hottest)
    return as_type(call("color_of_table", _blackbody_table(), _ROWS, 0, place), "vec3")


@cache
def _wavelength_table():
    return _table_of(spectra.of_wavelengths())


@reads("WAVELENGTH")
def wavelength(n):
    """Black beyond what is seen."""
    colors = spectra.of_wavelengths()
    place = (n.number("Wavelength") - spectra.FIRST) / (spectra.LAST - spectra.FIRST)
    if is_constant(place):
        x, rows = place.value[0], np.linspace(0.0, 1.0, len(colors))
        return Parameter([np.interp(x, rows, channel, left=0.0, right=0.0) for channel in colors.T])
    color = as_type(call("color_of_table", _wavelength_table(), len(colors), 0, place), "vec3")
    return color * less(0.0, place) * less(place, 1.0)
