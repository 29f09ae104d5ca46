# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""sky: light from beyond the scene, suns and environments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sunfleck import _core
from sunfleck._arguments import Vector, number, real_array, vector

__all__ = ["Environment", "Sun"]


class Sun:
    """A light at infinity: the same radiance from all directions within an angle of one.

    Parameters
    ----------
    direction : tuple of 3 floats
        From the scene to the sun's middle, of any length but 0.
    angular_radius : float
        Half the angle that it fills, in degrees: 0, or in [0.01, 89]. Our sun's is 0.265. With 0 all its
        light comes from one direction, which only light sampling finds, and no camera sees it.
    irradiance : tuple of 3 floats, optional
        Of a surface that faces it, linear RGB, each in [0, 1e18]: pi sin(angular_radius)^2 times its
        radiance.
    radiance : tuple of 3 floats, optional
        The other way to say it; not with an ``angular_radius`` of 0.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named; both of ``irradiance`` and
        ``radiance``, or neither.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sun = sf.Sun((1, 1, 2), 0.265, irradiance=(3, 2.9, 2.7))
    >>> sun
    Sun((1.0, 1.0, 2.0), angular_radius=0.265, irradiance=(3.0, 2.9, 2.7))
    """

    __slots__ = ("angular_radius", "direction", "irradiance")

    direction: Vector
    angular_radius: float
    irradiance: Vector

    def __init__(
        self,
        direction: Sequence[float],
        angular_radius: float = 0.265,
        irradiance: Sequence[float] | None = None,
        *,
        radiance: Sequence[float] | None = None,
    ) -> None:
        self.direction = vector("direction", direction)
        self.angular_radius = number("angular_radius", angular_radius)
        if (irradiance is None) == (radiance is None):
            raise ValueError("give a sun irradiance or radiance, one of them")
        if irradiance is not None:
            self.irradiance = vector("irradiance", irradiance)
        else:
            if self.angular_radius == 0:
                raise ValueError("a sun of angular_radius 0 has no radiance; give irradiance")
            scale = math.pi * math.sin(math.radians(self.angular_radius)) ** 2
            red, green, blue = vector("radiance", radiance)
            self.irradiance = (scale * red, scale * green, scale * blue)
        _core.check_sun(*self._values())

    def _values(self) -> tuple[Vector, float, Vector]:
        return self.direction, self.angular_radius, self.irradiance

    def __repr__(self) -> str:
        return f"Sun({self.direction}, angular_radius={self.angular_radius}, irradiance={self.irradiance})"


class Environment:
    """Radiance from all around, by direction: a picture in latitude and longitude.

    It is added to the background. As OpenEXR lays such pictures out, row 0 is at the top, where ``up``
    points, and column 0 at longitude +180 degrees, falling to -180 in the last. Longitude 0, the
    picture's middle, is +z; +90 degrees is up x longitude 0, which is +x for the default ``up``. Where
    ``up`` is not at a right angle to +z, longitude 0 is the direction nearest to +z that is; where it is
    +z or -z, longitude 0 is +x. So for z up, +90 degrees is +y.

    Every pixel is a patch of constant radiance, and is sampled in proportion to what comes from it.

    Parameters
    ----------
    image : array_like, shape (height, width, 3)
        Radiance, linear RGB, each in [0, 1e18], one at least above 0. A C-contiguous float32 array is
        used in place and must not change while in use; other real dtypes are copied once.
    up : tuple of 3 floats
        Of any length but 0.
    rotation : float
        Degrees: turns it about ``up``, counter-clockwise seen from above.

    Raises
    ------
    TypeError, ValueError
        A value of the wrong kind or out of its range, which is named.

    Notes
    -----
    A scene keeps 12 bytes a pixel beside the picture, and takes some 25 ns a pixel to prepare.

    Examples
    --------
    >>> import numpy as np
    >>> import sunfleck as sf
    >>> sky = np.zeros((64, 128, 3), dtype=np.float32)
    >>> sky[:32] = (0.4, 0.6, 1.0)
    >>> sf.Environment(sky, up=(0, 0, 1))
    Environment(128 x 64, up=(0.0, 0.0, 1.0), rotation=0.0)
    """

    __slots__ = ("image", "rotation", "up")

    image: NDArray[np.float32]
    up: Vector
    rotation: float

    def __init__(self, image: ArrayLike, up: Sequence[float] = (0.0, 1.0, 0.0), rotation: float = 0.0) -> None:
        with np.errstate(over="ignore"):  # becomes infinite, which C refuses by its place
            array: NDArray[Any] = real_array("image", image, np.dtype(np.float32))
        if array.ndim != 3 or array.shape[2] != 3:
            raise ValueError(f"image has shape {array.shape}; give (height, width, 3)")
        self.image = array
        self.up = vector("up", up)
        self.rotation = number("rotation", rotation)
        _core.check_environment(*self._values())

    def _values(self) -> tuple[NDArray[np.float32], Vector, float]:
        return self.image, self.up, self.rotation

    def __repr__(self) -> str:
        height, width, _ = self.image.shape
        return f"Environment({width} x {height}, up={self.up}, rotation={self.rotation})"
