# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""gallery: the figures of a lecture on random numbers and mappings, made anew, on one page."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sunfleck._arguments import integer
from sunfleck.io.files import FilePath, given_path, replacing
from sunfleck.plot.figure import require_matplotlib
from sunfleck.plot.page import Page
from sunfleck.plot.plates import SECTIONS, Plate, Section, Studio
from sunfleck.provenance import provenance

__all__ = ["gallery", "write_gallery_markdown"]

_TITLE = "Random numbers and mappings"
_ABOUT = (
    "The figures of Steve Rotenberg's lecture of this name (CSE 168, University of California, San Diego, 2017), "
    "in its order, made by Sunfleck."
)

Tell = Callable[[str, int, int], object]


@dataclass(frozen=True)
class _Hung:
    """A section with its pictures."""

    section: Section
    groups: list[list[Plate]]


def _pictures_folder(path: FilePath) -> Path:
    """The folder, made if need be.

    Raises
    ------
    TypeError, ValueError, OSError
        Not a path, or no folder that can be written to.
    """
    given = given_path(path)
    folder = Path(given)
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"can't write pictures into {given!r}: it is not a folder")
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"can't write pictures into {given!r}: permission denied")
    return folder


def _tqdm_tell() -> Iterator[Tell]:
    """One bar, closed at the end."""
    from tqdm import tqdm

    with tqdm(unit="picture", dynamic_ncols=True, leave=False) as bar:

        def tell(name: str, done: int, total: int) -> None:
            bar.total = total
            bar.set_postfix_str(name, refresh=False)
            bar.update(done - bar.n)
            bar.refresh()

        yield tell


def _hang(studio: Studio, folder: Path, tell: Tell) -> list[_Hung]:
    """Makes every picture, and writes each as soon as it is there."""
    total = sum(len(group) for section in SECTIONS for group in section.groups)
    done, hung = 0, []
    for section in SECTIONS:
        groups: list[list[Plate]] = []
        for group in section.groups:
            groups.append([])
            for maker in group:
                tell(section.heading, done, total)
                plate = maker(studio)
                with replacing(folder / f"{plate.name}.png", "pictures", (".png",)) as path:
                    path.write_bytes(plate.png)
                groups[-1].append(plate)
                done += 1
        hung.append(_Hung(section, groups))
    tell("", done, total)
    return hung


def _made(
    output: FilePath, size: int, seed: int, threads: int | None, progress: bool | Tell | None
) -> tuple[Path, list[_Hung], str]:
    """The folder, what hangs in it, and how it was made."""
    size, seed = integer("size", size, bits=32), integer("seed", seed)
    if not 16 <= size <= 4096:
        raise ValueError(f"size is {size}; give 16 to 4096 pixels")
    if threads is not None and not 1 <= integer("threads", threads, bits=32) <= 1024:
        raise ValueError(f"threads is {threads}; give 1 to 1024, or None for one for each processor")
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise TypeError(f"progress is {progress!r}; give True, False or a callable")
    require_matplotlib()
    folder, studio = _pictures_folder(output), Studio(size, seed, threads)
    about = provenance([seed])
    if callable(progress):
        return folder, _hang(studio, folder, progress), about
    if progress:
        for tell in _tqdm_tell():
            return folder, _hang(studio, folder, tell), about
    return folder, _hang(studio, folder, lambda *_: None), about


def gallery(
    output: FilePath,
    *,
    size: int = 208,
    seed: int = 0,
    threads: int | None = None,
    progress: bool | Tell | None = None,
) -> Path:
    """Makes the figures of a lecture on random numbers and mappings anew, and a page that shows them.

    The five patterns as points; π estimated; pixel maps; triangle, disk (right and wrong), sphere, hemisphere and
    cosine hemisphere under each pattern; the soft shadows of an area light at 9 and 100 samples under each; an
    adaptive picture, its sample density, and a close-up.

    Parameters
    ----------
    output : path-like
        A folder, made if need be. It gets index.html, which holds everything and needs no network, and the pictures as
        PNG files. Other files in it stay.
    size : int
        Width and height of the renders, 16 to 4,096 pixels.
    seed : int
        Of all points and renders, in [0, 2^64).
    threads : int, optional
        That render, 1 to 1,024. None: one for each processor. Changes no bit.
    progress : bool or callable, optional
        True: a bar on stderr. A callable gets the heading, how many pictures are done, and how many there will be.

    Returns
    -------
    pathlib.Path
        The page.

    Raises
    ------
    ValueError, TypeError
        An option out of its range or of the wrong kind, before any work.
    OSError
        The folder or a file can't be written.
    sunfleck.Error
        matplotlib is not installed.

    Notes
    -----
    At the default size some 30 seconds of two processors. Ctrl-C leaves the pictures that are done, without a page.

    References
    ----------
    Rotenberg 2017, "Random numbers and mappings" (CSE 168, University of California, San Diego).

    Examples
    --------
    >>> import sunfleck as sf
    >>> page = sf.gallery("out/gallery")  # doctest: +SKIP
    """
    folder, hung, about = _made(output, size, seed, threads, progress)
    page = Page(_TITLE, about)
    page.text(_ABOUT)
    for hanging in hung:
        page.heading(hanging.section.heading)
        page.text(hanging.section.text)
        for group in hanging.groups:
            page.pictures({plate.caption: plate.png for plate in group})
    page.save(folder / "index.html")
    return folder / "index.html"


def _table(plates: Sequence[Plate], folder: str) -> str:
    """Pictures side by side with their captions below."""
    rows = ([f"![{plate.caption}]({folder}/{plate.name}.png)" for plate in plates], [plate.caption for plate in plates])
    first, second = (f"| {' | '.join(row)} |\n" for row in rows)
    return f"{first}|{'---|' * len(plates)}\n{second}\n"


def write_gallery_markdown(
    page: FilePath, output: FilePath, *, size: int = 208, seed: int = 0, progress: bool | Tell | None = None
) -> None:
    """The same page as Markdown, with its pictures in a folder at or below the page's.

    Parameters
    ----------
    page : path-like
        Ending in .md.
    output : path-like
        The folder of the pictures.
    size, seed, progress
        As `gallery` has them.

    Raises
    ------
    ValueError, TypeError, OSError, sunfleck.Error
        As `gallery`.
    """
    folder, hung, about = _made(output, size, seed, None, progress)
    beside = os.path.relpath(folder, Path(given_path(page)).parent)
    text = f"# Gallery\n\n{_ABOUT} `sunfleck gallery -o DIR` makes the page, with pictures that flip and zoom.\n\n"
    for hanging in hung:
        text += f"## {hanging.section.heading}\n\n{hanging.section.text}\n\n"
        text += _table([plate for group in hanging.groups for plate in group], beside)
    with replacing(page, "pages", (".md",)) as path:
        path.write_text(f"{text}{about}.\n", encoding="utf-8")
