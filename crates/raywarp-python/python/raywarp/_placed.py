"""Meshes of a scene, and where they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from raywarp import _arrays, _libraries, _raywarp

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._types import Floats


class Place:
    """Where a mesh stands, once or many times."""

    def __init__(self, mesh: int, transforms: Floats) -> None:
        self.mesh = mesh
        self.transforms = transforms


class World:
    """What a scene shares with its meshes and instances. These hold it and it does not hold them, so a scene is freed as soon as
    nobody has it."""

    def __init__(self, core: _raywarp.Scene) -> None:
        self.core = core
        # In the order of the numbers of geometry, behind those of the scene's file.
        self.places: list[Place] = []
        # Whether the structure on the device is of another state.
        self.changed = True

    def to_host(self, array: Any) -> Any:
        """What the CPU reads: an array on a CUDA device is copied, once it has been made."""
        return _libraries.to_host(self.core, array) if _libraries.is_on_cuda(array) else array

    def add(self, place: Place, instead_of: Optional[Place] = None) -> None:
        self.places = [other for other in self.places if other is not instead_of] + [place]
        self.changed = True

    def tell_places(self) -> None:
        """Tells the core what stands where."""
        moving = any(place.transforms is not IDENTITY for place in self.places)
        self.core.place([(place.mesh, place.transforms) for place in self.places], moving)

    def geometry(self, wanted: Place) -> Optional[range]:
        """The numbers of a place; None if nothing stands there."""
        first = self.core.of_file
        for place in self.places:
            end = first + len(place.transforms)
            if place is wanted:
                return range(first, end)
            first = end
        return None


# The transform of what stands where its vertices are.
IDENTITY = np.eye(3, 4, dtype=np.float32)[np.newaxis]


class Mesh:
    """Triangles of a scene, made by `Scene.mesh`."""

    def __init__(self, world: World, vertices: Floats, faces: npt.NDArray[np.uint32]) -> None:
        self._world = world
        self._vertices = vertices
        self._faces = faces
        self._place = Place(world.core.add_mesh(vertices, faces), IDENTITY)
        world.add(self._place)

    @property
    def vertices(self) -> Floats:
        """(V, 3) float32; a copy. Assigned, as many vertices as there were, they take the place of the others with the next
        `Scene.commit` or query."""
        return self._vertices.copy()

    @vertices.setter
    def vertices(self, value: Any) -> None:
        vertices = _arrays.vertices(self._world.to_host(value))
        if len(vertices) != len(self._vertices):
            raise ValueError(f"{len(vertices)} vertices cannot take the place of the mesh's {len(self._vertices)}")
        self._world.core.move_vertices(self._place.mesh, vertices)
        self._world.changed = True
        self._vertices = vertices

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """(F, 3) uint32; a copy."""
        return self._faces.copy()

    @property
    def geometry(self) -> Optional[int]:
        """Its number in `Hits.geometry`. None once `Scene.instances` has placed it: then each instance has one."""
        numbers = self._world.geometry(self._place)
        return None if numbers is None else numbers.start

    def __repr__(self) -> str:
        return f"Mesh(vertices={len(self._vertices)}, faces={len(self._faces)})"


class Instances:
    """Places of a mesh in a scene, made by `Scene.instances`."""

    def __init__(self, mesh: Mesh, transforms: Floats) -> None:
        self.mesh = mesh
        self._place = Place(mesh._place.mesh, transforms)
        mesh._world.add(self._place, instead_of=mesh._place)

    @property
    def transforms(self) -> Floats:
        """(n, 3, 4) float32, mesh space to world space; a copy. Assigned, as many as there were, they take the place of the others
        with the next `Scene.commit` or query."""
        return self._place.transforms.copy()

    @transforms.setter
    def transforms(self, value: Any) -> None:
        transforms = _arrays.transforms(self.mesh._world.to_host(value))
        if len(transforms) != len(self):
            raise ValueError(f"{len(transforms)} transforms cannot take the place of {len(self)}")
        self._place.transforms = transforms
        self.mesh._world.changed = True

    @property
    def geometry(self) -> range:
        """Their numbers in `Hits.geometry`."""
        return self.mesh._world.geometry(self._place) or range(0)

    def __len__(self) -> int:
        return len(self._place.transforms)

    def __repr__(self) -> str:
        return f"Instances({len(self)} of {self.mesh!r})"
