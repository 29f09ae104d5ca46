# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""lab: where methods fail, each as an experiment with its remedy.

Examples
--------
>>> import sunfleck as sf
>>> experiment = sf.lab.EXPERIMENTS["float-one"]
>>> measured = experiment.run(seed=1)
>>> measured.before, measured.after
(128.0, 0.0)
"""

from __future__ import annotations

from sunfleck.lab import estimates, generators, mappings, patterns, streams
from sunfleck.lab.experiment import Experiment, Measured

__all__ = ["EXPERIMENTS", "Experiment", "Measured"]

EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment
    for theme in (generators, streams, patterns, mappings, estimates)
    for experiment in theme.EXPERIMENTS
}
