# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The accessor `sph` of PyVista's data sets (particles.sph.isosurface(...)), which PyVista finds by the package's entry point."""
from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Iterable, Optional, Sequence, Tuple, Union

import numpy as np
import pyvista

from . import _functions
from ._arrays import QUANTITIES, Found, as_points
from ._call import Keywords, own_keywords
from ._library import InvalidArgument, warn
from ._options import DERIVATIVES, FREE_SURFACE, GAUGE, ISOSURFACE, PROBE, PROJECT, Function, camel, did_you_mean, show
from ._vtk import GHOSTS, WALL_BLOCK, describe_lost, describe_mesh, find_period, join_blocks, named, take_vertices, to_numpy
from .io import Particles as FileParticles

if TYPE_CHECKING:
    from typing_extensions import Unpack

ABOUT_PARTICLES = '''
        smoothing_length, volume, mass, density: the name of a point array, an array, or one value
            for all; by default the point array with a usual name (SmoothingLength, hsml, h; Mass;
            rho, ...). volume="computed": by the particles' distances and masses, whatever volumes
            and densities there are.
        fluid: ("ParticleType", 0) or "ParticleType=0": where this point array has another value, there are solids. "auto":
            by a point array of a usual name that clearly tells it.
        solid: the name of a point array, or an array: True or not 0 for walls.
        within: six bounds, as of box: particles beyond these are left out.
        only: {"ParticleType": 1} or {"ParticleType": (1, 3)}: particles with other values in these
            point arrays are left out.
        attributes: names of the point arrays to be carried along; by default all, and vx, vy, vz as
            one vector "Velocity".
        outputs, context, device, progress: as in marchingcorrectors.isosurface().
        periodic="auto" takes the period that the field data tell of.

        {options}
'''


class Particles(Keywords, total=False):
    """Has the keywords of all methods."""

    attributes: Optional[Iterable[str]]


def _method(options: Sequence[str]) -> Callable[[Function], Function]:
    """Returns a decorator that adds the keywords of Particles and these options to a method's signature and docstring. The
    functions for NumPy arrays check the keywords."""
    def decorate(function: Function) -> Function:
        function.__doc__ = (function.__doc__ or "").rstrip() + "\n" + ABOUT_PARTICLES
        show(function, own_keywords(Particles, options), options)
        return function

    return decorate


def _triangles_in(sections):
    """Returns the sections, with arrays of triangles, (triangles, 3, 3), in place of surfaces of PyVista."""
    if isinstance(sections, pyvista.PolyData):
        return sections.points[sections.triangulate().faces.reshape(-1, 4)[:, 1:]].astype(np.float64)
    if isinstance(sections, Mapping):
        return {name: _triangles_in(section) for name, section in sections.items()}
    return sections


class PointData(FileParticles):
    """Particles of a data set, like particles of a file: names tell what the arrays are."""

    def __init__(self, data):
        points = data.point_data
        arrays = {name: lambda name=name: np.asarray(points[name]) for name in points.keys() if name not in (GHOSTS, WALL_BLOCK)}
        found = self.found = Found(to_numpy(data.GetPoints().GetData()) if data.n_points else np.empty((0, 3))).find(
            named(data.GetPointData()), ["sizes", "list", "attributes"], find=True)
        if found.found.made[0].name:
            arrays["Velocity"] = lambda: found.made(0)[1]
        self.velocity = found.name("velocity") or "Velocity"
        super().__init__("The data set", "VTK", lambda: np.asarray(data.points), arrays,
                         solid=np.asarray(points[WALL_BLOCK]) if WALL_BLOCK in points else None,
                         **{name: found.name(name) or None for name in QUANTITIES})
        self.period, self.cell = find_period(data)

    def array(self, name):
        if name not in self.arrays:
            raise InvalidArgument(f"There is no point array '{name}'.{did_you_mean(name, self.arrays)} Point arrays: "
                                  f"{', '.join(self.arrays) or 'none'}.")
        return self.arrays[name]


