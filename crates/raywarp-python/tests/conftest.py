"""Scenes and rays that the tests share, and brute force over them in NumPy."""

from __future__ import annotations

import numpy as np
import pytest


def brute_force(vertices, faces, rays):
    """t, u, v of every ray and triangle by the equations of Moller and Trumbore, in double precision; t is inf for a miss."""
    corners = np.asarray(vertices, np.float64)[np.asarray(faces, np.int64)]
    rays = np.asarray(rays, np.float64).reshape(-1, 1, rays.shape[-1])
    start, direction = rays[..., :3], rays[..., -3:]
    a, b, c = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(direction, c)
    determinant = (p * b).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (p * (start - a)).sum(-1) / determinant
        q = np.cross(start - a, b)
        v = (q * direction).sum(-1) / determinant
        t = (q * c).sum(-1) / determinant
    hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (determinant != 0)
    return np.where(hit, t, np.inf), u, v


@pytest.fixture
def soup():
    """200 triangles within a cube, as vertices and faces."""
    rng = np.random.default_rng(7)
    centres = rng.uniform(-2, 2, (200, 1, 3))
    vertices = (centres + rng.uniform(-0.5, 0.5, (200, 3, 3))).reshape(-1, 3).astype(np.float32)
    return vertices, np.arange(600).reshape(200, 3)


@pytest.fixture
def rays():
    """500 rays into that cube, origin and direction."""
    rng = np.random.default_rng(8)
    start = rng.normal(size=(500, 3))
    start *= 6 / np.linalg.norm(start, axis=1, keepdims=True)
    target = rng.uniform(-2, 2, (500, 3))
    return np.concatenate([start, target - start], axis=1).astype(np.float32)


@pytest.fixture
def square():
    """Two triangles at z = 0, from -1 to 1 along x and y, seen from +z."""
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    return vertices, np.array([[0, 1, 2], [0, 2, 3]])
