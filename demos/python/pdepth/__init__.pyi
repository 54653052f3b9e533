"""Types of the package; the docstrings stand in the sources."""

import os
from typing import Any, Callable, Iterable, Iterator, Literal, Mapping, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

from . import record as record

__version__: str
ERRORS: Tuple[str, ...]
CONTACTS: Tuple[str, str, str]
FEATURES: Tuple[str, str, str, str]

Floats = npt.NDArray[np.float64]
Contact = Literal["separated", "touching", "overlapping"]
Method = Literal["auto", "expansion", "overlay", "decomposition", "shallow", "grid"]
Bracket = Literal["tightest", "certified", "contact"]
Axis = Literal["x", "y", "z"]
MeshWish = Literal["solid", "hull", "parts"]
Feature = Optional[Tuple[Literal["vertex", "edge", "facet"], Tuple[int, ...]]]

class Refused(ValueError):
    code: str
    where: str

class Pose:
    def __init__(self, matrix: Optional[npt.ArrayLike] = ..., *, rotation: Optional[npt.ArrayLike] = ...,
                 translation: Optional[npt.ArrayLike] = ..., wxyz: Optional[npt.ArrayLike] = ...,
                 xyzw: Optional[npt.ArrayLike] = ...) -> None: ...
    @property
    def matrix(self) -> Floats: ...
    @property
    def rotation(self) -> Floats: ...
    @property
    def translation(self) -> Floats: ...

PoseLike = Union[None, Pose, npt.ArrayLike, Tuple[npt.ArrayLike, npt.ArrayLike]]
#: Certainly one; an array may be one matrix or many, which types cannot tell.
OnePose = Union[None, Pose, Tuple[npt.ArrayLike, npt.ArrayLike]]
PosesLike = Union[PoseLike, Sequence[OnePose]]
VectorLike = Union[Sequence[float], Floats]
Polygon = Union[npt.ArrayLike, Mapping[str, Any]]

class Shape:
    @property
    def margin(self) -> float: ...
    @property
    def vertices(self) -> Floats: ...
    @property
    def facets(self) -> list[list[int]]: ...
    @property
    def is_convex(self) -> bool: ...
    def protocol(self) -> dict[str, Any]: ...
    def _repr_png_(self) -> bytes: ...

ShapesLike = Union[Shape, Sequence[Shape]]

class ConvexPolytope(Shape):
    def __init__(self, points: npt.ArrayLike, *, margin: float = ...) -> None: ...
    @classmethod
    def from_faces(cls, vertices: npt.ArrayLike, faces: Iterable[Iterable[int]], *, margin: float = ...) -> ConvexPolytope: ...
    @classmethod
    def from_halfspaces(cls, planes: npt.ArrayLike, *, margin: float = ...) -> ConvexPolytope: ...
    @classmethod
    def from_mesh(cls, mesh: Union[str, os.PathLike[str], Any], *, margin: float = ..., hull: bool = ...) -> ConvexPolytope: ...

class Box(Shape):
    def __init__(self, half_extents: npt.ArrayLike, *, margin: float = ...) -> None: ...

class Sphere(Shape):
    def __init__(self, radius: float, *, margin: float = ...) -> None: ...

class Ellipsoid(Shape):
    def __init__(self, radii: npt.ArrayLike, *, margin: float = ...) -> None: ...

class SphereHull(Shape):
    def __init__(self, spheres: npt.ArrayLike, *, margin: float = ...) -> None: ...

class Capsule(Shape):
    def __init__(self, radius: float, half_height: float, axis: Axis = ..., *, margin: float = ...) -> None: ...

class Cylinder(Shape):
    def __init__(self, radius: float, half_height: float, axis: Axis = ..., *, margin: float = ...) -> None: ...

class Cone(Shape):
    def __init__(self, radius: float, half_height: float, axis: Axis = ..., *, margin: float = ...) -> None: ...

class Compound(Shape):
    def __init__(self, parts: Iterable[Union[Shape, Tuple[Shape, PoseLike]]], *, margin: float = ...) -> None: ...
    @classmethod
    def from_mesh(cls, mesh: Union[str, os.PathLike[str], Any], *, error: Optional[float] = ..., side: Literal["outer", "inner"] = ..., turn_faces: bool = ..., margin: float = ...) -> Compound: ...
    @property
    def error(self) -> Optional[float]: ...

