/// @file
/// The Python module pdepth_dart: pdepth's collision detector for worlds of dartpy, and records of their contacts.
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <dart/collision/CollisionDetector.hpp>
#include <memory>
#include <string>

#include "pd/dart/collision_detector.hpp"
#include "pd/dart/contact_recorder.hpp"

namespace py = pybind11;

namespace {

using dart::collision::CollisionDetectorPtr;

/// dartpy knows the base class. Python sees the detector as one.
CollisionDetectorPtr detector(double delta) { return pd::DartDetector::create({.delta = delta}); }

py::dict report(const CollisionDetectorPtr& asked) {
  const auto* ours = dynamic_cast<const pd::DartDetector*>(asked.get());
  if (ours == nullptr) throw py::type_error("this is a detector of DART's own: " + asked->getType());
  const pd::DartReport counts = ours->report();
  constexpr std::array<const char*, pd::kDartRefusals> kKinds{"pose", "size", "mesh", "shape"};
  py::dict left, first;
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    left[kKinds[i]] = counts.left[i];
    if (!counts.first[i].empty()) first[kKinds[i]] = counts.first[i];
  }
  py::dict told;
  told["answered"] = counts.answered;
  told["contact_points"] = counts.contact_points;
  told["left_to_fcl"] = left;
  told["first"] = first;
  return told;
}

class Recorder {
 public:
  explicit Recorder(const std::string& path) : path_(path), recorder_(path.c_str()) { require(recorder_.good()); }
  std::int64_t write(dart::collision::CollisionGroup& group, const dart::collision::CollisionOption& option,
                     double seconds) {
    recorder_.write(group, option, seconds);
    require(recorder_.good());
    return recorder_.contacts();
  }
  void close() { require(recorder_.close()); }

 private:
  void require(bool good) const {
    if (good) return;
    PyErr_SetString(PyExc_OSError, (path_ + " cannot be written").c_str());
    throw py::error_already_set();
  }

  std::string path_;
  pd::DartRecorder recorder_;
};

}  // namespace

PYBIND11_MODULE(pdepth_dart, module) {
  module.doc() = "pdepth's collision detector for dartpy.";
  // Its types are those of the arguments.
  py::module_::import("dartpy");
  module.def("detector", &detector, py::arg("delta") = 0.0,
             "A collision detector with exact contacts, for world.getConstraintSolver().setCollisionDetector(...).\n\n"
             "delta: the relative error for cylinders, cones and ellipsoids; 0 stands for 1e-6.");
  module.def(
      "report", &report, py::arg("detector"),
      "Pairs answered, contact points, and pairs left to DART's FCL detector by reason, with the first of each.");
  py::class_<Recorder>(module, "Recorder", "Writes the contacts of any detector of DART for `pdepth audit`.")
      .def(py::init<const std::string&>(), py::arg("path"), "Raises OSError for a file that cannot be made.")
      .def("write", &Recorder::write, py::arg("group"), py::arg("option"), py::arg("seconds"),
           "Writes the state of a collision group. Returns the contacts written so far.")
      .def("close", &Recorder::close, "Raises OSError if something could not be written.");
}
