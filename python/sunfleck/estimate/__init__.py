# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""estimate: running means and variances, standard errors, and intervals for the mean."""

from sunfleck.estimate.moments import (
    BatchMeans,
    ChannelMoments,
    ConfidenceSequence,
    Moments,
    RunningSums,
    VectorMoments,
    WeightedMoments,
    betting_interval,
    normal_quantile,
    student_t_quantile,
)

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
