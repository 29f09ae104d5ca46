# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""mapping: the unit square onto pixels, triangles, disks, spheres and hemispheres.

Each mapping has `Mapping.sample`, `Mapping.pdf` and `Mapping.invert`; its parameters follow the
points, by place or by name. Pixel maps have the pixel's centre at (0.5, 0.5); the pole of spheres
and hemispheres is +z.

Examples
--------
>>> import sunfleck as sf
>>> u = sf.points("sobol", 8)
>>> w = sf.mapping.cosine_hemisphere.sample(u)
>>> sf.mapping.cosine_hemisphere.pdf(w).shape
(8,)
>>> sf.mapping.triangle.sample(u, a=(0, 0, 0), b=(1, 0, 0), c=(0, 1, 0)).shape
(8, 3)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import output_array, real_array

__all__ = [
    "MAPPINGS",
    "Mapping",
    "annulus",
    "cone",
    "cosine_hemisphere",
    "cosine_hemisphere_concentric",
    "disk_concentric",
    "disk_naive",
    "disk_polar",
    "ggx_masking",
    "ggx_masking_shadowing",
    "ggx_normals",
    "ggx_visible_normals",
    "hemisphere",
    "henyey_greenstein",
    "parallelogram",
    "pixel_blackman_harris",
    "pixel_box",
    "pixel_gaussian",
    "pixel_gaussian_truncated",
    "pixel_lanczos",
    "pixel_mitchell",
    "pixel_tent",
    "power_cosine",
    "regular_polygon",
    "sphere",
    "spherical_rectangle",
    "spherical_triangle",
    "triangle",
    "triangle_low_distortion",
]

MAPPINGS: dict[str, str] = _core.mappings()
"""The mappings: name → one line about it."""