class StarBody(Shape):
    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike, center: npt.ArrayLike, *, margin: float = ...) -> None: ...

class Sheet:
    def __init__(self, vertices: npt.ArrayLike, faces: Iterable[Iterable[int]], *, margin: float = ...) -> None: ...

class Warm:
    def __init__(self) -> None: ...
    def clear(self) -> None: ...
    @property
    def nbytes(self) -> int: ...

class Depth:
    contact: Contact
    depth: float
    lower: float
    upper: float
    distance: float
    distance_lower: float
    distance_upper: float
    signed_depth: float
    translation: Floats
    normal: Floats
    witness_a: Floats
    witness_b: Floats
    feature_a: Feature
    feature_b: Feature
    part_a: int
    part_b: int
    bracket_reached: bool
    method: str
    warm: bool
    stats: dict[str, int]
    shape_a: Shape
    shape_b: Shape

class Batch:
    error: npt.NDArray[np.uint8]
    def __getattr__(self, name: str) -> npt.NDArray[Any]: ...
    def __getitem__(self, name: str) -> npt.NDArray[Any]: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def keys(self) -> Tuple[str, ...]: ...
    def of_row(self, i: Any) -> dict[str, Any]: ...
    def save(self, path: Union[str, os.PathLike[str]]) -> None: ...

class RowBatch(Batch):
    def of_row(self, i: int) -> dict[str, Any]: ...

class RobotDistances(Batch):
    signed_distance: Floats
    lower: Floats
    upper: Floats
    normal: Floats
    witness_a: Floats
    witness_b: Floats
    pair: npt.NDArray[np.int64]
    by_q: Floats
    unique: npt.NDArray[np.bool_]

class Robot:
    name: str
    links: Tuple[str, ...]
    joints: Tuple[str, ...]
    coordinates: Tuple[str, ...]
    limits: Floats
    pairs: Tuple[Tuple[str, str], ...]
    @classmethod
    def from_urdf(cls, path: Union[str, os.PathLike[str]], *, srdf: Union[None, str, os.PathLike[str]] = ...,
                  package_roots: Union[None, str, os.PathLike[str], Sequence[Union[str, os.PathLike[str]]],
                                       Mapping[str, Union[str, os.PathLike[str]]]] = ...,
                  meshes: Union[MeshWish, Mapping[str, MeshWish]] = ..., tolerance: float = ...) -> Robot: ...
    @classmethod
    def from_sdf(cls, path: Union[str, os.PathLike[str]], *, srdf: Union[None, str, os.PathLike[str]] = ...,
                 package_roots: Union[None, str, os.PathLike[str], Sequence[Union[str, os.PathLike[str]]],
                                      Mapping[str, Union[str, os.PathLike[str]]]] = ...,
                 meshes: Union[MeshWish, Mapping[str, MeshWish]] = ..., tolerance: float = ...) -> Robot: ...
    @property
    def dof(self) -> int: ...
    def shape(self, link: str) -> Optional[Shape]: ...
    def poses(self, q: npt.ArrayLike) -> Floats: ...
    def distances(self, q: npt.ArrayLike, *, pairs: Optional[Iterable[Tuple[str, str]]] = ..., nearest: bool = ...,
                  derivatives: bool = ..., bracket: Bracket = ..., warm: bool = ...,
                  threads: Optional[int] = ...) -> RobotDistances: ...
    def sweep(self, q: npt.ArrayLike, client: Any = ..., *, out: Union[str, os.PathLike[str]], chunk: int = ...,
              threads: Optional[int] = ..., progress: bool = ..., **options: Any) -> Sweep: ...
    def picture(self, q: npt.ArrayLike, *, size: Tuple[int, int] = ..., azimuth: float = ...,
                elevation: float = ...) -> npt.NDArray[np.uint8]: ...

class Answer:
    def __getattr__(self, name: str) -> Any: ...

class DirectionalDepth:
    contact: Contact
    depth: float
    lower: float
    upper: float
    normal: Floats

