#include "depth/facets/gauss_sat_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd::detail {

namespace {

/// The rotation of a pose by rows, and a box's half extents.
struct StoredRows {
  double x[4], y[4], z[4], half_extents[4];

  StoredRows(const Mat3& rotation, const Vec3& half) {
    for (int k = 0; k < 3; ++k) {
      x[k] = rotation(0, k);
      y[k] = rotation(1, k);
      z[k] = rotation(2, k);
      half_extents[k] = half[k];
    }
    x[3] = y[3] = z[3] = half_extents[3] = 0;
  }
  [[nodiscard]] BoxRows rows() const { return {x, y, z, half_extents}; }
};

double signed_root(double key) { return std::copysign(std::sqrt(std::abs(key)), key); }

class BoxesQuery {
 public:
  BoxesQuery(const BoxBody& a, const BoxBody& b)
      : a_(a),
        b_(b),
        stored_a_(a.pose.rotation(), a.frame.half_extents),
        stored_b_(b.pose.rotation(), b.frame.half_extents),
        centre_a_(a.pose.rotation() * a.frame.centre),
        boxes_{stored_a_.rows(), stored_b_.rows(), {}, 0} {
    const Vec3 offset = b.pose.translation() - a.pose.translation();
    centre_ = b.pose.rotation() * b.frame.centre + offset - centre_a_;
    for (int i = 0; i < 3; ++i) boxes_.centre[i] = centre_[i];
    boxes_.reach = a.polytope.radius() + b.polytope.radius() + offset.norm();
  }

  GaussSatDepth solve(const BracketWidth& width, BoxQuestion question, NearGaussPieces* near) {
    GaussSatDepth out;
    NearFacets& nearest = out.nearest;
    if (question != BoxQuestion::signed_depth && apart_along_centres()) {
      out.status = GaussSatStatus::separated;
      nearest.normal = -centre_.normalized();
      nearest.kind = NearFacetsBuffers::Kind::facet_of_a;
      out.corner = farthest_along(nearest.normal);
      return out;
    }
    const BoxDistance found = distance_of_boxes(boxes_);
    nearest.facets = kBoxAxes;
    nearest.normal = found.normal;
    nearest.upper = found.height + found.rounding;
    if (question != BoxQuestion::signed_depth) {
      if (nearest.upper < 0) out.status = GaussSatStatus::separated;
      if (!(found.depth > 0)) {
        name(found, farthest_along(found.normal), out);
        return out;
      }
    }
    if (question == BoxQuestion::near_pieces) {
      name(found, farthest_along(found.normal), out);
      list_near(found, *near, nearest);
    } else {
      certify(found, width, question, out);
    }
    return out;
  }

 private:
  /// Tells whether the line of centres separates the boxes, which it does for most boxes that are far apart, sooner
  /// than fifteen axes. Rounding decides nothing here: the distance is searched for, and a search that finds none
  /// leaves the pair to others.
  [[nodiscard]] bool apart_along_centres() const {
    // P holds a ball about its centre as large as those in the boxes.
    const double inner = a_.frame.half_extents.minCoeff() + b_.frame.half_extents.minCoeff();
    if (centre_.squaredNorm() < inner * inner) return false;
    return boxes_.height_along(centre_) < centre_.squaredNorm();
  }

  [[nodiscard]] VertexPair farthest_along(const Vec3& normal) const {
    return {farthest_of_box(boxes_.a, normal, -1), farthest_of_box(boxes_.b, normal, 1)};
  }

  /// Names the winner by its features.
  void name(const BoxDistance& found, const VertexPair& corner, GaussSatDepth& out) const {
    const GaussPiece piece = piece_of(BoxAxis(found.axis), found.normal, corner);
    out.corner = {piece.a[0], piece.b[0]};
    name_piece(piece, {Vec3::Zero(), piece.a[0], piece.b[0]}, out.nearest);
  }

