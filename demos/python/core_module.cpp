/// @file
/// The module `pdepth._core`: shapes, poses and pairs; it needs nothing but the core and numpy.
#include "python/batch.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of pdepth; use the package pdepth.";
  pd::python::bind_refused(module);
  pd::python::bind_pose(module);
  pd::python::bind_shapes(module);
  pd::python::bind_pair_queries(module);
  pd::python::bind_batch_queries(module);
}