class Manifold:
    normal: Floats
    position_a: Floats
    position_b: Floats
    depth: Floats
    feature_id: npt.NDArray[np.int64]
    normals: Floats
    piece_a: npt.NDArray[np.int64]
    piece_b: npt.NDArray[np.int64]
    patches: list[Manifold]
    covered: int

class Derivatives:
    answer: Depth
    signed_depth: float
    unique_direction: bool
    unique_witness: bool
    stable_features: bool
    by_a: Floats
    by_b: Floats
    normal_by_a: Floats
    normal_by_b: Floats
    witness_a_by_a: Floats
    witness_a_by_b: Floats
    witness_b_by_a: Floats
    witness_b_by_b: Floats

class Sweep:
    files: list[Any]
    count: int
    computed: int
    def __iter__(self) -> Iterator[dict[str, npt.NDArray[Any]]]: ...
    def __getitem__(self, name: str) -> npt.NDArray[Any]: ...

def cores() -> int: ...
@overload
def depth(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *, method: Method = ...,
          delta: Optional[float] = ..., bracket: Bracket = ..., beyond: Optional[float] = ..., warm: Optional[Warm] = ...,
          axis: int = ..., threads: Optional[int] = ...) -> Depth: ...
@overload
def depth(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *, method: Method = ...,
          delta: Optional[float] = ..., bracket: Bracket = ..., beyond: Optional[float] = ..., warm: Optional[bool] = ...,
          axis: int = ..., threads: Optional[int] = ...) -> Batch: ...
@overload
def depth(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *, method: Method = ...,
          delta: Optional[float] = ..., bracket: Bracket = ..., beyond: Optional[float] = ..., warm: Optional[bool] = ...,
          axis: int = ..., threads: Optional[int] = ...) -> Any: ...
@overload
def distance(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *, threads: Optional[int] = ...) -> float: ...
@overload
def distance(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
             threads: Optional[int] = ...) -> Floats: ...
@overload
def distance(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
             threads: Optional[int] = ...) -> Any: ...
@overload
def intersects(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *, threads: Optional[int] = ...) -> bool: ...
@overload
def intersects(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
               threads: Optional[int] = ...) -> npt.NDArray[np.bool_]: ...
@overload
def intersects(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
               threads: Optional[int] = ...) -> Any: ...
@overload
def directional_depth(a: Shape, b: Shape, direction: VectorLike, pose_a: OnePose = ..., pose_b: OnePose = ..., *,
                      threads: Optional[int] = ...) -> DirectionalDepth: ...
@overload
def directional_depth(a: Sequence[Shape], b: ShapesLike, direction: npt.ArrayLike, pose_a: PosesLike = ...,
                      pose_b: PosesLike = ..., *, threads: Optional[int] = ...) -> Batch: ...
@overload
def directional_depth(a: ShapesLike, b: ShapesLike, direction: npt.ArrayLike, pose_a: PosesLike = ...,
                      pose_b: PosesLike = ..., *, threads: Optional[int] = ...) -> Any: ...
@overload
def contact_manifold(a: Union[Shape, Sheet], b: Union[Shape, Sheet], pose_a: OnePose = ..., pose_b: OnePose = ..., *,
                     breaking_threshold: float = ..., one_sided: bool = ..., threads: Optional[int] = ...) -> Manifold: ...
@overload
def contact_manifold(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                     breaking_threshold: float = ..., one_sided: bool = ..., threads: Optional[int] = ...) -> Batch: ...
@overload
def contact_manifold(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                     breaking_threshold: float = ..., one_sided: bool = ..., threads: Optional[int] = ...) -> Any: ...
@overload
def derivatives(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *,
                threads: Optional[int] = ...) -> Derivatives: ...
@overload
def derivatives(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                threads: Optional[int] = ...) -> Batch: ...
@overload
def derivatives(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                threads: Optional[int] = ...) -> Any: ...
def query(name: str, **fields: Any) -> Answer: ...
def query_many(name: str, rows: Iterable[Mapping[str, Any]], *, threads: Optional[int] = ...) -> RowBatch: ...
@overload
def width(a: Shape, pose_a: OnePose = ..., *, method: Optional[str] = ..., delta: Optional[float] = ...,
          threads: Optional[int] = ...) -> Answer: ...
