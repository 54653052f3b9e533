/// @file
/// What Python hands in, checked by name: numpy arrays as doubles, and refusals as `pdepth.Refused`, a ValueError.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <typeinfo>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "python/interpreter_lock.hpp"

namespace pd::python {

namespace py = pybind11;

/// Doubles in C order.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// What becomes a `pdepth.Refused`: its message names the argument and the index at fault.
struct Refused {
  std::string code;
  std::string message;
  std::string where;
};

/// @throws Refused
[[noreturn]] void refuse(std::string_view code, std::string message, std::string where);
/// A refusal of the core; its `where` is put below the argument's name: "vertices[3]" becomes "points[3]".
[[noreturn]] void refuse(const Error& error, std::string_view argument);

/// The value, or the refusal thrown.
template <class T>
T value_of(Expected<T> result, std::string_view argument) {
  if (!result) refuse(result.error(), argument);
  return std::move(result).value();
}

/// An array of doubles of a shape; -1 stands for any length.
///
/// Taken: lists of numbers and arrays of float16 to float64 or integers, of any strides (copied where they are not
/// contiguous float64). @throws Refused bad_value for other dtypes (bool, complex, object), for another shape (says
/// when the transposed array would fit) and for integers that are no doubles.
[[nodiscard]] Array read_array(py::handle value, std::string_view argument, std::initializer_list<py::ssize_t> shape);

/// Three finite numbers.
[[nodiscard]] Vec3 read_vector(py::handle value, std::string_view argument);

/// A numpy array that holds a copy.
[[nodiscard]] Array array_of(const Vec3& vector);
[[nodiscard]] Array array_of(const Mat3& matrix);

/// Python's own ways around the making of a T, closed.
///
/// An object that `__new__` alone has made holds no value, and raises TypeError wherever one is needed; pybind11 would
/// take fresh memory for it. Pickles of protocols 0 and 1 are those of protocol 2; Python would make a bare pybind11
/// object for them, which ends the process.
template <class T, class... Options>
void require_made(py::class_<T, Options...>& type) {
  py::detail::get_type_info(typeid(T), true)->operator_new = [](std::size_t) -> void* {
    throw py::type_error("the object was never made: __new__ alone makes none, call its class");
  };
  type.def("__reduce__", [](const py::object& self) {
    if (!py::hasattr(self, "__setstate__")) {
      throw py::type_error("no pickle holds a '" + py::str(py::type::of(self).attr("__name__")).cast<std::string>() +
                           "' object");
    }
    return py::make_tuple(py::module_::import("copyreg").attr("__newobj__"), py::make_tuple(py::type::of(self)),
                          self.attr("__getstate__")());
  });
}

/// Declares `Refused` in the module and uses it.
void bind_refused(py::module_& module);
/// Refusals of this compiled module become that class.
void use_refused(const py::object& exception_class);

}  // namespace pd::python
