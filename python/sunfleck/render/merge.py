# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""merge: one image of several, from their statistics."""

from __future__ import annotations

import os
from collections.abc import Sequence

from sunfleck import _core
from sunfleck.io.files import FilePath, given_path
from sunfleck.render.image import Image

__all__ = ["merge"]


def merge(images: Sequence[Image | FilePath]) -> Image:
    """One image of several of the same scene, from their statistics rather than their colours.

    Replicates (the same pixels, each with a seed of its own) merge by their counts of samples;
    tiles (crops that together fill a rectangle) are put side by side; both at once too.

    Parameters
    ----------
    images : sequence of Image or path-like
        Images, or checkpoint files. One alone is that image, or what the file holds so far.

    Returns
    -------
    Image
        A pixel of n_i samples with half-widths h_i has half-width sqrt(sum (n_i h_i)^2) / sum n_i. The exposure
        is that of the first image that is no file.

    Raises
    ------
    ValueError
        Images that share a seed and a pixel; other scenes, frame sizes, patterns, filters, stop
        rules or confidences; crops that leave a gap.
    TypeError
        Neither an image nor a path.
    OSError
        A file that can't be read, is damaged, or is no checkpoint.

    Notes
    -----
    The order of the images decides the last bits. The cost is that of reading them once.

    Examples
    --------
    >>> import sunfleck as sf
    >>> parts = [sf.render(sf.scenes.penumbra(), 32, 24, spp=16, seed=seed) for seed in (1, 2)]
    >>> merged = sf.merge(parts)
    >>> int(merged.samples.min()), merged.metadata["merged_seeds"]
    (32, '1 2')
    """
    if isinstance(images, (str, bytes, os.PathLike)) or not isinstance(images, Sequence):
        raise TypeError(f"images is {images!r}; give a list of images or checkpoint files")
    exposures = [image.exposure for image in images if isinstance(image, Image)]
    exposure = exposures[0] if exposures else 0.0
    films = [image._film if isinstance(image, Image) else _core.load_film(given_path(image)) for image in images]
    if len(films) == 1:  # as it is, a mask and AOVs too
        return Image(films[0], exposure)
    return Image(_core.merge_films(films), exposure)