@pyvista.register_dataset_accessor("sph", pyvista.DataSet)
class SphAccessor:
    """Surfaces of the points of a data set, taken as SPH particles."""

    def __init__(self, particles: pyvista.DataSet):
        self._data = particles
        self._taken: Tuple[int, pyvista.DataSet] = (-1, particles)

    @property
    def _particles(self) -> pyvista.DataSet:
        """Returns the particles: the points of the data set, or only its vertices if it is a mesh with vertices. The result is kept
        while the data set stays the same."""
        time = self._data.GetMTime()
        if self._taken[0] != time:
            taken = take_vertices(self._data)
            warn(describe_mesh(self._data, taken))
            self._taken = time, pyvista.wrap(taken)
        return self._taken[1]

    def __repr__(self):
        return f"<SPH particles: {self._particles.n_points}>"

    @_method(ISOSURFACE)
    def isosurface(self, scalar: Union[str, np.ndarray], iso: Union[None, float, Sequence[float]] = None, *,
                   scalar_dot: Union[None, str, np.ndarray] = None,
                   **words: Unpack[Particles]) -> pyvista.PolyData:
        """The surface where a point array (its magnitude, or scalar_component=0, 1, ...) has the value `iso`.

        Example: particles.sph.isosurface("Velocity", 1.0).plot()

        Returns a pyvista.PolyData with all point arrays, and the normals of the field.

        scalar, scalar_dot: names of point arrays, or arrays. If there is no array "Density", densities are summed from masses.
        iso: as in marchingcorrectors.isosurface().
        """
        particles, keywords = self._prepare(words)
        return _functions.isosurface(particles, scalar, iso, scalar_dot=scalar_dot, **keywords).to_pyvista()

    @_method(FREE_SURFACE)
    def free_surface(self, iso: Union[float, Sequence[float]] = 0.5,
                     **words: Unpack[Particles]) -> pyvista.PolyData:
        """The surface of the fluid: where the sum of the particles' weights (no unit) is `iso`.

        Example: particles.sph.free_surface(fluid=("ParticleType", 0)).plot()

        Returns a pyvista.PolyData with all point arrays, and the normals of the field.
        """
        particles, keywords = self._prepare(words)
        return _functions.free_surface(particles, iso, **keywords).to_pyvista()

    @_method(PROBE)
    def probe(self, points: Union[pyvista.DataSet, np.ndarray],
              **words: Unpack[Particles]) -> pyvista.DataSet:
        """The field at the points of another data set.

        Example: particles.sph.probe(pyvista.Line((0, 0, 0), (1, 0, 0)))["Velocity"]

        Returns a copy of the points with the field of the point arrays, NaN where there is no fluid, "WeightSum", and
        "vtkValidPointMask": 1 where there is fluid.

        points: a data set, or an array (points, 3).
        """
        particles, keywords = self._prepare(words)
        keywords["attributes"] = [name for name in keywords["attributes"] if particles.array(name).dtype.kind in "fiub"]
        result = points.copy() if isinstance(points, pyvista.DataSet) else pyvista.PolyData(
            as_points(points, "points", "(points, 3)"))
        found = _functions.probe(particles, result.points, **keywords)
        for name, values in found._point_arrays().items():
            result.point_data[name] = values.reshape(len(values), -1) if values.ndim > 2 else values
        return result

    @_method(DERIVATIVES)
    def derivatives(self, array: str, *, form: str = "corrected", **words: Unpack[Particles]) -> pyvista.DataSet:
        """SPH gradients at the particles.

        Example: particles.sph.derivatives("Velocity")["Vorticity"]

        Returns a copy of the particles with "Gradients" of a point array. If the array has three components, the copy also has
        "Divergence", "Vorticity", "Q-criterion", "Lambda2" (not in two dimensions) and "StrainRate".

        array: the name of the point array.
        form: "corrected" (exact for linear arrays) or "standard".
        """
        particles, keywords = self._prepare(words, with_attributes=False)
        found = _functions.derivatives(particles, {"array": particles.array(array)}, form=form, **keywords)
        gradients = found.gradients.get("array")
        if gradients is None:
            raise InvalidArgument(f"The point array '{array}' is NaN or infinite at a particle.")
        result = self._particles.copy()
        result.point_data["Gradients"] = gradients.reshape(len(gradients), -1)
        if gradients.shape[1:] == (3, 3):
            flow = _functions.flow(gradients)
            if found.statistics["dimension"] == 2:
                del flow["lambda2"]  # This is the middle one of three eigenvalues.
            for name, values in flow.items():
                name = "Q-criterion" if name == "q_criterion" else camel(name)
                result.point_data[name] = values.reshape(len(values), -1) if values.ndim > 1 else values
        return result

    @_method(GAUGE)
    def gauge(self, lines: Any, iso: float = 0.5, **words: Unpack[Particles]) -> _functions.Gauges:
        """Water levels: all places where straight lines cross the free surface.

        Example: particles.sph.gauge({"mast": ((0.5, 0, 0), (0.5, 1, 0))}).last

        Returns Gauges, as marchingcorrectors.gauge() does.

        lines, iso: as in marchingcorrectors.gauge().
        """
        particles, keywords = self._prepare(words, with_attributes=False)
        return _functions.gauge(particles, lines, iso, **keywords)

    @_method(GAUGE)
    def flux(self, sections: Any, velocity: Union[None, str, np.ndarray] = None, iso: float = 0.5,
             **words: Unpack[Particles]) -> _functions.Fluxes:
        """Fluxes through sections.

        Example: particles.sph.flux({"gate": ("disc", (1, 0, 0), (1, 0, 0), 0.2)}).mass_flux

        Returns Fluxes, as marchingcorrectors.flux() does.

        sections, iso: as in marchingcorrectors.flux(); a section may also be a pyvista.PolyData of triangles.
        velocity: the name of a point array, or an array; by default the point array with a usual name.
        """
        particles, keywords = self._prepare(words, with_attributes=False)
        return _functions.flux(particles, particles.velocity if velocity is None else velocity, _triangles_in(sections), iso, **keywords)

    @_method(PROJECT)
    def project(self, scalar: Union[None, str, np.ndarray] = None, *, direction: Union[None, str, Sequence[float]] = None,
                resolution: int = 512, weighted_by: Union[None, str, np.ndarray] = None,
                box: Optional[Sequence[float]] = None, **words: Unpack[Particles]) -> _functions.Projection:
        """Column densities, or integrals of another scalar along lines of sight, as an image.

        Example: image = particles.sph.project(direction="z"); plt.imshow(image.values, extent=image.extent, origin="lower")

        Returns a Projection, as marchingcorrectors.project() does.

        scalar, weighted_by: names of point arrays, or arrays; without a scalar, the density.
        direction, resolution, box: as in marchingcorrectors.project().
        """
        particles, keywords = self._prepare(words, with_attributes=False)
        return _functions.project(particles, scalar, direction=direction, resolution=resolution, weighted_by=weighted_by, box=box, **keywords)

    def _prepare(self, given: Any, with_attributes: bool = True) -> Any:
        """Returns the particles, and keywords, for the functions that take NumPy arrays."""
        particles, words = PointData(self._particles), {"periodic": None, **given}  # Without "auto", a period in the field data is ignored.
        names = words.pop("attributes", None)
        if with_attributes:
            words["attributes"] = list(particles.arrays if names is None else names)
        return particles, words


@pyvista.register_dataset_accessor("sph", pyvista.MultiBlock)
class BlocksAccessor:
    """Works like SphAccessor, on the points of all blocks as one set. A block's name tells whether it holds walls."""

    def __init__(self, blocks: pyvista.MultiBlock):
        self._blocks = blocks

    def __getattr__(self, name):
        taken = take_vertices(self._blocks)
        joined = join_blocks(taken)
        warn(describe_lost(taken, joined))
        return getattr(SphAccessor(pyvista.wrap(joined)), name)

    def __dir__(self):
        return dir(SphAccessor)