class Mapping:
    """A mapping of the unit square: points of uniform density become points of the shape's.

    Parameters
    ----------
    name : str
        One of `sunfleck.MAPPINGS`.

    Attributes
    ----------
    name, description : str
    parameters : dict of str to str
        The parameters, in the order in which they follow the points, and what each may be.

    Notes
    -----
    Points are arrays of any leading shape, float32 or float64; other real numbers become
    float64. Results have the points' dtype; float32 results are the C functions' own, bit for
    bit. A parameter is one value for all points or one for each (any shape that broadcasts).
    Every method checks all of its input before it writes anything, and releases the GIL.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.description = MAPPINGS[name]
        self._inputs, self._outputs, self._parameters = _core.mapping_signature(name)
        self.parameters: dict[str, str] = {
            parameter: ("a point (x, y, z), " if components == 3 else "")
            + allowed
            + (f"; default {default:g}" if default is not None else "")
            for parameter, components, default, allowed in self._parameters
        }
        self.__doc__ = f"{name}: {self.description}."

    def sample(
        self, u: ArrayLike, *parameters: ArrayLike, out: NDArray[Any] | None = None, **named: ArrayLike
    ) -> NDArray[Any]:
        """The points of the shape that points of the unit square go to.

        Parameters
        ----------
        u : array_like, shape (..., 2)
            In [0, 1).
        *parameters, **named
            The mapping's own, see ``parameters``.
        out : ndarray, optional
            Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

        Returns
        -------
        ndarray, shape (..., 2) in the plane or (..., 3) in space, dtype of ``u``

        Raises
        ------
        ValueError
            A wrong shape, a value that is not in [0, 1), a parameter out of its range (the
            point and the value are named), or an ``out`` that would need a copy.
        TypeError
            Input that is not of real numbers; a missing or unknown parameter; ``out`` of
            another dtype.
        """
        return self._map("sample", u, self._inputs, (self._outputs,), parameters, named, out)

    def pdf(
        self, x: ArrayLike, *parameters: ArrayLike, out: NDArray[Any] | None = None, **named: ArrayLike
    ) -> NDArray[Any]:
        """The density of `sample` at points of the shape: per area, or per solid angle of directions.

        Parameters
        ----------
        x : array_like, shape (..., 2) or (..., 3)
            Finite; directions have length 1.
        *parameters, **named
            The mapping's own, see ``parameters``.
        out : ndarray, optional
            Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

        Returns
        -------
        ndarray, shape (...), dtype of ``x``
            At least 0; 0 outside the shape (a triangle's points are taken to lie on it).

        Raises
        ------
        ValueError, TypeError
            As `sample`.
        """
        return self._map("pdf", x, self._outputs, (), parameters, named, out)

    def invert(
        self, x: ArrayLike, *parameters: ArrayLike, out: NDArray[Any] | None = None, **named: ArrayLike
    ) -> NDArray[Any]:
        """The points of the unit square that `sample` takes to these points of the shape.

        Parameters
        ----------
        x : array_like, shape (..., 2) or (..., 3)
            Finite, on the shape; directions have length 1.
        *parameters, **named
            The mapping's own, see ``parameters``.
        out : ndarray, optional
            Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

        Returns
        -------
        ndarray, shape (..., 2), in [0, 1), dtype of ``x``

        Raises
        ------
        ValueError, TypeError
            As `sample`.
        """
        return self._map("invert", x, self._outputs, (self._inputs,), parameters, named, out)

    def weight(
        self, x: ArrayLike, *parameters: ArrayLike, out: NDArray[Any] | None = None, **named: ArrayLike
    ) -> NDArray[Any]:
        """What a sample at `x` counts in a mean: 1, but for filters with negative lobes.

        `pixel_mitchell` and `pixel_lanczos` are sampled by the absolute value of the filter f; their
        weight is f's sign times the integral of |f| over that of f. The mean of weight times value
        is the filtered value; divided by the mean of the weights, a constant stays exact.

        Parameters
        ----------
        x : array_like, shape (..., 2) or (..., 3)
            Finite.
        *parameters, **named
            The mapping's own, see ``parameters``.
        out : ndarray, optional
            Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

        Returns
        -------
        ndarray, shape (...), dtype of ``x``

        Raises
        ------
        ValueError, TypeError
            As `sample`.
        """
        return self._map("weight", x, self._outputs, (), parameters, named, out)

    def _map(
        self,
        operation: str,
        points: ArrayLike,
        width: int,
        result: tuple[int, ...],
        placed: tuple[ArrayLike, ...],
        named: dict[str, ArrayLike],
        out: NDArray[Any] | None,
    ) -> NDArray[Any]:
        array = real_array("the points", points, None)
        if array.ndim < 1 or array.shape[-1] != width:
            raise ValueError(f"the points have shape {array.shape}; {self.name}.{operation} takes (..., {width})")
        leading = array.shape[:-1]
        values = self._bind(operation, placed, named)
        parameters = [
            None if value is None else _parameter(name, components, value, leading, array.dtype)
            for (name, components, _, _), value in zip(self._parameters, values, strict=True)
        ]
        target = output_array(out, leading + result, array.dtype)
        if any(np.may_share_memory(target, given) for given in (array, *parameters) if given is not None):
            raise ValueError("out overlaps the points or a parameter; give an array of its own")
        _core.mapping_fill(operation, self.name, array, parameters, target)
        return target

    def _bind(
        self, operation: str, placed: tuple[ArrayLike, ...], named: dict[str, ArrayLike]
    ) -> list[ArrayLike | None]:
        """The parameters in order, by place and then by name; None where the default stands."""
        names = [name for name, _, _, _ in self._parameters]
        call = f"{self.name}.{operation}"
        if len(placed) > len(names):
            raise TypeError(f"{call} takes {len(names)} parameters after the points ({', '.join(names)})")
        given = dict(zip(names, placed, strict=False))
        for name, value in named.items():
            if name not in names:
                raise TypeError(f"{call} has no parameter {name!r}; it has {', '.join(names) or 'none'}")
            if name in given:
                raise TypeError(f"{call} was given {name!r} twice")
            given[name] = value
        for name, _, default, allowed in self._parameters:
            if default is None and name not in given:
                raise TypeError(f"{call} needs its parameter {name!r}: {allowed}")
        return [given.get(name) for name in names]

    def __repr__(self) -> str:
        return f"<mapping {self.name}: {self.description}>"


def _parameter(
    name: str, components: int, value: ArrayLike, leading: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    """One value for all points, or one for each, packed."""
    array = real_array(name, value, dtype)
    one = () if components == 1 else (components,)
    if array.shape == one:
        return array
    try:
        return np.ascontiguousarray(np.broadcast_to(array, leading + one))
    except ValueError:
        raise ValueError(
            f"{name} has shape {array.shape}; give {one}, or one for each point, {leading + one}"
        ) from None


def ggx_normals(
    h: ArrayLike, alpha_x: ArrayLike, alpha_y: ArrayLike, *, out: NDArray[Any] | None = None
) -> NDArray[Any]:
    """The density of the normals of a GGX surface: its D term, per solid angle and unit of surface.

    Parameters
    ----------
    h : array_like, shape (..., 3)
        Normals of length 1.
    alpha_x, alpha_y : array_like
        Roughness, in [1e-4, 10]: one for all, or one for each normal.
    out : ndarray, optional
        Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

    Returns
    -------
    ndarray, shape (...), dtype of ``h``
        Its integral times h_z over the hemisphere is 1; 0 below the horizon.

    Raises
    ------
    ValueError, TypeError
        As `Mapping.sample`; a direction that has not length 1.

    References
    ----------
    Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

    Examples
    --------
    >>> import sunfleck as sf
    >>> print(f"{sf.mapping.ggx_normals((0.0, 0.0, 1.0), 0.5, 0.5):.4f}")  # 1 / (pi alpha^2)
    1.2732
    """
    return _ggx(0, "h", h, None, alpha_x, alpha_y, out)


def ggx_masking(
    w: ArrayLike, alpha_x: ArrayLike, alpha_y: ArrayLike, *, out: NDArray[Any] | None = None
) -> NDArray[Any]:
    """Smith's masking G1 of a GGX surface: the share of what faces w that is seen from w.

    The density of `ggx_visible_normals` at h is ``ggx_masking(w) max(0, w.h) ggx_normals(h) / w_z``.

    Parameters
    ----------
    w : array_like, shape (..., 3)
        Directions of length 1 away from the surface.
    alpha_x, alpha_y : array_like
        Roughness, in [1e-4, 10]: one for all, or one for each direction.
    out : ndarray, optional
        Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

    Returns
    -------
    ndarray, shape (...), in [0, 1], dtype of ``w``
        0 at the horizon and below.

    Raises
    ------
    ValueError, TypeError
        As `Mapping.sample`; a direction that has not length 1.

    References
    ----------
    Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", eq. 72.

    Examples
    --------
    >>> import sunfleck as sf
    >>> print(f"{sf.mapping.ggx_masking((0.6, 0.0, 0.8), 1.0, 1.0):.4f}")  # 2 z / (z + 1)
    0.8889
    """
    return _ggx(1, "w", w, None, alpha_x, alpha_y, out)


def ggx_masking_shadowing(
    w: ArrayLike, v: ArrayLike, alpha_x: ArrayLike, alpha_y: ArrayLike, *, out: NDArray[Any] | None = None
) -> NDArray[Any]:
    """Smith's masking and shadowing G2 of a GGX surface, height-correlated: seen from w and from v.

    Parameters
    ----------
    w : array_like, shape (..., 3)
        Directions of length 1 away from the surface.
    v : array_like, shape (3,) or (..., 3)
        The other direction: one for all, or one for each of ``w``.
    alpha_x, alpha_y : array_like
        Roughness, in [1e-4, 10]: one for all, or one for each direction.
    out : ndarray, optional
        Filled in place: of the result's shape and dtype, C-contiguous, apart from the input.

    Returns
    -------
    ndarray, shape (...), in [0, 1], dtype of ``w``
        At most `ggx_masking` of either; 0 where either is at the horizon or below.

    Raises
    ------
    ValueError, TypeError
        As `Mapping.sample`; a direction that has not length 1.

    References
    ----------
    Heitz 2014, eq. 99.

    Examples
    --------
    >>> import sunfleck as sf
    >>> w = (0.6, 0.0, 0.8)
    >>> print(f"{sf.mapping.ggx_masking_shadowing(w, w, 1.0, 1.0):.4f}")  # z
    0.8000
    """
    return _ggx(2, "w", w, v, alpha_x, alpha_y, out)


def _ggx(
    term: int,
    name: str,
    directions: ArrayLike,
    v: ArrayLike | None,
    alpha_x: ArrayLike,
    alpha_y: ArrayLike,
    out: NDArray[Any] | None,
) -> NDArray[Any]:
    array = real_array(name, directions, None)
    if array.ndim < 1 or array.shape[-1] != 3:
        raise ValueError(f"{name} has shape {array.shape}; give (..., 3)")
    leading = array.shape[:-1]
    other = None if v is None else _parameter("v", 3, v, leading, array.dtype)
    across = _parameter("alpha_x", 1, alpha_x, leading, array.dtype)
    along = _parameter("alpha_y", 1, alpha_y, leading, array.dtype)
    target = output_array(out, leading, array.dtype)
    if any(np.may_share_memory(target, given) for given in (array, other, across, along) if given is not None):
        raise ValueError("out overlaps an input; give an array of its own")
    _core.ggx_fill(term, array, other, across, along, target)
    return target


pixel_box = Mapping("pixel_box")
pixel_tent = Mapping("pixel_tent")
pixel_gaussian = Mapping("pixel_gaussian")
pixel_gaussian_truncated = Mapping("pixel_gaussian_truncated")
pixel_blackman_harris = Mapping("pixel_blackman_harris")
pixel_mitchell = Mapping("pixel_mitchell")
pixel_lanczos = Mapping("pixel_lanczos")
triangle = Mapping("triangle")
triangle_low_distortion = Mapping("triangle_low_distortion")
parallelogram = Mapping("parallelogram")
disk_polar = Mapping("disk_polar")
disk_concentric = Mapping("disk_concentric")
disk_naive = Mapping("disk_naive")
annulus = Mapping("annulus")
regular_polygon = Mapping("regular_polygon")
sphere = Mapping("sphere")
hemisphere = Mapping("hemisphere")
cosine_hemisphere = Mapping("cosine_hemisphere")
cosine_hemisphere_concentric = Mapping("cosine_hemisphere_concentric")
cone = Mapping("cone")
power_cosine = Mapping("power_cosine")
henyey_greenstein = Mapping("henyey_greenstein")
ggx_visible_normals = Mapping("ggx_visible_normals")
spherical_triangle = Mapping("spherical_triangle")
spherical_rectangle = Mapping("spherical_rectangle")