  /// Returns the facet of P that lies across an axis.
  /// @param normal  unit, outward
  /// @param corner  the vertices farthest along the normal
  [[nodiscard]] GaussPiece piece_of(BoxAxis axis, const Vec3& normal, const VertexPair& corner) const {
    const auto [va, vb] = corner;
    GaussPiece out{-1, -1, {static_cast<std::int8_t>(va), 0}, {static_cast<std::int8_t>(vb), 0}};
    const int place = bit_of_box_axis(axis.across());
    if (axis.block == 0)
      out.facet_a = static_cast<std::int8_t>(facet_of_box(a_.polytope, axis.across(), (va & place) != 0));
    if (axis.block == 1)
      out.facet_b = static_cast<std::int8_t>(facet_of_box(b_.polytope, axis.across(), (vb & place) != 0));
    if (!axis.is_of_edges()) return out;
    const int of_a = bit_of_box_axis(axis.block - 2), of_b = bit_of_box_axis(axis.lane);
    const bool outwards = normal.dot(boxes_.normal_of(axis)) < 0;  // (edge of B) x (edge of A)
    out.a[outwards ? 0 : 1] = static_cast<std::int8_t>(va & ~of_a);
    out.a[outwards ? 1 : 0] = static_cast<std::int8_t>(va | of_a);
    out.b[0] = static_cast<std::int8_t>(vb & ~of_b);
    out.b[1] = static_cast<std::int8_t>(vb | of_b);
    return out;
  }

  void certify(const BoxDistance& found, const BracketWidth& width, BoxQuestion question, GaussSatDepth& out) const {
    NearFacets& nearest = out.nearest;
    const double limit = width.limit(boxes_.greatest_coordinate()), slack = boxes_.slack();
    const FootPoints foot = foot_of_boxes(boxes_, centre_a_, found, 0.125 * limit);
    name(found, foot.farthest, out);
    nearest.lower = found.depth;
    if (found.depth > 0) {
      if (!(foot.missed <= std::max(width.length, slack))) return;
      if (nearest.upper - nearest.lower > limit) {
        // Two points by six steps each err by 6u of the reach more than half edges and centre do, what they miss by
        // 3u, and the foot's length by 4u.
        const double foot_rounding = 28 * kUnitRoundoff * boxes_.reach;
        nearest.lower = lower_beside_foot(found, found.height - foot.missed - foot_rounding) - found.slivers;
      }
      if (!(nearest.lower > 0)) return;
    } else {
      nearest.lower = -(std::abs(found.height) + foot.missed + slack);
    }
    if (nearest.upper - nearest.lower <= limit) {
      nearest.certified = true;
      out.status = GaussSatStatus::certified;
      out.foot = foot;
    } else if (question == BoxQuestion::signed_depth && nearest.upper < 0) {
      out.status = GaussSatStatus::separated;
    }
  }

  /// Edges of flush faces cross along the faces' own normal, and those turned by little against each other know it
  /// badly. But if a point of P lies as far along the normal as `foot_lower`, every plane that is turned by a small
  /// angle is at least that times the cosine away. So is the plane on P's other side, if P's centre is certain to lie
  /// behind the turned plane: the other one is then farther.
  [[nodiscard]] double lower_beside_foot(const BoxDistance& found, double foot_lower) const {
    constexpr double kSmallAngle = 0x1p-28;  // its cosine rounds to 1
    double lower = foot_lower * (1 - kUnitRoundoff);
    for (int slot = 0; slot < kBoxAxisSlots; ++slot) {
      const double of_axis = signed_root(found.lower_keys[slot]) - box_rounding(boxes_.reach);
      if (!(of_axis < lower)) continue;
      const Vec3 n = boxes_.normal_of(BoxAxis(slot));
      // The axes' own lengths may exceed 1 a little.
      const double turn = (1 + 0x1p-17) * kBoxTurn / n.norm();
      const Vec3 m = boxes_.outward(n);
      const bool sided = -m.dot(centre_) >= 2 * turn * centre_.norm() + 16 * kUnitRoundoff * boxes_.reach;
      if (sided && m.dot(found.normal) > 0 && m.cross(found.normal).norm() + 2 * turn < kSmallAngle) continue;
      lower = of_axis;
    }
    return lower;
  }

