/// @file
/// Pairs of DART's objects, asked of the core or of DART's FCL detector.
#pragma once

#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionOption.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/DistanceOption.hpp>
#include <dart/collision/DistanceResult.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dart_object.hpp"
#include "pair_points.hpp"

namespace pd::detail {

/// The least signed distance of two objects, and their closest points, or two points whose difference moves the first
/// out of the second.
struct PairDistance {
  double signed_distance = 0;
  Vec3 on_first = Vec3::Zero(), on_second = Vec3::Zero();
};

/// The buffers and counts of one detector.
class DartQueries {
 public:
  explicit DartQueries(const DartOptions& options);

  /// Adds the contacts of a pair to a vector, the deepest first. @param points  false: one contact without numbers
  void collide(DartObject& first, DartObject& second, bool points, std::vector<dart::collision::Contact>& contacts);
  /// @param points  false: `on_first` and `on_second` stay unset for planes
  /// @return false for pairs that have no distance: two planes, or those of FCL that find none
  bool distance(DartObject& first, DartObject& second, bool points, PairDistance& found);

  void forget(const DartObject& object) { groups_of_fcl_.erase(&object); }
  [[nodiscard]] const DartOptions& options() const { return options_; }
  [[nodiscard]] const DartReport& report() const { return report_; }

 private:
  /// Counts and names the refusal of a pair. @return false if pdepth answers
  bool left_to_fcl(const DartObject& first, const DartObject& second);
  const ContactManifold& points_of(const DartObject& first, const DartObject& second);
  dart::collision::CollisionGroup& group_of_fcl(const DartObject& object);
  void collide_by_fcl(DartObject& first, DartObject& second, bool points,
                      std::vector<dart::collision::Contact>& contacts);
  bool distance_by_fcl(DartObject& first, DartObject& second, PairDistance& found);
  void on_ground(const DartObject& body, const DartObject& plane, bool points, PairDistance& found);

  DartOptions options_;
  DartReport report_;
  PairPoints pairs_;
  ContactManifold points_;
  Scratch scratch_;
  ManifoldScratch manifold_;
  std::shared_ptr<dart::collision::CollisionDetector> fcl_;
  std::map<const DartObject*, std::unique_ptr<dart::collision::CollisionGroup>> groups_of_fcl_;
};

}  // namespace pd::detail
