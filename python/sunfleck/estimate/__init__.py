# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: running means and variances, standard errors, and intervals for the mean."""

# `accumulator` comes first; `moments` and `running_sums` import it, and `intervals` imports `moments`. The folder
# stands above `sunfleck._arguments`, and below `sunfleck.chart`.

from sunfleck.estimate.intervals import (
    BatchMeans,
    ConfidenceSequence,
    betting_interval,
    normal_quantile,
    student_t_quantile,
)
from sunfleck.estimate.moments import ChannelMoments, Moments, VectorMoments, WeightedMoments
from sunfleck.estimate.running_sums import RunningSums

__all__ = [
    "BatchMeans",
    "ChannelMoments",
    "ConfidenceSequence",
    "Moments",
    "RunningSums",
    "VectorMoments",
    "WeightedMoments",
    "betting_interval",
    "normal_quantile",
    "student_t_quantile",
]