  /// Lists the facets of P that may be nearest. The list is empty if the class is in doubt.
  void list_near(const BoxDistance& found, NearGaussPieces& near, NearFacets& nearest) const {
    near.count = 0;
    near.parallel = 0;
    near.all_told = true;
    near.beyond = std::numeric_limits<double>::infinity();
    const double upper = nearest.upper, farther = (upper + box_rounding(boxes_.reach)) * (1 + 0x1p-50);
    bool listed = add_near(found, found.axis, upper, near);
    for (int slot = 0; slot < kBoxAxisSlots && listed; ++slot) {
      const BoxAxis axis(slot);
      if (axis.lane == 3 || slot == found.axis) continue;
      const double key = found.lower_keys[slot];
      if (!(key < std::numeric_limits<double>::infinity())) {
        listed = axis.is_of_edges();
        if (listed && !slivers_lie_far(axis, found, farther)) near.parallel |= 1U << (3 * (axis.block - 2) + axis.lane);
      } else if (key > farther * farther) {
        near.beyond = std::min(near.beyond, upper);
      } else {
        listed = add_near(found, slot, upper, near);
      }
    }
    if (!listed) near.count = 0;
    if (near.count == 1) nearest.beyond = near.beyond;
  }

  /// Edges that are parallel up to rounding but not exactly span slivers, no wider than that rounding. Along each long
  /// side lies a facet that one of the two edges spans with another one. If all of those lie far, the slivers do.
  [[nodiscard]] bool slivers_lie_far(BoxAxis of, const BoxDistance& found, double limit) const {
    const double least = limit + boxes_.slack();
    for (int slot = 0; slot < kBoxAxisSlots; ++slot) {
      const BoxAxis axis(slot);
      const bool beside = (axis.flat_a() & of.flat_a()) != 0 || (axis.flat_b() & of.flat_b()) != 0;
      if (axis.lane == 3 || (axis.block == of.block && axis.lane == of.lane) || !beside) continue;
      const double key = found.lower_keys[slot];
      if (!(key > least * least && key < std::numeric_limits<double>::infinity())) return false;
    }
    return true;
  }

  /// Adds the two facets of an axis, but those certainly farther than `upper`. False where the origin may lie beyond
  /// one of them.
  bool add_near(const BoxDistance& found, int slot, double upper, NearGaussPieces& near) const {
    const double rounding = box_rounding(boxes_.reach);
    const double lower = signed_root(found.lower_keys[slot]) - rounding;
    if (!(lower > 0)) return false;
    const BoxAxis axis(slot);
    const Vec3 n = boxes_.outward(boxes_.normal_of(axis));
    near.add(lower * lower, piece_of(axis, n, farthest_along(n)));
    // The other side lies farther by twice the height of P's centre.
    const double along_centre = std::abs(n.dot(centre_));
    const double height = boxes_.height_along(n) - along_centre;
    if (lower + 2 * (along_centre - (height + rounding - lower)) > upper) {
      near.beyond = std::min(near.beyond, upper);
    } else {
      near.add(lower * lower, piece_of(axis, -n, farthest_along(-n)));
    }
    return true;
  }

  const BoxBody& a_;
  const BoxBody& b_;
  const StoredRows stored_a_, stored_b_;
  const Vec3 centre_a_;  ///< relative to A's translation
  PosedBoxes boxes_;
  Vec3 centre_;  ///< of P
};

}  // namespace

GaussSatDepth gauss_sat_of_boxes(const BoxBody& a, const BoxBody& b, const BracketWidth& width, BoxQuestion question,
                                 NearGaussPieces* near) {
  return BoxesQuery(a, b).solve(width, question, near);
}

}  // namespace pd::detail
