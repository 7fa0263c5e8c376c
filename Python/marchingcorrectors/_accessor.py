# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""PyVista's particles.sph, which PyVista finds by the package's entry point."""
from __future__ import annotations

from typing import Any, Iterable, Optional, Sequence, Tuple, Union

import numpy as np
import pyvista

from . import _functions
from ._library import InvalidArgument
from ._vtk_particles import GHOSTS, QUANTITIES, detect, name_of

Quantity = Union[None, str, float, np.ndarray]


@pyvista.register_dataset_accessor("sph", pyvista.DataSet)
class SphAccessor:
    """Surfaces of the points of a data set, taken as SPH particles.

    All methods take these keywords, and all options of marchingcorrectors.isosurface():

    smoothing_length, volume, mass, density: the name of a point array, an array, or one value for
        all; by default the point array with a usual name (SmoothingLength, hsml, h; Mass; rho, ...).
    fluid: ("ParticleType", 0): where this point array has another value, there are solids.
    attributes: names of the point arrays to be carried along; by default all.
    """

    def __init__(self, particles: pyvista.DataSet):
        self._particles = particles

    def isosurface(self, scalar: Union[str, np.ndarray], iso: Union[float, Sequence[float]], *,
                   scalar_dot: Union[None, str, np.ndarray] = None, **options: Any) -> pyvista.PolyData:
        """Where a point array (its magnitude, or scalar_component=0, 1, ...) has the value `iso`.

        Example: particles.sph.isosurface("Velocity", 1.0).plot()
        """
        words = self._words(options)
        dot = None if scalar_dot is None else self._array(scalar_dot)
        return _functions.isosurface(self._particles.points, self._array(scalar), iso=iso, scalar_dot=dot,
                                     **words).to_pyvista()

    def free_surface(self, iso: Union[float, Sequence[float]] = 0.5, **options: Any) -> pyvista.PolyData:
        """The surface of the fluid: where the sum of the particles' weights (no unit) is `iso`."""
        return _functions.free_surface(self._particles.points, iso=iso, **self._words(options)).to_pyvista()

    def probe(self, points: Union[pyvista.DataSet, np.ndarray], **options: Any) -> pyvista.DataSet:
        """A copy of the points (a data set, or (points, 3)) with the field of the point arrays at
        them, "WeightSum", and "Valid": 1 where there is fluid."""
        words = self._words(options)
        words["attributes"] = {k: v for k, v in words["attributes"].items() if v.dtype.kind in "fiub"}
        result = points.copy() if isinstance(points, pyvista.DataSet) else pyvista.PolyData(np.asarray(points))
        found = _functions.probe(self._particles.points, result.points, **words)
        for name, values in found.values.items():
            result.point_data[name] = values
        for name, values in found.gradients.items():
            result.point_data[name + "_Gradient"] = values.reshape(len(values), -1)
        result.point_data["WeightSum"] = found.weight_sum
        result.point_data["Valid"] = found.valid.astype(np.uint8)
        return result

    def derivatives(self, array: str, **options: Any) -> pyvista.DataSet:
        """A copy of the particles with "Gradients" of a point array; of one with three components
        also "Divergence", "Vorticity", "Q-criterion", "Lambda2" and "StrainRate"."""
        words = self._words({**options, "attributes": []})
        words["attributes"] = {"array": self._array(array)}
        gradients = _functions.derivatives(self._particles.points, **words).gradients.get("array")
        if gradients is None:
            raise InvalidArgument(f"The point array '{array}' is NaN or infinite at a particle.")
        result = self._particles.copy()
        result.point_data["Gradients"] = gradients.reshape(len(gradients), -1)
        if gradients.shape[1:] == (3, 3):
            names = {"divergence": "Divergence", "vorticity": "Vorticity", "q_criterion": "Q-criterion",
                     "lambda2": "Lambda2", "strain_rate": "StrainRate"}
            for name, values in _functions.flow(gradients).items():
                result.point_data[names[name]] = values.reshape(len(values), -1) if values.ndim > 1 else values
        return result

    def _array(self, thing):
        if not isinstance(thing, str):
            return np.asarray(thing)
        if thing not in self._particles.point_data:
            raise InvalidArgument(f"There is no point array '{thing}'. Point arrays: "
                                  f"{', '.join(self._particles.point_data.keys()) or 'none'}.")
        return np.asarray(self._particles.point_data[thing])

    def _words(self, options):
        """Keywords for the functions of NumPy."""
        words = dict(options)
        self._set_quantities(words)
        fluid: Optional[Tuple[str, float]] = words.pop("fluid", None)
        if fluid is not None:
            words["solid"] = self._array(fluid[0]) != fluid[1]
        names: Optional[Iterable[str]] = words.pop("attributes", None)
        if names is None:
            names = [name for name in self._particles.point_data.keys() if name != GHOSTS]
        words["attributes"] = {name: self._array(name) for name in names}
        return words

    def _set_quantities(self, words):
        """As vtkMarchingCorrectors does: with a mass set, a volume array that is there is not used."""
        given = {quantity for quantity in QUANTITIES if words.get(quantity) is not None}
        for quantity in given:
            if not np.isscalar(words[quantity]) or isinstance(words[quantity], str):
                words[quantity] = self._array(words[quantity])
        if not words.get("estimate_smoothing_length"):
            self._detect(words, "smoothing_length")
        if not given & {"mass", "density"}:
            self._detect(words, "volume")
        if words.get("volume") is None:
            self._detect(words, "mass")
            if words.get("mass") is not None:
                self._detect(words, "density")

    def _detect(self, words, quantity):
        if words.get(quantity) is None:
            found = detect(self._particles.GetPointData(), self._particles.n_points, quantity)
            if found is not None:
                words[quantity] = self._array(name_of(found))
