#include "python/pose_argument.hpp"

#include <cmath>
#include <string>

namespace pd::python {

namespace {

Mat3 matrix_of(const Array& array) {
  Mat3 rotation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation(i, j) = array.at(i, j);
  }
  return rotation;
}

/// @param turn  the name of what says how the body is turned; the translation is named by its own
Pose pose_or_refusal(const Expected<Pose>& pose, const std::string& argument, const char* turn) {
  if (!pose) refuse(pose.error(), argument + (pose.error().where.starts_with("translation") ? "translation" : turn));
  return *pose;
}

Pose pose_of_parts(py::handle rotation_value, py::handle translation_value, const std::string& argument) {
  const Mat3 rotation = rotation_value.is_none() ? Mat3(Mat3::Identity())
                                                 : matrix_of(read_array(rotation_value, argument + "rotation", {3, 3}));
  const Vec3 translation =
      translation_value.is_none() ? Vec3(Vec3::Zero()) : read_vector(translation_value, argument + "translation");
  return pose_or_refusal(Pose::from_matrix(rotation, translation), argument, "rotation");
}

Pose pose_of_array(py::handle value, std::string_view argument) {
  const Array array = read_array(value, argument, {4, 4});
  return value_of(pose_of_matrix(array.data()), argument);
}

Pose make_pose(const py::object& matrix, const py::object& rotation, const py::object& translation,
               const py::object& wxyz, const py::object& xyzw) {
  const int turns = !matrix.is_none() + !rotation.is_none() + !wxyz.is_none() + !xyzw.is_none();
  if (turns > 1) refuse("bad_value", "give one of matrix, rotation, wxyz and xyzw", "Pose");
  if (!matrix.is_none()) {
    if (!translation.is_none()) refuse("bad_value", "a 4x4 matrix holds its translation", "translation");
    return read_pose(matrix, "matrix");
  }
  if (wxyz.is_none() && xyzw.is_none()) return pose_of_parts(rotation, translation, "");
  const bool scalar_first = !wxyz.is_none();
  const char* const name = scalar_first ? "wxyz" : "xyzw";
  const Array q = read_array(scalar_first ? wxyz : xyzw, name, {4});
  const std::array<double, 4> numbers =
      scalar_first ? std::array{q.at(0), q.at(1), q.at(2), q.at(3)} : std::array{q.at(3), q.at(0), q.at(1), q.at(2)};
  const Vec3 t = translation.is_none() ? Vec3(Vec3::Zero()) : read_vector(translation, "translation");
  return pose_or_refusal(Pose::from_quaternion(numbers, t), "", name);
}

Array matrix4_of(const Pose& pose) {
  Array array({4, 4});
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) array.mutable_at(i, j) = i == j ? 1 : 0;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) array.mutable_at(i, j) = pose.rotation()(i, j);
    array.mutable_at(i, 3) = pose.translation()[i];
  }
  return array;
}

/// What makes it again.
py::dict keywords_of(const Pose& pose) {
  py::dict keywords;
  if (pose.is_quaternion()) {
    const auto& q = pose.quaternion_wxyz();
    keywords["wxyz"] = py::make_tuple(q[0], q[1], q[2], q[3]);
  } else if (pose.rotation() != Mat3::Identity()) {
    keywords["rotation"] = array_of(pose.rotation()).attr("tolist")();
  }
  if (pose.translation() != Vec3::Zero()) keywords["translation"] = array_of(pose.translation()).attr("tolist")();
  return keywords;
}

/// Equal poses have equal hashes, whatever the signs of their zeros.
py::ssize_t hash_of(const Pose& pose) {
  py::list numbers;
  for (const double number : pose.rotation().reshaped()) numbers.append(number);
  for (const double number : pose.translation()) numbers.append(number);
  return py::hash(py::tuple(numbers));
}

std::string repr_of(const Pose& pose) {
  std::string text = "Pose(";
  for (const auto& [key, value] : keywords_of(pose)) {
    if (text.back() != '(') text += ", ";
    text += py::str(key).cast<std::string>() + "=" + py::repr(value).cast<std::string>();
  }
  return text + ")";
}

