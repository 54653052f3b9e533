/// @file
/// The record that a recorder of ODE's contacts writes.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "kept_bodies.hpp"
#include "pair_record.hpp"

namespace pd::detail {

class OdeRecord {
 public:
  explicit OdeRecord(const char* path);

  /// Writes the line of a pair, as `dCollide` has answered it.
  void write(dGeomID first, dGeomID second, dContactGeom* contacts, int skip, int count);
  void set_time(double seconds);
  bool close();

  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;
  [[nodiscard]] std::int64_t unsupported() const;

 private:
  /// The geom's shape, written if it is new, at its pose; nothing if it has none.
  struct Known {
    std::string id;
    pd_record_pose pose;
  };
  std::optional<Known> known(dGeomID geom);
  std::optional<Known> known_plane(dGeomID geom);
  /// The id of the shape that these numbers describe, and true if it is new.
  std::pair<std::string, bool> id_of(std::vector<double> numbers);

  mutable std::mutex mutex_;  ///< guards what follows
  pd_record record_{};
  bool good_ = false;
  KeptBodies bodies_;
  std::map<std::vector<double>, std::string> written_;  ///< ids by numbers
  std::int64_t unsupported_ = 0;
};

}  // namespace pd::detail
