/// @file
/// Writes what an engine says of a pair into a contact record, for the recorders of all doors.
#pragma once

#include <cstddef>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/record/pd_record.h"

namespace pd::detail {

/// One point of a contact, as the record takes it.
struct RecordedPoint {
  Vec3 on_a, on_b;
  double depth;
  Vec3 normal;  ///< unit, from B to A
};

/// A shape of the record at its pose.
struct RecordedBody {
  const char* id;
  pd_record_pose pose;
};

/// Writes the line of a pair: its deepest point with the normal, and then all points; no points: apart.
inline void record_pair(pd_record& record, const RecordedBody& a, const RecordedBody& b,
                        const std::vector<RecordedPoint>& points) {
  if (points.empty()) {
    pd_record_contact(&record, a.id, &a.pose, b.id, &b.pose, nullptr);
    return;
  }
  const RecordedPoint* deepest = &points.front();
  std::vector<pd_record_point> written;
  for (const RecordedPoint& point : points) {
    written.push_back({point.on_a.data(), point.on_b.data(), point.depth});
    if (point.depth > deepest->depth) deepest = &point;
  }
  const pd_record_report report{deepest->depth, deepest->normal.data(), written.data(), written.size()};
  pd_record_contact(&record, a.id, &a.pose, b.id, &b.pose, &report);
}

}  // namespace pd::detail
