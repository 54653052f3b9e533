/// @file
/// Compounds of compounds, as compounds whose children are not.
///
/// URDF importers make a compound of a link, and a compound of hulls of each of its meshes. The rule for covered
/// contacts and the choice of points look at the children of one compound, so that the hulls of a nested one are taken
/// as children of the whole.
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <unordered_map>
#include <vector>

namespace pd::detail {

/// The children of a compound, those of its compounds in place of them, where they stand in the whole.
class FlatCompound final : public btCompoundShape {
 public:
  explicit FlatCompound(const btCompoundShape& source);

  /// True if the source still has these children in these places. Places and boxes are compared once a step: `stamp` as
  /// in `BulletShapeCache::find`. Addresses are compared each time. Requires the address of a living compound.
  [[nodiscard]] bool is_of(const btCompoundShape& source, std::uint64_t stamp) const;
  /// Returns the number that a child has in the compound that holds it, which is what Bullet tells hosts.
  [[nodiscard]] int number_in_its_compound(int child) const { return numbers_[static_cast<std::size_t>(child)]; }

 private:
  const btCompoundShape* source_;
  std::vector<int> numbers_;
  mutable std::atomic<std::uint64_t> compared_{0};  ///< the stamp under which it was found current
};

/// A pair's memory of the compound of one of its bodies.
struct FlatMemory {
  const btCompoundShape* plain = nullptr;  ///< a compound that holds no compound
  int revision = 0;                        ///< of it, by Bullet's count
  std::shared_ptr<const FlatCompound> flat;
};

/// The flat forms of a world's nested compounds. Safe from any number of threads.
class FlatCompounds {
 public:
  /// Returns the compound itself if none of its children is a compound, else its flat form, which lives as long as
  /// `memory` keeps it. Time O(1) for a compound that is known to hold none, else O(children) once a step.
  [[nodiscard]] const btCompoundShape& flat(const btCompoundShape& compound, std::uint64_t stamp, FlatMemory& memory);

 private:
  [[nodiscard]] std::shared_ptr<const FlatCompound> find(const btCompoundShape& compound, std::uint64_t stamp);

  std::shared_mutex mutex_;
  std::unordered_map<const btCompoundShape*, std::shared_ptr<const FlatCompound>> known_;
  std::size_t most_ = 256;  ///< forms without a pair are dropped beyond it
};

}  // namespace pd::detail
