# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""fog: what scatters light between surfaces."""

from __future__ import annotations

from dataclasses import dataclass

from sunfleck._arguments import number

__all__ = ["Fog"]


@dataclass(frozen=True)
class Fog:
    """Homogeneous fog, which fills all space, solids too, and is the same for all colours.

    A share exp(-(scattering + absorption) x) of light gets through a distance x of it. What is scattered
    goes in other directions by the phase function of Henyey & Greenstein (1941). A vertex in the fog
    counts as a bounce. Nothing comes through from infinitely far: a scene with fog has no background,
    suns or environment.

    Parameters
    ----------
    scattering, absorption : float
        Per unit of length, each in [0, 1e12].
    g : float
        The mean cosine of the angle of scattering, in [-0.99, 0.99]: 0 is isotropic, positive forwards.
        Scene checks the ranges.

    Raises
    ------
    TypeError
        A value of the wrong kind, which is named.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.Fog(scattering=0.1, g=0.5)
    Fog(scattering=0.1, absorption=0.0, g=0.5)
    """

    scattering: float = 0.0
    absorption: float = 0.0
    g: float = 0.0

    def __post_init__(self) -> None:
        for name in ("scattering", "absorption", "g"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
