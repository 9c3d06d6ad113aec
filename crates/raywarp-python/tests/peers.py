"""The classes with the names of Open3D and trimesh beside the originals, and tensors of torch on the CPU. Each needs the library that it
is named after, and is skipped without."""

import numpy as np
import pytest
import raywarp
import raywarp.open3d
import raywarp.trimesh


def rays_at(low, high, count, seed=3):
    """Rays from outside of a box to places within, origin and direction."""
    rng = np.random.default_rng(seed)
    centre, size = (low + high) / 2, np.linalg.norm(high - low)
    start = rng.normal(size=(count, 3))
    start = centre + size * start / np.linalg.norm(start, axis=1, keepdims=True)
    target = rng.uniform(low, high, (count, 3))
    return np.concatenate([start, target - start], axis=1).astype(np.float32)


@pytest.fixture
def open3d():
    return pytest.importorskip("open3d")


@pytest.fixture
def trimesh():
    return pytest.importorskip("trimesh")


def torus(open3d):
    return open3d.t.geometry.TriangleMesh.create_torus(1.0, 0.4, 60, 40)


def both_of(open3d):
    scenes = open3d.t.geometry.RaycastingScene(), raywarp.open3d.RaycastingScene(device="cpu")
    for scene in scenes:
        scene.add_triangles(torus(open3d))
        scene.add_triangles(torus(open3d).translate([0.3, 0.5, 0.7]))
    return scenes


def test_rays_hit_what_open3d_says(open3d):
    theirs, ours = both_of(open3d)
    rays = open3d.core.Tensor(rays_at(np.float64([-1.5] * 3), np.float64([1.5] * 3), 20_000).reshape(100, 200, 6))
    one, other = theirs.cast_rays(rays), ours.cast_rays(rays)
    assert sorted(one) == sorted(other)
    for name, tensor in one.items():
        assert type(other[name]) is type(tensor) and other[name].shape == tensor.shape, name
        assert other[name].dtype == tensor.dtype, name
    hit = np.isfinite(one["t_hit"].numpy())
    np.testing.assert_array_equal(np.isfinite(other["t_hit"].numpy()), hit)
    np.testing.assert_allclose(other["t_hit"].numpy()[hit], one["t_hit"].numpy()[hit], rtol=1e-5)
    same = one["primitive_ids"].numpy() == other["primitive_ids"].numpy()
    assert same.mean() > 0.9999, "but where a ray runs along an edge"
    np.testing.assert_array_equal(one["geometry_ids"].numpy()[same], other["geometry_ids"].numpy()[same])
    np.testing.assert_allclose(
        one["primitive_uvs"].numpy()[same & hit], other["primitive_uvs"].numpy()[same & hit], atol=2e-3
    )
    np.testing.assert_allclose(
        one["primitive_normals"].numpy()[same & hit], other["primitive_normals"].numpy()[same & hit], atol=1e-4
    )
    np.testing.assert_array_equal(theirs.test_occlusions(rays).numpy(), ours.test_occlusions(rays).numpy())
    counts, other_counts = theirs.count_intersections(rays).numpy(), ours.count_intersections(rays).numpy()
    assert (counts == other_counts).mean() > 0.9999
    assert other_counts.dtype == counts.dtype
    every, other_every = theirs.list_intersections(rays), ours.list_intersections(rays)
    assert sorted(every) == sorted(other_every)
    for name, tensor in every.items():
        assert other_every[name].dtype == tensor.dtype, name


def test_points_are_closest_to_what_open3d_says(open3d):
    theirs, ours = both_of(open3d)
    points = open3d.core.Tensor(np.random.default_rng(5).uniform(-2, 2, (5000, 3)).astype(np.float32))
    np.testing.assert_allclose(
        ours.compute_distance(points).numpy(), theirs.compute_distance(points).numpy(), atol=2e-6
    )
    one, other = theirs.compute_closest_points(points), ours.compute_closest_points(points)
    assert sorted(one) == sorted(other)
    np.testing.assert_allclose(other["points"].numpy(), one["points"].numpy(), atol=1e-3)
    # Of a closed mesh: two that overlap have no inside.
    theirs, ours = open3d.t.geometry.RaycastingScene(), raywarp.open3d.RaycastingScene(device="cpu")
    for scene in (theirs, ours):
        scene.add_triangles(torus(open3d))
    for name in ("compute_signed_distance", "compute_occupancy"):
        one, other = (getattr(scene, name)(points, nsamples=3).numpy() for scene in (theirs, ours))
        assert one.dtype == other.dtype
        np.testing.assert_allclose(other, one, atol=2e-6)


