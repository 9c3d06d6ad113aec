"""Which arrays are taken, and what is said of others."""

import numpy as np
import pytest
import raywarp


@pytest.fixture
def scene(soup):
    scene = raywarp.Scene("cpu")
    scene.mesh(*soup)
    return scene


def same(one, other):
    for name in ("t", "uv", "primitive", "geometry"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("shape", [(500,), (20, 25), (5, 1, 100), (1, 500)])
def test_answers_have_the_shape_of_the_batch(scene, rays, shape):
    hits = scene.closest(rays.reshape(*shape, 6))
    assert hits.t.shape == hits.primitive.shape == hits.geometry.shape == hits.hit.shape == shape
    assert hits.uv.shape == (*shape, 2) and hits.points.shape == hits.normals.shape == (*shape, 3)
    assert (hits.t.dtype, hits.uv.dtype) == (np.float32, np.float32)
    assert (hits.primitive.dtype, hits.geometry.dtype) == (np.int32, np.int32)
    np.testing.assert_array_equal(hits.t.ravel(), scene.closest(rays).t)
    blocked, count = scene.any(rays.reshape(*shape, 6)), scene.count(rays.reshape(*shape, 6))
    assert blocked.shape == count.shape == shape and (blocked.dtype, count.dtype) == (np.bool_, np.int32)
    assert scene.all(rays.reshape(*shape, 6)).offsets.shape == (501,)


def test_one_ray_and_none(scene, rays):
    one = scene.closest(rays[3])
    assert one.t.shape == () and one.uv.shape == (2,) and one.points.shape == (3,)
    assert one.t == scene.closest(rays).t[3]
    assert scene.any(rays[3]).shape == () and scene.all(rays[3]).offsets.shape == (2,)
    none = scene.closest(rays[:0])
    assert none.t.shape == (0,) and none.uv.shape == (0, 2) and none.normals.shape == (0, 3)
    assert scene.closest(rays.reshape(20, 25, 6)[:, :0]).t.shape == (20, 0)
    assert scene.all(rays[:0]).offsets.tolist() == [0]


def test_rays_are_given_in_several_forms(scene, rays):
    hits = scene.closest(rays)
    eight = np.zeros((500, 8), np.float32)
    eight[:, :3], eight[:, 4:7], eight[:, 7] = rays[:, :3], rays[:, 3:], np.inf
    same(scene.closest(eight), hits)
    same(scene.closest(rays[:, :3], rays[:, 3:]), hits)
    same(scene.closest(rays.tolist()), hits)
    one = scene.closest(rays[0, :3], rays[:, 3:])
    same(one, scene.closest(np.broadcast_to(rays[:1, :3], (500, 3)), rays[:, 3:]))
    np.testing.assert_array_equal(one.points[one.hit], (rays[0, :3] + one.t[:, None] * rays[:, 3:])[one.hit])
    grid = scene.closest(rays[:4, None, :3], rays[None, :6, 3:])
    assert grid.t.shape == (4, 6)
    assert grid.t[1, 5] == scene.closest(rays[1, :3], rays[5, 3:]).t


def test_other_layouts_are_copied(scene, rays):
    hits = scene.closest(rays)
    same(scene.closest(np.asfortranarray(rays)), hits)
    same(scene.closest(np.repeat(rays, 2, axis=0)[::2]), hits)
    backwards = scene.closest(rays[::-1])
    np.testing.assert_array_equal(backwards.t[::-1], hits.t)
    read_only = rays.copy()
    read_only.flags.writeable = False
    same(scene.closest(read_only), hits)
    # Eight numbers are taken where they lie, and copied where a ray may not lie.
    eight = np.zeros((500, 8), np.float32)
    eight[:, :3], eight[:, 4:7], eight[:, 7] = rays[:, :3], rays[:, 3:], np.inf
    for shift in range(4):
        room = np.zeros(4000 + shift, np.float32)[shift:].reshape(500, 8)
        room[:] = eight
        same(scene.closest(room), hits)


def test_other_numbers_are_rounded(scene, rays):
    same(scene.closest(rays.astype(np.float64)), scene.closest(rays))
    whole = np.rint(rays * 3)
    assert scene.closest(whole.astype(int)).hit.any()
    for kind in (np.int8, np.int16, np.int64, np.float16, ">f4", ">f8"):
        same(scene.closest(whole.astype(kind)), scene.closest(whole))
    huge = np.full(6, 1e300)
    assert not scene.any(huge)


def test_other_types_are_refused(scene, rays):
    for wrong in (rays > 0, rays.astype(complex), rays.astype(str), rays.astype(object)):
        with pytest.raises(TypeError, match=r"^rays are .*, and have to be real numbers, best float32$"):
            scene.closest(wrong)
    with pytest.raises(TypeError, match="directions are complex64"):
        scene.closest(rays[:, :3], rays[:, 3:].astype(np.complex64))
    with pytest.raises(TypeError, match="faces are float64, and have to be integers"):
        scene.mesh(np.zeros((3, 3)), [[0.0, 1.0, 2.0]])


def test_wrong_shapes_are_refused(scene, rays):
    for wrong in (rays[:, :5], rays[:, :3], np.zeros((3, 7)), np.float32(3), np.zeros(0)):
        with pytest.raises(ValueError, match="rays have the shape .* the last axis has to be 6 long"):
            scene.any(wrong)
    with pytest.raises(ValueError, match=r"directions have the shape \(500, 2\)"):
        scene.any(rays[:, :3], rays[:, 3:5])
    with pytest.raises(ValueError, match=r"origins of the shape \(3, 3\) and directions of the shape \(4, 3\)"):
        scene.any(rays[:3, :3], rays[:4, 3:])
    with pytest.raises(ValueError, match=r"t_max has the shape \(2,\), and the rays \(500,\)"):
        scene.any(rays, t_max=[1, 2])
    with pytest.raises(ValueError, match="rays cannot be made an array"):
        scene.any([[1, 2], [3]])
    with pytest.raises(ValueError, match="max_hits is 0"):
        scene.count(rays, max_hits=0)


def test_answers_go_where_they_are_told(scene, rays):
    hits = scene.closest(rays)
    room = raywarp.Hits((500,))
    t = room.t
    assert scene.closest(rays, out=room) is room and room.t is t
    same(room, hits)
    np.testing.assert_array_equal(room.points, hits.points)
    with pytest.raises(ValueError, match=r"out has room for a batch of the shape \(500,\)"):
        scene.closest(rays[:7], out=room)


def test_meshes_are_checked():
    scene = raywarp.Scene("cpu")
    with pytest.raises(ValueError, match="face 1 names vertex 3, and there are 3 vertices"):
        scene.mesh(np.zeros((3, 3)), [[0, 1, 2], [0, 1, 3]])
    with pytest.raises(ValueError, match="face 0 names vertex -1"):
        scene.mesh(np.zeros((3, 3)), [[0, 1, -1]])
    with pytest.raises(ValueError, match=r"vertices have the shape \(3, 2\)"):
        scene.mesh(np.zeros((3, 2)), [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"faces have the shape \(1, 4\)"):
        scene.mesh(np.zeros((4, 3)), [[0, 1, 2, 3]])
    with pytest.raises(ValueError, match="transforms have a last row other than"):
        scene.instances(scene.mesh(np.zeros((3, 3)), [[0, 1, 2]]), np.ones((4, 4)))
    for kind in (np.uint8, np.int16, np.uint64):
        scene.mesh(np.eye(3), np.array([[0, 1, 2]], kind))


class OtherArray:
    """Speaks DLPack and nothing else, as arrays of other libraries do."""

    def __init__(self, array, device=None):
        self._array, self._device = array, device

    def __dlpack__(self, **wishes):
        return self._array.__dlpack__(**wishes)

    def __dlpack_device__(self):
        return self._device or self._array.__dlpack_device__()


def test_arrays_of_other_libraries(scene, rays):
    same(scene.closest(OtherArray(rays)), scene.closest(rays))
    with pytest.raises(TypeError, match="rays are in the memory of a device of DLPack's kind 10"):
        scene.closest(OtherArray(rays, (10, 0)))