@overload
def width(a: Sequence[Shape], pose_a: PosesLike = ..., *, method: Optional[str] = ..., delta: Optional[float] = ...,
          threads: Optional[int] = ...) -> RowBatch: ...
@overload
def width(a: ShapesLike, pose_a: PosesLike = ..., *, method: Optional[str] = ..., delta: Optional[float] = ...,
          threads: Optional[int] = ...) -> Any: ...
@overload
def minkowski_difference(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *,
                         threads: Optional[int] = ...) -> Answer: ...
@overload
def minkowski_difference(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                         threads: Optional[int] = ...) -> RowBatch: ...
@overload
def minkowski_difference(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                         threads: Optional[int] = ...) -> Any: ...
@overload
def hull(a: Shape, pose_a: OnePose = ..., *, threads: Optional[int] = ...) -> Answer: ...
@overload
def hull(a: Sequence[Shape], pose_a: PosesLike = ..., *, threads: Optional[int] = ...) -> RowBatch: ...
@overload
def hull(a: ShapesLike, pose_a: PosesLike = ..., *, threads: Optional[int] = ...) -> Any: ...
@overload
def time_of_impact(a: Shape, b: Shape, pose_a: OnePose = ..., pose_b: OnePose = ..., *,
                   velocity_a: Optional[VectorLike] = ..., angular_velocity_a: Optional[VectorLike] = ...,
                   velocity_b: Optional[VectorLike] = ..., angular_velocity_b: Optional[VectorLike] = ...,
                   duration: float = ..., tolerance: Optional[float] = ..., threads: Optional[int] = ...) -> Answer: ...
@overload
def time_of_impact(a: Sequence[Shape], b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                   velocity_a: Optional[npt.ArrayLike] = ..., angular_velocity_a: Optional[npt.ArrayLike] = ...,
                   velocity_b: Optional[npt.ArrayLike] = ..., angular_velocity_b: Optional[npt.ArrayLike] = ...,
                   duration: npt.ArrayLike = ..., tolerance: Optional[npt.ArrayLike] = ...,
                   threads: Optional[int] = ...) -> RowBatch: ...
@overload
def time_of_impact(a: ShapesLike, b: ShapesLike, pose_a: PosesLike = ..., pose_b: PosesLike = ..., *,
                   velocity_a: Optional[npt.ArrayLike] = ..., angular_velocity_a: Optional[npt.ArrayLike] = ...,
                   velocity_b: Optional[npt.ArrayLike] = ..., angular_velocity_b: Optional[npt.ArrayLike] = ...,
                   duration: npt.ArrayLike = ..., tolerance: Optional[npt.ArrayLike] = ...,
                   threads: Optional[int] = ...) -> Any: ...
@overload
def polygon_depth(p: Mapping[str, Any], q: Mapping[str, Any], *, threads: Optional[int] = ..., **options: Any) -> Answer: ...
@overload
def polygon_depth(p: Union[Polygon, Sequence[Polygon]], q: Union[Polygon, Sequence[Polygon]], *,
                  threads: Optional[int] = ..., **options: Any) -> Any: ...
def audit(records: Union[str, os.PathLike[str], Iterable[Union[str, Mapping[str, Any]]]], *, tolerance: Optional[float] = ...,
          worst: int = ..., fail_on: Optional[str] = ..., threads: Optional[int] = ...) -> Answer: ...
def picture(a: Shape, b: Optional[Shape] = ..., pose_a: PoseLike = ..., pose_b: PoseLike = ..., *, size: Tuple[int, int] = ...,
            azimuth: float = ..., elevation: float = ..., difference: bool = ...) -> npt.NDArray[np.uint8]: ...
def save_picture(path: Union[str, os.PathLike[str]], rgb: npt.NDArray[np.uint8]) -> None: ...
def sweep(shapes: Sequence[Shape], pairs: npt.ArrayLike,
          poses: Union[Tuple[npt.ArrayLike, npt.ArrayLike], Callable[[int, int], Tuple[npt.ArrayLike, npt.ArrayLike]]],
          client: Any = ..., *, out: Union[str, os.PathLike[str]], chunk: int = ..., threads: Optional[int] = ...,
          progress: bool = ..., **options: Any) -> Sweep: ...
