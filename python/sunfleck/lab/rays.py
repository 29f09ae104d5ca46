# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""rays: offsets that fit one scale of a scene."""

from __future__ import annotations

import numpy as np

import sunfleck as sf
from sunfleck.lab.experiment import Array, Experiment, Measured, bars, scatter

__all__ = ["EXPERIMENTS"]

EPSILON = np.float32(1e-4)
GAMMA = 7 * 2.0**-24 / (1 - 7 * 2.0**-24)  # of a point from barycentric coordinates (Pharr et al. 2016, section 3.9.4)


def _surface(seed: int, scale: float, n: int = 4096) -> tuple[Array, Array, Array, Array]:
    """Points on random triangles at a scale, in float32; their normals, error bounds and triangles' corners."""
    rng = np.random.Generator(sf.Rng("pcg64dxsm", seed=seed).bit_generator)
    vertices = (scale * (1 + 0.1 * rng.standard_normal((n, 3, 3)))).astype(np.float32)
    weights = rng.dirichlet((1, 1, 1), n).astype(np.float32)
    point = np.einsum("nk,nkd->nd", weights, vertices, dtype=np.float32)
    exact = vertices.astype(float)
    normal = np.cross(exact[:, 1] - exact[:, 0], exact[:, 2] - exact[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    bound = GAMMA * np.einsum("nk,nkd->nd", weights, np.abs(exact))
    return point, normal, bound, exact[:, 0]


def _acne(seed: int) -> Measured:
    point, normal, bound, corner = _surface(seed, 1e4)

    def behind(start: Array) -> float:
        return float(np.mean(np.einsum("nd,nd->n", start.astype(float) - corner, normal) <= 0))

    fixed = point + EPSILON * normal.astype(np.float32)
    distance = np.einsum("nd,nd->n", np.abs(normal), bound)[:, None]
    moved = (point + (distance * normal).astype(np.float32)).astype(np.float32)
    away = np.nextafter(moved, np.where(normal > 0, np.inf, -np.inf).astype(np.float32))
    shares = [behind(fixed), behind(away)]
    show = [bars({"below": share, "above": 1 - share}, "share of starts") for share in shares]
    return Measured(shares[0], shares[1], show[0], show[1])


def _leak(seed: int) -> Measured:
    """Shadow rays from the floor under a plate, straight up, in a scene of height 1 times 10^-4."""
    scale, n = 1e-4, 4096
    u = np.asarray(sf.points("sobol", n, 3, seed=seed, dtype="float64", threads=1))
    height = scale * u[:, 2]  # of the plate, or of what lies on the floor
    position = scale * np.abs(u[:, :2]).sum(axis=1)

    def through(offset: Array) -> float:
        return float(np.mean(offset >= height))

    offsets = [np.full(n, float(EPSILON)), GAMMA * position]
    shares = [through(offset) for offset in offsets]
    show = [
        scatter(np.stack([height, offset], axis=1), "height of the blocker", "start of the ray") for offset in offsets
    ]
    return Measured(shares[0], shares[1], show[0], show[1])


def _scaled(factor: float) -> sf.Scene:
    made = sf.scenes.penumbra()
    meshes = [
        sf.Mesh(np.asarray(m.vertices) * np.float32(factor), m.triangles, albedo=m.albedo, emission=m.emission)
        for m in made.shapes
        if isinstance(m, sf.Mesh)
    ]
    position, target = (np.asarray(p) * factor for p in (made.camera.position, made.camera.target))
    camera = sf.Camera(tuple(position), tuple(target), made.camera.up, made.camera.vertical_fov)
    return sf.Scene(meshes, camera, max_bounces=1)


def _scales(seed: int) -> Measured:
    """A fixed offset's acne (float32 points at each scale), beside renders of the scene at each scale."""
    factors = (1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)
    means = [
        float(np.mean(sf.render(_scaled(f), 32, 32, spp=16, seed=seed, threads=1).color, dtype=float)) for f in factors
    ]
    rendered = np.abs(np.array(means) / means[2] - 1)
    fixed = []
    for factor in factors:
        point, normal, _, corner = _surface(seed, factor, 1024)
        start = (point + EPSILON * normal.astype(np.float32)).astype(float)
        below = np.einsum("nd,nd->n", start - corner, normal) <= 0
        lost = np.abs(normal[:, 2]) * float(EPSILON) > 0.1 * factor  # beyond a tenth of the scene: it leaks
        fixed.append(float(np.mean(below | lost)))
    names = [f"1e{np.log10(f):.0f}" for f in factors]
    show = [
        bars(dict(zip(names, values, strict=True)), y)
        for values, y in (
            (fixed, "share of rays that start on the wrong side"),
            (rendered.tolist(), "relative difference of the mean"),
        )
    ]
    return Measured(max(fixed), float(rendered.max()), show[0], show[1])


EXPERIMENTS = (
    Experiment(
        "offset-acne",
        "a fixed ray offset of 10^-4 leaves far surfaces shadowing themselves",
        "Start the shadow ray a little above the surface.",
        "At 10^4 a float's spacing is 10^-3: the point may lie below by more than the offset.",
        "share of starts that are not above their surface, positions near 10^4",
        "An offset by the bound of the point's error, rounded away.",
        (0.4, 0.6),  # rounding has no side: half; sigma of 4096 is 0.008, and a few lie on the surface itself
        (0, 0),
        _acne,
    ),
    Experiment(
        "offset-leak",
        "a fixed ray offset of 10^-4 jumps over what is nearer",
        "Start the shadow ray a little above the surface.",
        "In a scene of size 10^-4 the offset is the scene.",
        "share of blockers, at heights uniform up to 10^-4, that do not shade the floor below",
        "An offset by the bound of the point's error, in proportion to the position.",
        (1, 1),
        (0, 0.002),  # heights below 2 gamma = 8e-7 of the scene: none of 4096 stratified but one
        _leak,
    ),
    Experiment(
        "scene-scale",
        "a fixed ray offset fits one scale of a scene",
        "A scene may be in any unit.",
        "Scaled by 10^-4 rays jump over things, by 10^6 they start inside.",
        "worst of scales 10^-4 to 10^6: share of wrong starts (after: relative change of a render's mean)",
        "The renderer's offset, which scales with the position.",
        (0.25, 1),
        (0, 0.002),  # float32 rounds edges anew at each scale: a few of 16,384 samples flip
        _scales,
    ),
)
