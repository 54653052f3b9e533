/// @file
/// What the bench asks of Jolt, in plain numbers: Jolt's headers are compiled with instruction sets of their own, and
/// no inline function of ours may be compiled with them. Single precision; lengths in the unit of the input.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pd::bench {

/// A body about the origin of its frame. Cylinders, capsules and cones stand along y, a cone's apex at +half_height.
struct JoltBody {
  enum class Kind : std::uint8_t { hull, box, sphere, capsule, cylinder, cone, ellipsoid };
  Kind kind = Kind::hull;
  std::vector<std::array<float, 3>> vertices;  ///< of a hull
  std::array<float, 3> radii{};                ///< of an ellipsoid; half extents of a box
  float radius = 0;
  float half_height = 0;  ///< of a capsule: of its core
};

struct JoltAnswer {
  bool overlapping = false;
  bool farther = false;         ///< than the limit; `from_a` is then along a separating axis, of any length
  std::array<float, 3> a{};     ///< on A, in A's frame
  std::array<float, 3> b{};     ///< on B, in A's frame
  std::array<float, 3> axis{};  ///< from A to B where they are apart
};

/// Two bodies and the calls that are timed.
class JoltPair {
 public:
  virtual ~JoltPair() = default;
  /// B in A's frame: a rotation by columns, and a translation.
  virtual void stand(const std::array<float, 9>& columns, const std::array<float, 3>& translation) = 0;
  /// GJK, then the expanding polytope where the cores overlap; tolerances 1e-5.
  [[nodiscard]] virtual JoltAnswer depth() = 0;
  /// GJK alone, up to a limit; starts from the axis of the last call if `warm`.
  [[nodiscard]] virtual JoltAnswer distance(float limit, bool warm) = 0;
};

/// "5.5.1"
[[nodiscard]] std::string jolt_version();

/// @param wide  two hulls by a scan of ours over their vertices instead of Jolt's
[[nodiscard]] std::unique_ptr<JoltPair> make_jolt_pair(const JoltBody& a, const JoltBody& b, bool wide);

}  // namespace pd::bench
