"""Meshes, instances, files and devices."""

import gc
import sys
import weakref

import numpy as np
import pytest
import raywarp

DOWN = [0.5, 0.25, 9, 0, 0, -1]


def lifted(height):
    """A transform that moves along z."""
    transform = np.eye(4)
    transform[2, 3] = height
    return transform


def test_geometry_is_numbered_in_order(square):
    scene = raywarp.Scene("cpu")
    first = scene.mesh(*square)
    copied = scene.mesh(*square)
    last = scene.mesh(square[0] + [0, 0, 3], square[1])
    assert (first.geometry, copied.geometry, last.geometry) == (0, 1, 2)
    copies = scene.instances(copied, [lifted(1), lifted(5)])
    assert (first.geometry, copied.geometry, last.geometry) == (0, None, 1)
    assert copies.geometry == range(2, 4) and len(copies) == 2
    found = scene.all(DOWN)
    assert found.geometry.tolist() == [3, 1, 2, 0]
    assert found.t.tolist() == [4, 6, 8, 9]
    assert set(found.primitive.tolist()) == {0}


def test_of_two_at_one_distance_the_first_is_hit(square):
    scene = raywarp.Scene("cpu")
    scene.mesh(*square)
    scene.mesh(*square)
    assert scene.closest(DOWN).geometry == 0
    assert scene.all(DOWN).geometry.tolist() == [0, 1]


def test_vertices_and_transforms_are_replaced(square):
    scene = raywarp.Scene("cpu")
    mesh = scene.mesh(*square)
    assert scene.closest(DOWN).t == 9
    mesh.vertices = square[0] + np.float32([0, 0, 2])
    assert scene.closest(DOWN).t == 7
    np.testing.assert_array_equal(mesh.vertices[:, 2], [2, 2, 2, 2])
    copies = scene.instances(mesh, lifted(1))
    assert scene.closest(DOWN).t == 6
    copies.transforms = lifted(-1)
    assert scene.closest(DOWN).t == 8
    np.testing.assert_array_equal(copies.transforms, [lifted(-1)[:3]])
    with pytest.raises(ValueError, match="3 vertices cannot take the place of the mesh's 4"):
        mesh.vertices = np.zeros((3, 3))
    with pytest.raises(ValueError, match="2 transforms cannot take the place of 1"):
        copies.transforms = [lifted(0), lifted(1)]


def test_a_mirrored_instance_keeps_its_numbers(square):
    scene = raywarp.Scene("cpu")
    scene.instances(scene.mesh(*square), np.diag([-1, 1, 1, 1]))
    hits = scene.closest([-0.5, 0.25, 9, 0, 0, -1])
    assert (hits.t, hits.primitive, hits.geometry) == (9, 0, 0)
    np.testing.assert_allclose(hits.uv, raywarp_uv(square, [0.5, 0.25, 9, 0, 0, -1]))
    np.testing.assert_array_equal(hits.normals, [0, 0, -1])


def raywarp_uv(square, ray):
    scene = raywarp.Scene("cpu")
    scene.mesh(*square)
    return scene.closest(ray).uv


def test_triangles_without_area_keep_their_numbers(square):
    scene = raywarp.Scene("cpu")
    vertices, faces = square
    odd = np.concatenate([vertices, [[np.nan, 0, 0]]])
    scene.mesh(odd, [[0, 0, 1], [0, 1, 4], *faces])
    assert scene.closest(DOWN).primitive == 2


def test_scenes_are_read_from_files(tmp_path, square):
    path = tmp_path / "square.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in square[0].tolist()] + ["o plate", "f 1 2 3", "f 1 3 4"]
    path.write_text("\n".join(["usemtl lost", *lines]))
    with pytest.warns(UserWarning, match=r"square\.obj:1: 'usemtl' names materials, but no 'mtllib'"):
        raywarp.Scene.open(path, "cpu")
    path.write_text("\n".join(lines))
    scene = raywarp.Scene.open(path, "cpu")
    hits = scene.closest(DOWN)
    assert (hits.t, hits.geometry) == (9, 0)
    assert len(scene.names) == 1
    # What is added comes after what the file holds.
    added = scene.mesh(square[0] + [0, 0, 1], square[1])
    assert added.geometry == 1 and scene.closest(DOWN).geometry == 1
    assert scene.names[1] == ""


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"cannot read .*none\.obj"):
        raywarp.Scene.open(tmp_path / "none.obj", "cpu")
    (tmp_path / "scene.toml").write_text('version = 1\n[[meshes]]\nfile = "none.ply"\n')
    with pytest.raises(FileNotFoundError, match=r"scene\.toml:3:\d+ names none\.ply: cannot read"):
        raywarp.Scene.open(tmp_path / "scene.toml", "cpu")
    (tmp_path / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match=r"bad\.obj:2"):
        raywarp.Scene.open(str(tmp_path / "bad.obj"), "cpu")
    with pytest.raises(ValueError, match="is not supported"):
        raywarp.Scene.open(tmp_path / "scene.txt", "cpu")


def test_devices():
    assert raywarp.Scene("cpu").device == "cpu"
    assert raywarp.Scene().device.split(":")[0] in ("cpu", "cuda")
    with pytest.raises(ValueError, match="'gpu' is no device; expected auto, cpu, cuda or cuda:N"):
        raywarp.Scene("gpu")
    with pytest.raises(raywarp.DeviceError, match="CUDA"):
        raywarp.Scene("cuda:99")
    assert issubclass(raywarp.DeviceError, RuntimeError)
    with pytest.raises(ValueError, match="'best' is no quality"):
        raywarp.Scene("cpu", build="best")


@pytest.mark.parametrize("build", ["fast", "medium", "high"])
def test_quality_changes_no_answer(soup, rays, build):
    scene, medium = raywarp.Scene("cpu", build=build), raywarp.Scene("cpu")
    scene.mesh(*soup)
    medium.mesh(*soup)
    one, other = scene.closest(rays), medium.closest(rays)
    assert one.t.tobytes() == other.t.tobytes() and one.uv.tobytes() == other.uv.tobytes()


def test_a_mesh_of_another_scene_is_refused(square):
    mesh = raywarp.Scene("cpu").mesh(*square)
    with pytest.raises(ValueError, match="the mesh belongs to another scene"):
        raywarp.Scene("cpu").instances(mesh, lifted(0))


def test_nothing_outlives_its_last_reference(square, rays):
    gc.disable()
    try:
        scene = raywarp.Scene("cpu")
        mesh = scene.mesh(*square)
        instances = scene.instances(mesh, lifted(0))
        hits = scene.closest(rays)
        watched = [weakref.ref(scene), weakref.ref(mesh), weakref.ref(instances)]
        before = sys.getrefcount(rays)
        del scene, mesh, instances, hits
        assert [what() for what in watched] == [None] * 3, "no cycle keeps a scene"
        assert sys.getrefcount(rays) < before, "hits hold the rays that they are of"
    finally:
        gc.enable()
