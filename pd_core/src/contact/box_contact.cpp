#include "pd/contact/box_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "contact/manifold_clip.hpp"
#include "contact/manifold_reduce.hpp"
#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/facets/box_pair.hpp"
#include "depth/pair/double_answer.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd {

namespace {

using detail::BoxDistance;
using detail::BoxFoot;
using detail::BoxGenerators;
using detail::IdKind;
using detail::make_id;
using detail::Vec2;

/// Four corners cut by four lines have eight corners at most.
constexpr int kMostCorners = 8;
/// And the witness.
constexpr int kMostPoints = kMostCorners + 1;

/// A corner of the cut face in the other face's own coordinates, which run from -1 to 1 along its two edges.
struct Corner {
  double s, t;
  std::int64_t id;
  std::int32_t edge;  ///< that leaves the corner, by the vertex of its box that it starts at
  bool edge_of_b;
};

struct Corners {
  Corner at[kMostCorners];
  int count;
};

/// A contact point to be.
struct Candidate {
  double s, t, depth;
  std::int64_t id;
};

/// A face of a box: its middle, its two half edges and the vertices at its corners, counter-clockwise about the contact
/// normal from the one at minus both half edges.
struct BoxFace {
  Vec3 centre;
  Vec3 first, second;
  double length_first, length_second;
  std::int32_t ids[4];
};

/// What lies to the left of a line of the window.
/// @param side  > 0 to the left.
template <class Side>
void cut(const Corners& from, Side&& side, std::int32_t edge, Corners& out) {
  out.count = 0;
  double side_here = side(from.at[0]);
  for (int i = 0; i < from.count; ++i) {
    const Corner& here = from.at[i];
    const Corner& next = from.at[i + 1 < from.count ? i + 1 : 0];
    const double side_next = side(next);
    if (side_here >= 0) out.at[out.count++] = here;
    if ((side_here > 0 && side_next < 0) || (side_here < 0 && side_next > 0)) {
      const double w = side_here / (side_here - side_next);
      // Two edges of the window meet where the later one starts.
      const std::int64_t id = here.edge_of_b ? make_id(IdKind::vertex_b, 0, side_here > 0 ? edge : here.edge)
                                             : make_id(IdKind::crossing, here.edge, edge);
      const bool leaves = side_here > 0;
      out.at[out.count++] = {here.s + w * (next.s - here.s), here.t + w * (next.t - here.t), id,
                             leaves ? edge : here.edge, leaves || here.edge_of_b};
    } else if (side_here == 0 && side_next < 0 && out.count > 0) {
      out.at[out.count - 1].edge = edge;
      out.at[out.count - 1].edge_of_b = true;
    }
    side_here = side_next;
  }
}

class BoxContactQuery : detail::BoxPair {
 public:
  BoxContactQuery(const PosedBox& a, const PosedBox& b, const detail::BoxFrame& frame_a,
                  const detail::BoxFrame& frame_b)
      : BoxPair(frame_a, *a.pose, frame_a.half_extents.norm() * kRounded, frame_b, *b.pose,
                frame_b.half_extents.norm() * kRounded),
        half_a_(a.half_extents),
        half_b_(b.half_extents),
        origin_(a.pose->translation()) {}

  void solve(double tolerance, double breaking_threshold, BoxWitness witness, BoxContact& out) {
    if (!(reach_ > 0x1p-100 && reach_ < 0x1p100 && half_a_.minCoeff() > 0x1p-100 && half_b_.minCoeff() > 0x1p-100)) {
      return;
    }
    const BoxDistance found = distance();
    out.manifold.normal = found.normal.array() + 0.0;  // no negative zeros
    out.lower = -found.height - found.rounding;
    if (out.lower > breaking_threshold) {
      out.answered = true;
      out.upper = reach_ + slack();  // two centres are points of the boxes
      return;
    }
    const double limit = detail::BracketWidth{detail::kCertifiedWidth, tolerance}.limit(greatest_coordinate());
    if (found.depth > 0 && out.lower < -found.depth - limit) return;
    intersect_faces(found.normal);
    // 0 at the deepest where the class is in doubt.
    const double signed_depth = found.depth > 0 ? -out.lower : out.lower > 0 ? found.height : 0;
    const double size = lift(found.normal, signed_depth, breaking_threshold);
    const double noise = std::max(detail::kNoiseRatio * breaking_threshold, detail::kMergeRatio * size);
    const bool reached = count_ > 0 && deepest_ >= signed_depth - noise;
    // A corner shows how near the boxes are at most; where none is near enough, the foot of the origin does.
    double missed = signed_depth - deepest_;
    BoxFoot at;
    if (!reached || (found.depth <= 0 && missed > limit) || witness == BoxWitness::placed) {
      at = foot(found, 0.125 * limit);
      if (!reached || at.missed < missed) missed = at.missed;
      out.witness_a = at.point_a + origin_;
      out.witness_b = at.point_b + origin_;
    }
    if (found.depth > 0) {
      out.upper = -found.depth;
      out.answered = reached || missed <= std::max(limit, slack());
    } else {
      out.upper = std::abs(found.height) + missed + slack();
      out.answered = out.upper - out.lower <= limit;
    }
    out.contact = out.lower > 0   ? ContactClass::separated
                  : out.upper < 0 ? ContactClass::overlapping
                                  : ContactClass::touching;
    if (out.answered) keep_four(reached ? nullptr : &at, signed_depth, noise, out.manifold);
  }

