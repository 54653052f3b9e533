/// @file
/// The module `pdepth._core`: shapes, poses and pairs; it needs nothing but the core and numpy.
#include "python/batch.hpp"

namespace {

newfunc make_registered = nullptr;

/// pybind11's base class belongs to no C++ type. Its own __new__ throws through Python's C code, which ends the
/// process.
PyObject* refuse_unregistered(PyTypeObject* type, PyObject* arguments, PyObject* keywords) {
  if (!pybind11::detail::all_type_info(type).empty()) return make_registered(type, arguments, keywords);
  PyErr_Format(PyExc_TypeError, "%s makes no objects: call a class of pdepth", type->tp_name);
  return nullptr;
}

void guard_base_class() {
  auto* const base = reinterpret_cast<PyTypeObject*>(pybind11::detail::get_internals().instance_base);
  if (base->tp_new == refuse_unregistered) return;
  make_registered = base->tp_new;
  base->tp_new = refuse_unregistered;
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of pdepth; use the package pdepth.";
  guard_base_class();
  pd::python::bind_refused(module);
  pd::python::bind_pose(module);
  pd::python::bind_shapes(module);
  pd::python::bind_pair_queries(module);
  pd::python::bind_union_contacts(module);
  pd::python::bind_batch_queries(module);
}
