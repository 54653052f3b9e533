#include "python/arrays.hpp"

#include <cmath>
#include <cstdint>
#include <type_traits>

namespace pd::python {

namespace {

std::string words_of(std::initializer_list<py::ssize_t> shape) {
  std::string text = "[";
  for (const py::ssize_t length : shape) {
    text += (text.size() > 1 ? ", " : "") + (length < 0 ? std::string("n") : std::to_string(length));
  }
  return text + "]";
}

bool fits(const py::array& array, std::initializer_list<py::ssize_t> shape, bool transposed) {
  const auto dimensions = static_cast<py::ssize_t>(shape.size());
  if (array.ndim() != dimensions) return false;
  py::ssize_t k = 0;
  for (const py::ssize_t length : shape) {
    if (length >= 0 && array.shape(transposed ? dimensions - 1 - k : k) != length) return false;
    ++k;
  }
  return true;
}

void check_dtype(const py::array& array, std::string_view argument) {
  const char kind = array.dtype().kind();
  if ((kind == 'f' && array.itemsize() <= 8) || kind == 'i' || kind == 'u') return;
  refuse("bad_value", "dtype " + py::str(array.dtype()).cast<std::string>() + " is not taken; give float64",
         std::string(argument));
}

/// Looks at the integers themselves: 2^53 + 1 as a double is 2^53.
template <class Integer>
void check_integers(const py::array& array, std::string_view argument) {
  constexpr auto kLargest = Integer{1} << 53;
  const py::array_t<Integer, py::array::c_style> integers(array);
  for (py::ssize_t i = 0; i < integers.size(); ++i) {
    const Integer value = integers.data()[i];
    if (value <= kLargest && (!std::is_signed_v<Integer> || value >= -kLargest)) continue;
    refuse("bad_value", "integers beyond 2^53 are no doubles; give float64",
           std::string(argument) + ".flat[" + std::to_string(i) + "]");
  }
}

/// Whatever numpy makes of a value. @throws Refused where it makes nothing of it, Python's own error where that says
/// nothing about the value: no memory, Ctrl-C.
py::array any_array(py::handle value, std::string_view argument, std::initializer_list<py::ssize_t> shape) {
  try {
    return py::array(py::reinterpret_borrow<py::object>(value));
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || !error.matches(PyExc_Exception)) throw;
  }
  refuse("bad_value", "no array of numbers; give one of shape " + words_of(shape), std::string(argument));
}

}  // namespace

void refuse(std::string_view code, std::string message, std::string where) {
  throw Refused{std::string(code), std::move(message), std::move(where)};
}

void refuse(const Error& error, std::string_view argument) {
  std::string where(argument);
  const std::size_t index = error.where.find('[');
  if (index != std::string::npos) where += error.where.substr(index);
  refuse(to_string(error.code), error.message, std::move(where));
}

Array read_array(py::handle value, std::string_view argument, std::initializer_list<py::ssize_t> shape) {
  if (value.is_none()) refuse("missing_field", "give an array of shape " + words_of(shape), std::string(argument));
  const py::array array = any_array(value, argument, shape);
  if (!fits(array, shape, false)) {
    std::string message =
        "has shape " + py::str(array.attr("shape")).cast<std::string>() + ", needs " + words_of(shape);
    if (fits(array, shape, true)) message += "; it looks transposed: pass its .T";
    refuse("bad_value", std::move(message), std::string(argument));
  }
  check_dtype(array, argument);
  if (array.itemsize() == 8 && array.dtype().kind() == 'i') check_integers<std::int64_t>(array, argument);
  if (array.itemsize() == 8 && array.dtype().kind() == 'u') check_integers<std::uint64_t>(array, argument);
  return Array(py::object(array));
}

Vec3 read_vector(py::handle value, std::string_view argument) {
  const Array array = read_array(value, argument, {3});
  const Vec3 vector(array.at(0), array.at(1), array.at(2));
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(vector[i])) {
      refuse("non_finite", "must be finite", std::string(argument) + "[" + std::to_string(i) + "]");
    }
  }
  return vector;
}

Array array_of(const Vec3& vector) { return Array(3, vector.data()); }

Array array_of(const Mat3& matrix) {
  Array array({3, 3});
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) array.mutable_at(i, j) = matrix(i, j);
  }
  return array;
}

void use_refused(const py::object& exception_class) {
  static py::handle refused;  // lives as long as the interpreter
  refused = exception_class.inc_ref();
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const Refused& error) {
      const std::string place = error.where + ": ";
      const bool placed = error.message.starts_with(place);  // the reader of a file names the file
      // A file's name may hold bytes that are no UTF-8; Python's own form of such names keeps them.
      const auto word = [](const std::string& text) {
        return py::reinterpret_steal<py::str>(
            PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
      };
      const py::object instance = refused(word((placed ? "" : place) + error.message + " (" + error.code + ")"));
      instance.attr("code") = error.code;
      instance.attr("where") = word(error.where);
      PyErr_SetObject(refused.ptr(), instance.ptr());
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError, "an argument is of another type, or was never made: __new__ alone makes none");
    }
  });
}

void bind_refused(py::module_& module) {
  const py::object refused = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "pdepth.Refused",
      "Bad input: says which argument, which index, and what would be right.\n\n"
      "code: a word of the line protocol ('non_finite', 'not_a_rotation', ...); where: the argument and index.",
      PyExc_ValueError, nullptr));
  module.attr("Refused") = refused;
  use_refused(refused);
}

}  // namespace pd::python
