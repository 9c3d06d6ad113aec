"""The classes with the names of Open3D and trimesh, without these."""

import copy
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import raywarp.open3d
import raywarp.trimesh


def cube():
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([[(a, b, c), (a, c, d)] for a, b, c, d in sides]).reshape(-1, 3)


def test_rays_are_cast_as_by_open3d():
    vertices, faces = cube()
    scene = raywarp.open3d.RaycastingScene(device="cpu")
    assert scene.add_triangles(vertices + [0, 0, 5], faces) == 0
    assert scene.add_triangles(SimpleNamespace(vertices=vertices, triangles=faces)) == 1
    rays = np.float32([[0.5, 0.25, 9, 0, 0, -1], [0.5, 0.25, 3, 0, 0, -1], [9, 9, 9, 1, 0, 0]])
    hits = scene.cast_rays(rays)
    assert hits["t_hit"].numpy().tolist() == [3, 2, np.inf]
    assert hits["geometry_ids"].tolist() == [0, 1, scene.INVALID_ID]
    assert hits["primitive_ids"].dtype == np.uint32 and hits["primitive_ids"][2] == scene.INVALID_ID
    assert hits["primitive_normals"].tolist() == [[0, 0, 1], [0, 0, 1], [0, 0, 0]]
    assert hits["primitive_uvs"].shape == (3, 2)
    assert scene.test_occlusions(rays).tolist() == [True, True, False]
    assert scene.test_occlusions(rays, tfar=2.5).tolist() == [False, True, False]
    assert scene.test_occlusions(rays, tnear=3.5, tfar=4.5, nthreads=1).tolist() == [True, False, False]
    assert scene.count_intersections(rays).tolist() == [4, 2, 0]
    every = scene.list_intersections(rays)
    assert every["ray_splits"].tolist() == [0, 4, 6, 6] and every["ray_ids"].tolist() == [0, 0, 0, 0, 1, 1]
    assert every["t_hit"].tolist() == [3, 4, 8, 9, 2, 3]
    with pytest.raises(ValueError, match=r"\(..., 6\) is expected"):
        scene.cast_rays(rays[:, :5])


def test_distances_are_computed_as_by_open3d():
    scene = raywarp.open3d.RaycastingScene(device="cpu")
    scene.add_triangles(*cube())
    points = np.float32([[0.5, 0.5, 0.75], [0.5, 0.5, 3]])
    assert scene.compute_distance(points).tolist() == [0.25, 2]
    assert scene.compute_signed_distance(points, nsamples=3).tolist() == [-0.25, 2]
    assert scene.compute_occupancy(points).tolist() == [1, 0]
    found = scene.compute_closest_points(points)
    assert found["points"].tolist() == [[0.5, 0.5, 1], [0.5, 0.5, 1]]
    assert sorted(found) == ["geometry_ids", "points", "primitive_ids", "primitive_normals", "primitive_uvs"]


def test_a_pinhole_sees_what_it_looks_at():
    rays = raywarp.open3d.RaycastingScene.create_rays_pinhole(90, [0, 0, 0], [0, 0, 5], [0, 1, 0], 4, 2)
    assert rays.shape == (2, 4, 6) and (rays[..., :3] == (0, 0, 5)).all()
    np.testing.assert_allclose(rays[0, 0, 3:], [0.75, -0.25, -1], atol=1e-6)
    np.testing.assert_allclose(rays[1, 3, 3:], [-0.75, 0.25, -1], atol=1e-6)
    world_to_camera = np.eye(4)
    world_to_camera[:3, 3] = 0, 0, -5
    intrinsic = [[2, 0, 2], [0, 2, 1], [0, 0, 1]]
    rays = raywarp.open3d.RaycastingScene.create_rays_pinhole(intrinsic, world_to_camera, 4, 2)
    np.testing.assert_allclose(rays[0, 3], [0, 0, 5, 0.75, -0.25, 1], atol=1e-6)


def test_a_mesh_is_asked_as_by_trimesh():
    vertices, faces = cube()
    ray = raywarp.trimesh.RayMeshIntersector(SimpleNamespace(vertices=vertices, faces=faces), device="cpu")
    origins, directions = [[0.5, 0.25, 9], [0.5, 0.25, 0.5], [9, 9, 9]], [[0, 0, -2], [0, 0, 1], [1, 0, 0]]
    locations, index_ray, index_tri = ray.intersects_location(origins, directions)
    assert locations.tolist() == [[0.5, 0.25, 1], [0.5, 0.25, 0], [0.5, 0.25, 1]]
    assert index_ray.tolist() == [0, 0, 1] and index_tri.dtype == np.int64
    first = ray.intersects_first(origins, directions)
    assert first.tolist() == [index_tri[0], index_tri[2], -1]
    triangles, rays = ray.intersects_id(origins, directions, multiple_hits=False)
    assert triangles.tolist() == first[:2].tolist() and rays.tolist() == [0, 1]
    assert len(ray.intersects_id(origins, directions, max_hits=1)[0]) == 2
    assert ray.intersects_any(origins, directions).tolist() == [True, True, False]
    assert ray.contains_points([[0.5, 0.5, 0.5], [0.5, 0.5, 1.5]]).tolist() == [True, False]
    with pytest.raises(ValueError, match="is expected of both"):
        ray.intersects_any(origins, directions[:2])
    for other in (copy.copy(ray), copy.deepcopy(ray), pickle.loads(pickle.dumps(ray))):
        assert other.intersects_first(origins, directions).tolist() == first.tolist()


def test_hits_that_are_close_are_all_found():
    """Where a ray that is shot again from an offset would step over the second sheet."""
    sheet = np.float64([[-1, -1, 0], [1, -1, 0], [0, 1, 0]])
    vertices = np.concatenate([sheet, sheet + [0, 0, 1e-6], sheet + [0, 0, 1e-6]])
    mesh = SimpleNamespace(vertices=vertices, faces=np.arange(9).reshape(3, 3))
    ray = raywarp.trimesh.RayMeshIntersector(mesh, device="cpu")
    triangles, _ = ray.intersects_id([[0, 0, 1e-3]], [[0, 0, -1]])
    assert triangles.tolist() == [1, 2, 0]