 private:
  /// The norm of half extents rounds.
  static constexpr double kRounded = 1 + 0x1p-50;

  /// The face that looks along a direction the most; of equals the one across the first axis.
  /// @param turned  of the body that the normal points away from.
  static void face_towards(const BoxGenerators& of, const Mat3& rotation, const Vec3& half, const Vec3& centre,
                           const Vec3& direction, bool turned, BoxFace& out) {
    const Vec3 along = rotation.transpose() * direction;
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(along[k]) > std::abs(along[axis])) axis = k;
    }
    const bool positive = along[axis] > 0;
    const Vec3 up = generator(of, axis);
    out.centre = positive ? Vec3(centre + up) : Vec3(centre - up);
    // The next two axes turn counter-clockwise about this one.
    const int next = axis == 2 ? 0 : axis + 1, last = axis == 0 ? 2 : axis - 1;
    const bool swapped = positive == turned;
    const int first = swapped ? last : next, second = swapped ? next : last;
    out.first = generator(of, first);
    out.second = generator(of, second);
    out.length_first = half[first];
    out.length_second = half[second];
    const std::int32_t base = positive ? bit(axis) : 0;
    out.ids[0] = base;
    out.ids[1] = base | bit(first);
    out.ids[2] = base | bit(first) | bit(second);
    out.ids[3] = base | bit(second);
  }

  /// A's face flattened along the normal on B's, and cut by it.
  void intersect_faces(const Vec3& n) {
    face_towards(of_a_, rotation_a_, half_a_, centre_a_, -n, true, face_a_);
    face_towards(of_b_, rotation_b_, half_b_, centre_b_, n, false, face_b_);
    // x = centre of B's face + s first + t second + h n
    const Vec3 across_first = n.cross(face_b_.first), across_second = face_b_.second.cross(n);
    const double per_area = 1 / face_b_.first.dot(across_second);
    const Vec3 s_of = per_area * across_second, t_of = per_area * across_first;
    const Vec3 from_b = face_a_.centre - face_b_.centre;
    const double s = from_b.dot(s_of), t = from_b.dot(t_of);
    const double s1 = face_a_.first.dot(s_of), t1 = face_a_.first.dot(t_of);
    const double s2 = face_a_.second.dot(s_of), t2 = face_a_.second.dot(t_of);
    polygon_ = &corners_[0];
    polygon_->count = 4;
    const auto corner = [&](int i, int of_face, double at_s, double at_t) {
      const std::int32_t id = face_a_.ids[of_face];
      polygon_->at[i] = {at_s, at_t, make_id(IdKind::vertex_a, id, 0), id, false};
    };
    // As `contact_manifold` does: solvers take points in this order, and under ten iterations a tower of twenty
    // stands 4.4 seconds when the first is at minus the first edge, 3.0 to 4.1 when the loop starts elsewhere.
    corner(0, 1, s + (s1 - s2), t + (t1 - t2));
    corner(1, 2, s + (s1 + s2), t + (t1 + t2));
    corner(2, 3, s - (s1 - s2), t - (t1 - t2));
    corner(3, 0, s - (s1 + s2), t - (t1 + t2));
    const double reach_s = std::abs(s1) + std::abs(s2), reach_t = std::abs(t1) + std::abs(t2);
    const auto cut_unless = [&](int edge, bool inside, auto&& side) {
      if (inside) return;
      Corners* const other = polygon_ == &corners_[0] ? &corners_[1] : &corners_[0];
      if (polygon_->count > 0) cut(*polygon_, side, face_b_.ids[edge], *other);
      if (polygon_->count > 0) polygon_ = other;
    };
    // Along the window's loop.
    cut_unless(0, t - reach_t >= -1, [](const Corner& c) { return 1 + c.t; });
    cut_unless(1, s + reach_s <= 1, [](const Corner& c) { return 1 - c.s; });
    cut_unless(2, t + reach_t <= 1, [](const Corner& c) { return 1 - c.t; });
    cut_unless(3, s - reach_s >= -1, [](const Corner& c) { return 1 + c.s; });
  }

  /// Points of B's face, and how far A's reaches below them along the normal. @return the size of the intersection.
  double lift(const Vec3& n, double signed_depth, double breaking_threshold) {
    deepest_ = -breaking_threshold;
    count_ = 0;
    const Corners& polygon = *polygon_;
    if (polygon.count == 0) return 0;
    double least_s = HUGE_VAL, most_s = -HUGE_VAL, least_t = HUGE_VAL, most_t = -HUGE_VAL;
    for (int i = 0; i < polygon.count; ++i) {
      least_s = std::min(least_s, polygon.at[i].s);
      most_s = std::max(most_s, polygon.at[i].s);
      least_t = std::min(least_t, polygon.at[i].t);
      most_t = std::max(most_t, polygon.at[i].t);
    }
    const double size =
        0.5 * std::max((most_s - least_s) * face_b_.length_first, (most_t - least_t) * face_b_.length_second);
    const double merge_s = detail::kMergeRatio * size / face_b_.length_first;
    const double merge_t = detail::kMergeRatio * size / face_b_.length_second;
    // Depth of A's plane below centre + s first + t second, along n. The plane is that of its edges: columns of a
    // rotation in single precision are at right angles up to 1e-7 only.
    const Vec3 across = face_a_.first.cross(face_a_.second);
    const Vec3 slope = across / across.dot(n);
    const double at_centre = (face_b_.centre - face_a_.centre).dot(slope);
    const double along_s = face_b_.first.dot(slope), along_t = face_b_.second.dot(slope);
    for (int i = 0; i < polygon.count; ++i) {
      const Corner& corner = polygon.at[i];
      // Along n no pair is deeper than the bodies are; what the lifted heights say beyond that is rounding.
      const double depth = std::min(at_centre + corner.s * along_s + corner.t * along_t, signed_depth);
      if (depth < -breaking_threshold || repeated(corner, merge_s, merge_t)) continue;
      candidates_[count_++] = {corner.s, corner.t, depth, corner.id};
      deepest_ = std::max(deepest_, depth);
    }
    return size;
  }

  bool repeated(const Corner& corner, double merge_s, double merge_t) const {
    for (int i = 0; i < count_; ++i) {
      if (std::abs(candidates_[i].s - corner.s) <= merge_s && std::abs(candidates_[i].t - corner.t) <= merge_t) {
        return true;
      }
    }
    return false;
  }

  /// @param witness  joins the corners where they are not as deep as the boxes, else nullptr.
  void keep_four(const BoxFoot* witness, double signed_depth, double noise, ContactManifold& manifold) {
    const Vec3& n = manifold.normal;
    const int corners = count_;
    const auto is_witness = [](const Candidate& c) { return c.id == make_id(IdKind::witness, 0, 0); };
    if (witness) candidates_[count_++] = {0, 0, signed_depth, make_id(IdKind::witness, 0, 0)};
    const auto place = [&](const Candidate& c) {
      return is_witness(c) ? witness->point_b : Vec3(face_b_.centre + c.s * face_b_.first + c.t * face_b_.second);
    };
    if (count_ > 4) {
      const detail::ContactFrame frame(n, face_b_.centre);
      Vec2 flat[kMostPoints];
      for (int i = 0; i < count_; ++i) flat[i] = frame.flatten(place(candidates_[i]));
      const std::span<Candidate> points(candidates_, static_cast<std::size_t>(count_));
      const std::span<Vec2> places(flat, static_cast<std::size_t>(count_));
      const std::size_t first =
          witness ? static_cast<std::size_t>(corners)
                  : detail::deepest_point(std::span<const Candidate>(points), places, deepest_, noise);
      detail::reduce_to_four(points, places, first);
      count_ = 4;
    }
    manifold.count = count_;
    for (int i = 0; i < count_; ++i) {
      const Candidate& c = candidates_[i];
      const Vec3 on_b = place(c) + origin_;
      manifold.points[static_cast<std::size_t>(i)] = {on_b - c.depth * n, on_b, c.depth, c.id};
    }
  }

  const Vec3& half_a_;
  const Vec3& half_b_;
  const Vec3& origin_;
  BoxFace face_a_, face_b_;
  Corners corners_[2];
  Corners* polygon_ = nullptr;  ///< one of them: the intersection
  Candidate candidates_[kMostPoints];
  int count_ = 0;
  double deepest_ = 0;
};

}  // namespace

BoxContact box_contact(const PosedBox& a, const PosedBox& b, double tolerance, double breaking_threshold,
                       BoxWitness witness) {
  const detail::FloatingPointGuard guard;
  BoxContact out;
  const detail::BoxFrame frame_a{Vec3::Zero(), a.half_extents}, frame_b{Vec3::Zero(), b.half_extents};
  BoxContactQuery(a, b, frame_a, frame_b).solve(tolerance, breaking_threshold, witness, out);
  return out;
}

PenetrationDepth depth_of(const BoxContact& contact) {
  PenetrationDepth out;
  out.method = Method::overlay;
  out.normal = contact.manifold.normal;
  out.witness_a = contact.witness_a;
  out.witness_b = contact.witness_b;
  detail::set_signed_distance(0, contact.lower, contact.upper, out);
  return out;
}

}  // namespace pd
