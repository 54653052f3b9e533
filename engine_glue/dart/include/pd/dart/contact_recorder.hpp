/// @file
/// Records DART's contacts for `pdepth audit`, by any of its detectors.
///
///   pd::DartRecorder recorder("contacts.jsonl");
///   for (int step = 0; step < 60; ++step) {
///     world->step();
///     recorder.write(*group, option, world->getTime());
///   }
///   if (!recorder.close()) std::perror("contacts.jsonl");
///
/// The format is that of `pd/record/pd_record.h`.
#pragma once

#include <cstdint>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionOption.hpp>
#include <memory>

namespace pd {

namespace detail {
class DartRecord;
}

/// Writes states of groups. The engine's name in the record is that of the first group's detector.
class DartRecorder {
 public:
  /// Creates the file. If it cannot be created, `good` is false.
  explicit DartRecorder(const char* path);
  ~DartRecorder();
  DartRecorder(const DartRecorder&) = delete;
  DartRecorder& operator=(const DartRecorder&) = delete;

  /// Asks the group's detector for its contacts and writes a line for each pair that it reports. A pair that the filter
  /// lets through and whose bounding spheres meet, but which was not reported, gets a line that says `null`. DART's
  /// points lie on no surface in particular; the record puts them midway. Pairs of shapes that pdepth does not know are
  /// counted as unsupported. The option's number of contacts is not heeded. Positions are in the frame of the world.
  /// Time O(n^2) for n objects, and that of the detector.
  void write(dart::collision::CollisionGroup& group, const dart::collision::CollisionOption& option, double seconds);

  /// Closes the file. A second call does nothing and returns the same.
  /// @return false if something could not be written
  bool close();

  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;     ///< lines written
  [[nodiscard]] std::int64_t unsupported() const;  ///< pairs that were not written

 private:
  std::unique_ptr<detail::DartRecord> record_;
};

}  // namespace pd