def test_pinholes_are_those_of_open3d(open3d):
    create = open3d.t.geometry.RaycastingScene.create_rays_pinhole
    view = (60.0, [0.1, 0.2, 0.3], [3.0, 2.0, 1.0], [0.0, 0.0, 1.0], 64, 48)
    expected = create(fov_deg=view[0], center=view[1], eye=view[2], up=view[3], width_px=64, height_px=48).numpy()
    np.testing.assert_allclose(raywarp.open3d.RaycastingScene.create_rays_pinhole(*view), expected, atol=1e-5)
    intrinsic = np.float64([[50, 0, 31], [0, 55, 25], [0, 0, 1]])
    extrinsic = np.eye(4)
    extrinsic[:3, :3], extrinsic[:3, 3] = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0], (1, 2, 3)
    matrices = open3d.core.Tensor(intrinsic), open3d.core.Tensor(extrinsic)
    expected = create(*matrices, 64, 48).numpy()
    np.testing.assert_allclose(
        raywarp.open3d.RaycastingScene.create_rays_pinhole(*matrices, 64, 48), expected, atol=1e-5
    )


def test_a_mesh_is_hit_where_trimesh_says(trimesh):
    pytest.importorskip("embreex")
    mesh = trimesh.creation.torus(1.0, 0.4)
    theirs = trimesh.ray.ray_pyembree.RayMeshIntersector(mesh)
    ours = raywarp.trimesh.RayMeshIntersector(mesh, device="cpu")
    rays = rays_at(mesh.bounds[0], mesh.bounds[1], 5000).astype(np.float64)
    arguments = rays[:, :3], rays[:, 3:]
    np.testing.assert_array_equal(ours.intersects_any(*arguments), theirs.intersects_any(*arguments))
    first, other = theirs.intersects_first(*arguments), ours.intersects_first(*arguments)
    assert first.shape == other.shape and (first == other).mean() > 0.999
    locations, ray, triangle = theirs.intersects_location(*arguments)
    # Theirs come by how often a ray was shot: sorted by ray, and by distance.
    order = np.lexsort((np.linalg.norm(locations - rays[ray, :3], axis=1), ray))
    other_locations, other_ray, other_triangle = ours.intersects_location(*arguments)
    assert len(order) == len(other_ray)
    np.testing.assert_array_equal(other_ray, ray[order])
    np.testing.assert_allclose(other_locations, locations[order], atol=1e-4)
    assert (other_triangle == triangle[order]).mean() > 0.999
    points = np.random.default_rng(2).uniform(mesh.bounds[0], mesh.bounds[1], (2000, 3))
    np.testing.assert_array_equal(ours.contains_points(points), theirs.contains_points(points))
    assert (ours.contains_points(points) == theirs.contains_points(points)).all()
    mesh.ray = ours
    np.testing.assert_array_equal(mesh.contains(points), theirs.contains_points(points))


def test_tensors_of_torch_stay_tensors():
    torch = pytest.importorskip("torch")
    scene = raywarp.Scene("cpu")
    scene.mesh(torch.eye(3), torch.tensor([[0, 1, 2]]))
    rays = torch.tensor([[0.2, 0.3, 0.1, 1, 1, 1], [9, 9, 9, 1, 0, 0]], dtype=torch.float32)
    hits = scene.closest(rays)
    for name in ("t", "uv", "primitive", "geometry", "hit", "points", "normals"):
        assert isinstance(getattr(hits, name), torch.Tensor), name
    assert hits.hit.tolist() == [True, False]
    assert scene.any(rays).dtype == torch.bool and scene.count(rays).dtype == torch.int32
    found = scene.all(rays)
    assert found.offsets.tolist() == [0, 1, 1] and found.ray.tolist() == [0]
    np.testing.assert_array_equal(hits.t.numpy(), scene.closest(rays.numpy()).t)
    assert isinstance(scene.nearest(rays[:, :3]).distance, torch.Tensor)
    needs_gradient = rays.clone().requires_grad_()
    with pytest.raises((RuntimeError, TypeError, ValueError)):
        scene.closest(needs_gradient)
    assert scene.closest(needs_gradient.detach()).hit.tolist() == [True, False]
