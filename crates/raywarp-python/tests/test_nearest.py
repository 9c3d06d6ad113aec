"""Closest points, distances with a sign, and what is inside."""

import numpy as np
import pytest
import raywarp


@pytest.fixture
def cube():
    """From 0 to 1, closed, seen from outside counter-clockwise."""
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([[(a, b, c), (a, c, d)] for a, b, c, d in sides]).reshape(-1, 3)
    scene = raywarp.Scene("cpu")
    scene.mesh(vertices, faces)
    return scene


def test_the_closest_point_of_a_cube(cube):
    points = np.float32([[0.5, 0.25, 3], [2, 0.5, 0.25], [2, 2, 2], [0.5, 0.5, 0.9]])
    found = cube.nearest(points)
    np.testing.assert_allclose(found.distance, [2, 1, np.sqrt(3), 0.1], rtol=1e-6)
    np.testing.assert_allclose(found.points, [[0.5, 0.25, 1], [1, 0.5, 0.25], [1, 1, 1], [0.5, 0.5, 1]], atol=1e-6)
    np.testing.assert_array_equal(found.normals[:2], [[0, 0, 1], [1, 0, 0]])
    assert (found.geometry == 0).all() and (found.primitive >= 0).all()


def test_what_is_too_far_is_not_found(cube):
    found = cube.nearest([[0.5, 0.5, 3], [0.5, 0.5, 1.5]], max_distance=1)
    assert found.distance.tolist() == [np.inf, 0.5]
    assert found.primitive[0] == -1 and found.geometry[0] == -1
    assert np.isnan(found.points[0]).all() and not found.normals[0].any()


def test_closest_points_are_those_of_many_samples(soup):
    vertices, faces = soup
    scene = raywarp.Scene("cpu")
    scene.mesh(vertices, faces)
    rng = np.random.default_rng(3)
    points = rng.uniform(-3, 3, (50, 3)).astype(np.float32)
    found = scene.nearest(points)
    # Points all over the triangles, corners included: none is closer, and some are nearly as close.
    weights = np.concatenate([np.eye(3), rng.dirichlet((0.5, 0.5, 0.5), 3000)])
    samples = np.einsum("sw,fwc->fsc", weights, vertices[faces].astype(np.float64)).reshape(-1, 3)
    closest = np.array([np.linalg.norm(samples - point, axis=1).min() for point in points])
    assert (found.distance <= closest + 1e-5).all()
    np.testing.assert_allclose(found.distance, closest, atol=0.05)
    apart = np.linalg.norm(found.points - points, axis=1)
    np.testing.assert_allclose(apart, found.distance, atol=1e-5)


def test_distance_has_a_sign_within(cube):
    points = np.float32([[[0.5, 0.5, 0.5], [0.5, 0.5, 0.9]], [[-0.5, -0.5, -0.5], [1.5, 0.5, 0.5]]])
    for rays in (1, 3, 7):
        distance = cube.signed_distance(points, rays=rays)
        np.testing.assert_allclose(distance, [[-0.5, -0.1], [np.sqrt(0.75), 0.5]], rtol=1e-5)
        assert cube.occupancy(points, rays=rays).tolist() == [[True, True], [False, False]]
    with pytest.raises(ValueError, match="rays is 2, and has to be odd"):
        cube.occupancy(points, rays=2)


def test_shapes_and_types(cube):
    assert cube.nearest([0, 0, 2]).distance.shape == ()
    none = cube.nearest(np.zeros((4, 0, 3)))
    assert none.distance.shape == (4, 0) and none.points.shape == (4, 0, 3)
    assert cube.signed_distance(np.zeros((2, 5, 3), int)).dtype == np.float32
    with pytest.raises(ValueError, match=r"points have the shape \(2,\), and \(..., 3\) is expected"):
        cube.nearest([1, 2])
    assert raywarp.Scene("cpu").nearest([1, 2, 3]).distance == np.inf


def test_closest_points_follow_the_mesh(square):
    scene = raywarp.Scene("cpu")
    mesh = scene.mesh(*square)
    assert scene.nearest([0, 0, 5]).distance == 5
    mesh.vertices = square[0] + np.float32([0, 0, 1])
    assert scene.nearest([0, 0, 5]).distance == 4
    scene.instances(mesh, np.diag([1, 1, 3, 1]))
    assert scene.nearest([0, 0, 5]).distance == 2
