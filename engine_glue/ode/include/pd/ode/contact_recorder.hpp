/// @file
/// Records ODE's contacts for `pdepth audit`: the answer of `dCollide` for each pair, by ODE or by pdepth.
///
///   pd::OdeRecorder recorder("contacts.jsonl");
///   for (int step = 0; step < 60; ++step) simulate();
///   if (!recorder.close()) std::perror("contacts.jsonl");
///
/// The format is that of `pd/record/pd_record.h`.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <memory>

namespace pd {

namespace detail {
class OdeRecord;
}

/// Records while it lives. pdepth's function then stands in ODE's table and hands every call on to ODE's own, or to
/// that of `install_ode`, which may be installed and uninstalled meanwhile. Begin and end a recorder while no thread is
/// inside ODE, which must be initialised. One recorder at a time sees the pairs of the whole process.
///
/// The recorder writes a line for every pair that `dCollide` is asked about, if both geoms are convex or one is a
/// plane. If the answer has no contact, the line says `null`. Else it reports the deepest point with its normal, and
/// then all points. ODE's points lie on no surface in particular; the record puts them midway.
///
/// Pairs without an exact shape or pose (bad sizes, convex geoms without `ode_convex`) are counted as `unsupported` and
/// not written. Threads write one at a time. A line takes O(log s) time in the shapes of the record.
class OdeRecorder {
 public:
  /// Creates the file. If it cannot be created, or another recorder is at work, `good` is false.
  explicit OdeRecorder(const char* path);
  ~OdeRecorder();
  OdeRecorder(const OdeRecorder&) = delete;
  OdeRecorder& operator=(const OdeRecorder&) = delete;

  /// The time that is written with each pair from now on; none before the first call.
  void set_time(double seconds);

  /// Ends the recording and closes the file. A second call does nothing and returns the same.
  /// @return false if something could not be written
  bool close();

  /// True if the file was created and everything was written so far.
  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;     ///< lines written
  [[nodiscard]] std::int64_t unsupported() const;  ///< pairs that were not written

 private:
  std::unique_ptr<detail::OdeRecord> record_;
};

/// Records the contacts of one state, in one call: those of all geoms of a space, and of the spaces in it, as they are.
/// Requires that no thread is inside ODE.
/// @return false if the file cannot be written, or another recorder is at work
bool record_ode(dSpaceID space, const char* path);

}  // namespace pd
