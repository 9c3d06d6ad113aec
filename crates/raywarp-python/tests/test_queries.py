"""The four questions, against brute force and against each other."""

import numpy as np
import pytest
import raywarp
from conftest import brute_force


@pytest.fixture
def scene(soup):
    scene = raywarp.Scene("cpu")
    scene.mesh(*soup)
    return scene


def test_closest_hits_are_those_of_brute_force(scene, soup, rays):
    hits = scene.closest(rays)
    t, u, v = brute_force(*soup, rays)
    first = t.argmin(axis=1)
    row = np.arange(len(rays))
    expected = np.isfinite(t.min(axis=1))
    assert 100 < expected.sum() < len(rays)
    np.testing.assert_array_equal(hits.hit, expected)
    np.testing.assert_array_equal(hits.primitive, np.where(expected, first, -1))
    np.testing.assert_array_equal(hits.geometry, np.where(expected, 0, -1))
    np.testing.assert_allclose(hits.t[expected], t[row, first][expected], rtol=1e-4)
    weights = np.stack([u[row, first], v[row, first]], axis=-1)
    np.testing.assert_allclose(hits.uv[expected], weights[expected], atol=1e-3)
    assert np.isposinf(hits.t[~expected]).all() and not hits.uv[~expected].any()


def test_all_hits_are_those_of_brute_force_in_order(scene, soup, rays):
    found = scene.all(rays)
    t, _, _ = brute_force(*soup, rays)
    for ray, row in enumerate(t):
        part = slice(found.offsets[ray], found.offsets[ray + 1])
        order = np.argsort(row)[: np.isfinite(row).sum()]
        np.testing.assert_array_equal(found.primitive[part], order)
        assert (np.diff(found.t[part]) >= 0).all()
    np.testing.assert_array_equal(found.ray, np.repeat(np.arange(len(rays)), np.isfinite(t).sum(axis=1)))


def test_the_questions_agree(scene, rays):
    hits, found, count = scene.closest(rays), scene.all(rays), scene.count(rays)
    np.testing.assert_array_equal(count, np.diff(found.offsets))
    np.testing.assert_array_equal(scene.any(rays), count > 0)
    first = found.offsets[:-1][count > 0]
    for name in ("t", "uv", "primitive", "geometry"):
        np.testing.assert_array_equal(getattr(found, name)[first], getattr(hits, name)[count > 0])


def test_hits_are_bounded(scene, rays):
    count = scene.count(rays)
    assert count.max() > 2
    np.testing.assert_array_equal(scene.count(rays, max_hits=2), count.clip(max=2))
    two, every = scene.all(rays, max_hits=2), scene.all(rays)
    np.testing.assert_array_equal(np.diff(two.offsets), count.clip(max=2))
    np.testing.assert_array_equal(two.t[two.offsets[:-1][count > 1]], every.t[every.offsets[:-1][count > 1]])


def test_points_and_normals(scene, soup, rays):
    hits = scene.closest(rays)
    vertices, faces = soup
    corners = vertices[faces[hits.primitive]]
    weights = np.concatenate([1 - hits.uv.sum(-1, keepdims=True), hits.uv], axis=-1)
    on_triangle = (weights[..., np.newaxis] * corners).sum(axis=1)
    np.testing.assert_allclose(hits.points[hits.hit], on_triangle[hits.hit], atol=1e-4)
    assert np.isnan(hits.points[~hits.hit]).all()
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(hits.normals[hits.hit], normals[hits.hit], atol=1e-4)
    assert not hits.normals[~hits.hit].any()
    found = scene.all(rays)
    first = found.offsets[:-1][hits.hit]
    np.testing.assert_array_equal(found.points[first], hits.points[hits.hit])
    np.testing.assert_array_equal(found.normals[first], hits.normals[hits.hit])


def test_ends_belong_to_the_ray(square):
    scene = raywarp.Scene("cpu")
    scene.mesh(*square)
    ray = [0.5, 0.25, 2, 0, 0, -1]
    assert scene.closest(ray).t == 2
    assert scene.any(ray, t_max=2) and not scene.any(ray, t_max=1.999)
    assert scene.any(ray, t_min=2) and not scene.any(ray, t_min=2.001)
    assert scene.closest([0.5, 0.25, 0.5, 2, 0, 0, -1, 3]).t == np.inf, "eight numbers: origin, t_min, direction, t_max"
    assert scene.closest([0.5, 0.25, 2, 0.5, 0, 0, -1, 3]).t == 2
    np.testing.assert_array_equal(scene.any([ray, ray, ray], t_max=[1, 2, 3]), [False, True, True])
    with pytest.raises(ValueError, match="have their own t_min and t_max"):
        scene.any([0.5, 0.25, 2, 0, 0, 0, -1, 9], t_max=3)


def test_odd_rays_hit_nothing(square):
    scene = raywarp.Scene("cpu")
    scene.mesh(*square)
    ray = np.array([0.5, 0.25, 2, 0, 0, -1], np.float32)
    odd = np.tile(ray, (6, 1))
    odd[range(5), [0, 3, 0, 5, 5]] = np.nan, np.nan, np.inf, 0, np.inf
    np.testing.assert_array_equal(scene.any(odd), [False] * 5 + [True])
    assert not scene.any(ray, t_min=np.nan) and not scene.any(ray, t_min=3, t_max=1)


def test_an_empty_scene_is_hit_by_nothing(rays):
    scene = raywarp.Scene("cpu")
    assert not scene.closest(rays).hit.any() and not scene.count(rays).any()
    assert scene.all(rays).offsets.tolist() == [0] * 501
    scene.mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert not scene.any(rays).any()
