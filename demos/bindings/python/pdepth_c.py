"""pdepth.h for ctypes: the structs and functions that client.py uses, in the header's order. Standard library only."""
import ctypes as c

Double3 = c.c_double * 3
Context = c.c_void_p
Shape = c.c_void_p
OK, TOUCHING, OVERLAPPING = 0, 1, 2


class Struct(c.Structure):
    """A struct that knows its size."""

    def __init__(self, **fields):
        super().__init__(**fields)
        if self._fields_[0][0] == "size":
            self.size = c.sizeof(self)


class Error(c.Structure):
    _fields_ = [("status", c.c_int32), ("reserved", c.c_int32), ("message", c.c_char_p), ("where", c.c_char_p)]


class Pose(c.Structure):
    _fields_ = [("form", c.c_int32), ("reserved", c.c_int32), ("numbers", c.c_double * 12)]


class Question(Struct):
    _fields_ = [("size", c.c_uint32), ("reserved", c.c_int32), ("a", Shape), ("b", Shape), ("pose_a", Pose),
                ("pose_b", Pose), ("settings", c.c_void_p), ("pair", c.c_void_p)]


class Feature(c.Structure):
    _fields_ = [(name, c.c_int32) for name in ("kind", "part", "first", "second")]


class Answer(Struct):
    _fields_ = ([("size", c.c_uint32)] +
                [(name, c.c_int32) for name in ("status", "contact", "method", "warm", "bracket_reached")] +
                [(name, c.c_double) for name in ("depth", "lower", "upper", "distance", "distance_lower", "distance_upper")] +
                [(name, Double3) for name in ("translation", "normal", "witness_a", "witness_b")] +
                [("feature_a", Feature), ("feature_b", Feature)] +
                [(name, c.c_int64) for name in ("support_calls", "facets_visited", "exact_signs")])


class PoseArray(c.Structure):
    _fields_ = [("form", c.c_int32), ("reserved", c.c_int32), ("numbers", c.c_void_p), ("stride", c.c_ssize_t)]


class Batch(Struct):
    _fields_ = [("size", c.c_uint32), ("threads", c.c_int32), ("count", c.c_int64), ("a", c.POINTER(Shape)),
                ("stride_a", c.c_ssize_t), ("b", c.POINTER(Shape)), ("stride_b", c.c_ssize_t), ("poses_a", PoseArray),
                ("poses_b", PoseArray), ("settings", c.c_void_p), ("pairs", c.c_void_p), ("stride_pairs", c.c_ssize_t)]


def load(path):
    """The library, its functions declared."""
    library = c.CDLL(path)
    for name, *arguments in [
            ("context_create", c.c_void_p, c.POINTER(Context)), ("last_error", Context, c.POINTER(Error)),
            ("box", Context, Double3, c.POINTER(Shape)),
            ("depth", Context, c.POINTER(Question), c.POINTER(Answer)),
            ("depth_batch", Context, c.POINTER(Batch), c.POINTER(Answer), c.c_ssize_t)]:
        function = getattr(library, "pdepth_" + name)
        function.argtypes, function.restype = arguments, c.c_int32
    for name in ("context_destroy", "shape_release"):
        function = getattr(library, "pdepth_" + name)
        function.argtypes, function.restype = [c.c_void_p], None
    library.pdepth_status_name.argtypes, library.pdepth_status_name.restype = [c.c_int32], c.c_char_p
    return library
