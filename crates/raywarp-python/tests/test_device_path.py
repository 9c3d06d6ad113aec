"""The way of arrays on a device, on the CPU: all but the order of streams is as on a GPU, where cuda_arrays.py tests it too."""

import numpy as np
import pytest
import raywarp
from raywarp import _libraries


class Tensor(np.ndarray):
    """An array of a library that is told apart from NumPy's, and speaks DLPack."""


@pytest.fixture
def scene(soup, monkeypatch):
    """One that takes such arrays for those of its device."""
    monkeypatch.setattr(_libraries, "is_on_cuda", lambda value: isinstance(value, Tensor))
    other = _libraries._Other(lambda array: np.from_dlpack(array).view(Tensor))
    other.stream = lambda like: 0
    monkeypatch.setitem(_libraries._known, Tensor, other)
    scene = raywarp.Scene("cpu")
    scene._on_cuda = True
    scene.mesh(*soup)
    return scene


def same(one, other):
    for name in ("t", "uv", "primitive", "geometry"):
        array = getattr(one, name)
        assert isinstance(array, Tensor), name
        assert array.dtype == getattr(other, name).dtype
        np.testing.assert_array_equal(array, getattr(other, name), err_msg=name)


def test_rays_in_all_forms_have_the_same_answers(scene, rays):
    expected = scene.closest(rays)
    given = rays.view(Tensor)
    eight = np.zeros((500, 8), np.float32)
    eight[:, :3], eight[:, 4:7], eight[:, 7] = rays[:, :3], rays[:, 3:], np.inf
    room = np.zeros(4000 + 16, np.float32)
    room = room[-(room.ctypes.data // 4) % 4 :][:4000].reshape(500, 8)
    room[:] = eight
    wide = np.zeros((500, 11), np.float32)
    wide[:, 2:8] = rays
    for coherent in (False, True):
        same(scene.closest(given, coherent=coherent), expected)
    same(scene.closest(room.view(Tensor)), expected)
    same(scene.closest(given[:, :3], given[:, 3:]), expected)
    same(scene.closest(wide.view(Tensor)[:, 2:8]), expected)
    same(scene.closest(given.reshape(20, 25, 6)), scene.closest(rays.reshape(20, 25, 6)))
    same(scene.closest(given[0, :3], given[:, 3:]), scene.closest(rays[0, :3], rays[:, 3:]))
    same(scene.closest(given[:, :3], given[0, 3:]), scene.closest(rays[:, :3], rays[0, 3:]))
    same(scene.closest(given, t_min=4, t_max=6), scene.closest(rays, t_min=4, t_max=6))
    for count in (0, 1):
        same(scene.closest(given[:count]), scene.closest(rays[:count]))


def test_the_other_questions(scene, rays):
    given = rays.view(Tensor)
    np.testing.assert_array_equal(scene.any(given), scene.any(rays))
    np.testing.assert_array_equal(scene.count(given), scene.count(rays))
    np.testing.assert_array_equal(scene.count(given, max_hits=2), scene.count(rays, max_hits=2))
    for limit in (None, 1):
        found, expected = scene.all(given, max_hits=limit), scene.all(rays, max_hits=limit)
        same(found, expected)
        for name in ("offsets", "ray", "points", "normals"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    none = scene.all(given[:0])
    assert none.offsets.tolist() == [0] and len(none) == 0
    hits, expected = scene.closest(given), scene.closest(rays)
    for name in ("hit", "points", "normals"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(expected, name), err_msg=name)


def test_answers_go_where_they_are_told(scene, rays):
    given = rays.view(Tensor)
    hits = scene.closest(given)
    t = hits.t
    assert scene.closest(given[::-1].copy(), out=hits) is hits
    np.testing.assert_array_equal(hits.t, scene.closest(rays).t[::-1])
    np.testing.assert_array_equal(t, hits.t, "the memory is the same")
    numbers = np.full(500, 7, np.int32).view(Tensor)
    assert scene.any(given, out=numbers) is numbers
    np.testing.assert_array_equal(numbers != 0, scene.any(rays))
    assert scene.count(given, out=numbers) is numbers
    np.testing.assert_array_equal(numbers, scene.count(rays))


def test_closest_points(scene, rays):
    points = rays[:, 3:].copy()
    found, expected = scene.nearest(points.view(Tensor)), scene.nearest(points)
    for name in ("distance", "uv", "primitive", "geometry", "points", "normals"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    np.testing.assert_array_equal(scene.occupancy(points.view(Tensor)), scene.occupancy(points))
    np.testing.assert_array_equal(scene.signed_distance(points.view(Tensor)), scene.signed_distance(points))


def test_meshes_and_transforms_from_the_device(scene, soup, rays):
    vertices, faces = soup
    mesh = scene.mesh((vertices + np.float32(5)).view(Tensor), faces.view(Tensor))
    mesh.vertices = (vertices + np.float32(0.25)).view(Tensor)
    instances = scene.instances(mesh, np.eye(4).view(Tensor))
    instances.transforms = np.eye(3, 4, dtype=np.float32)[np.newaxis].view(Tensor)
    assert set(scene.all(rays).geometry.tolist()) == {0, 1}


def test_what_cannot_be_is_said(scene, rays):
    given = rays.view(Tensor)
    for wrong, kind, text in (
        (given.astype(np.float64), TypeError, "rays on a device have to be float32, and are float64"),
        (given[:, :5].copy(), ValueError, "no rays"),
        (given.T.copy().T, ValueError, "copy it first"),
        (given[::-1], ValueError, "run backwards"),
        (np.zeros((3, 8), np.float32).view(Tensor)[:, ::-1], ValueError, "run backwards"),
    ):
        with pytest.raises(kind, match=text):
            scene.closest(wrong)
    with pytest.raises(ValueError, match="no rays"):
        scene.closest(given[:3, :3].copy(), given[:4, 3:].copy())
    with pytest.raises(ValueError, match="directions are on the CPU"):
        scene.closest(given[:, :3], rays[:, 3:])
    with pytest.raises(TypeError, match="t_min and t_max are numbers"):
        scene.closest(given, t_max=given[:, 0])
    with pytest.raises(ValueError, match="answers have the shape"):
        scene.any(given, out=np.zeros(3, np.int32).view(Tensor))
    with pytest.raises(TypeError, match="answers on a device have to be int32, and are float32"):
        scene.any(given, out=np.zeros(500, np.float32).view(Tensor))
    with pytest.raises(ValueError, match="records have the shape"):
        scene.closest(given[:3], out=scene.closest(given))
    with pytest.raises(TypeError, match="out is room on the CPU"):
        scene.closest(given, out=raywarp.Hits((500,)))
    scene._on_cuda = False
    with pytest.raises(ValueError, match="rays are on a CUDA device, and the scene is on the CPU"):
        scene.closest(given)


def test_arrays_of_raywarp_without_a_library(scene, rays):
    """Those whose library takes no arrays of others: answers say where they lie, by the protocols."""
    _libraries._known[Tensor]._from_dlpack = None
    hits, expected = scene.closest(rays.view(Tensor)), scene.closest(rays)
    for name in ("t", "uv", "primitive", "geometry"):
        array, other = getattr(hits, name), getattr(expected, name)
        np.testing.assert_array_equal(np.from_dlpack(array), other)
        interface = array.__cuda_array_interface__
        assert interface["shape"] == other.shape and interface["typestr"] == other.dtype.str
        assert interface["version"] == 3 and len(interface["strides"]) == other.ndim
