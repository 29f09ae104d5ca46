# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lab: where methods fail, each as an experiment with its remedy.

Examples
--------
>>> import sunfleck as sf
>>> result = sf.lab.run("float-one", seed=1)
>>> result.before, result.after, result.holds
(128.0, 0.0, True)
"""

from __future__ import annotations

from sunfleck._arguments import choice
from sunfleck.lab import estimates, generators, mappings, patterns, rays, renders, streams
from sunfleck.lab.experiment import Experiment, Measured
from sunfleck.lab.report import Result, table, write_all

__all__ = ["EXPERIMENTS", "Experiment", "Measured", "Result", "run", "table", "write_all"]

EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment
    for theme in (generators, streams, patterns, mappings, estimates, renders, rays)
    for experiment in theme.EXPERIMENTS
}
"""By name, in the order of their themes."""


def run(name: str, seed: int = 1) -> Result:
    """Runs an experiment: less than a second each.

    Parameters
    ----------
    name : str
        One of `EXPERIMENTS`.
    seed : int
        1 to 2^30; the result is a pure function of it.

    Returns
    -------
    Result
        Prints as a report; `before`, `after`, `holds`, `figure()`, `save(path)`.

    Raises
    ------
    ValueError
        There is no such experiment, or the seed is out of range.

    Examples
    --------
    >>> import sunfleck as sf
    >>> sf.lab.run("sphere-poles").before > 2 * sf.lab.run("sphere-poles").after
    True
    """
    name = choice("experiment", name, EXPERIMENTS)
    if not 1 <= seed <= 2**30:
        raise ValueError(f"seed is {seed}; it must be 1 to {2**30}")
    experiment = EXPERIMENTS[name]
    return Result(experiment, experiment.measure(seed), seed)