Pose pose_of_keywords(const py::dict& keywords) {
  const auto field = [&](const char* name) -> py::object {
    return keywords.contains(name) ? py::object(keywords[name]) : py::object(py::none());
  };
  return make_pose(py::none(), field("rotation"), field("translation"), field("wxyz"), py::none());
}

}  // namespace

Expected<Pose> pose_of_matrix(const double* numbers) {
  const auto place = [](int k) { return "[" + std::to_string(k / 4) + ", " + std::to_string(k % 4) + "]"; };
  for (int k = 0; k < 16; ++k) {
    if (!std::isfinite(numbers[k])) return Error{ErrorCode::non_finite, "a pose must be finite", place(k)};
  }
  if (numbers[12] != 0 || numbers[13] != 0 || numbers[14] != 0 || numbers[15] != 1) {
    return Error{ErrorCode::bad_value,
                 numbers[3] == 0 && numbers[7] == 0 && numbers[11] == 0
                     ? "the last row is 0, 0, 0, 1 and the translation the last column; it looks transposed"
                     : "the last row is 0, 0, 0, 1",
                 ""};
  }
  Mat3 rotation;
  rotation << numbers[0], numbers[1], numbers[2], numbers[4], numbers[5], numbers[6], numbers[8], numbers[9],
      numbers[10];
  const Vec3 translation(numbers[3], numbers[7], numbers[11]);
  Expected<Pose> pose = Pose::from_matrix(rotation, translation);
  if (!pose && pose.error().where.starts_with("translation")) {
    int row = 0;
    translation.cwiseAbs().maxCoeff(&row);
    return Error{pose.error().code, pose.error().message, place(4 * row + 3)};
  }
  return pose;
}

Pose read_pose(py::handle value, std::string_view argument) {
  if (value.is_none()) return {};
  if (py::isinstance<Pose>(value)) return py::cast<const Pose&>(value);
  if (py::isinstance<py::tuple>(value) && py::len(value) == 2) {
    const auto pair = py::reinterpret_borrow<py::tuple>(value);
    return pose_of_parts(pair[0], pair[1], std::string(argument) + ".");
  }
  return pose_of_array(value, argument);
}

void bind_pose(py::module_& module) {
  py::class_<Pose> type(
      module, "Pose",
      "A rigid placement: world point = R * local + translation.\n\n"
      "Pose(matrix) of a 4x4 matrix; Pose(rotation=R, translation=t); Pose(wxyz=q, translation=t) or\n"
      "Pose(xyzw=q, translation=t): the order of a quaternion is always named. A matrix is used as given\n"
      "(|R^T R - I| <= 1e-6, det > 0), a quaternion stands for R(q) / |q|^2, exactly.");
  require_made(type);
  type.def(py::init(&make_pose), py::arg("matrix") = py::none(), py::kw_only(), py::arg("rotation") = py::none(),
           py::arg("translation") = py::none(), py::arg("wxyz") = py::none(), py::arg("xyzw") = py::none())
      .def(py::init([](const py::object&, const py::object&) -> Pose {
             refuse("bad_value", "takes one 4x4 matrix; give Pose(rotation=R, translation=t)", "Pose");
           }),
           py::arg("matrix"), py::arg("translation"), py::pos_only())
      .def_property_readonly("matrix", &matrix4_of, "[4, 4] float64.")
      .def_property_readonly(
          "rotation", [](const Pose& pose) { return array_of(pose.rotation()); },
          "[3, 3] float64; rounded where the pose was given as a quaternion.")
      .def_property_readonly(
          "translation", [](const Pose& pose) { return array_of(pose.translation()); }, "[3].")
      .def("__repr__", &repr_of)
      .def("__eq__", [](const Pose& a, const py::object& b) { return py::isinstance<Pose>(b) && a == b.cast<Pose>(); })
      .def("__hash__", &hash_of)
      .def("_keywords", &keywords_of)
      .def(py::pickle(&keywords_of, &pose_of_keywords));
}

}  // namespace pd::python
