#include "covered_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lazy_points.hpp"
#include "moving_body.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// A normal nearer to a facet's than this (1 - cosine, about 1e-5 rad) is that facet's.
constexpr double kSameNormal = 1e-10;
/// cos 25 degrees: what is turned to a facet's own normal without asking whether that is far.
constexpr double kNearNormal = 0.9;
/// A sine that is more than kDecided also where it was found another way.
constexpr double kLedOn = (1 + 1e-6) * kDecided;
/// From so many on, what a facet inside of them is known for spares a search.
constexpr int kManyChildren = 4;
/// Facets tried in place of a covered one.
constexpr int kTries = 4;

/// One of the pair's two bodies as a piece of its union, and the other that touches it.
struct Side {
  const btCollisionObjectWrapper& wrapper;
  PosedShape own;
  PosedShape other;
  bool is_b;
  Vec3 front = Vec3::Zero();  ///< the only side of a triangle, zero: both
  /// From the piece outward, for the answer's normal.
  [[nodiscard]] Vec3 outward(const Vec3& normal) const { return is_b ? normal : Vec3(-normal); }
  [[nodiscard]] const Vec3& on_piece(const ContactPoint& point) const {
    return is_b ? point.position_b : point.position_a;
  }
};

bool is_flat(const PosedShape& body) {
  const ConvexPolytope* polytope = body.shape->polytope();
  return polytope != nullptr && polytope->affine_dimension() == 2;
}

/// Least <x, n> over a core.
Vec3 farthest_against(const PosedShape& shape, const Vec3& n) {
  if (const ConvexPolytope* polytope = shape.shape->polytope()) {
    const Vec3 local = shape.pose.rotation().transpose() * n;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      const double value = polytope->vertex(v).dot(local);
      if (value < least) {
        least = value;
        best = v;
      }
    }
    return shape.pose.apply(polytope->vertex(best));
  }
  const Mat3 rotation = shape.pose.nearest_rotation();
  const Vec3 way = -(rotation.transpose() * n);
  const auto round = [&](int axis, double radius) {
    Vec3 radial = way;
    radial[axis] = 0;
    const double length = radial.norm();
    return length > 0 ? Vec3(radius / length * radial) : Vec3(Vec3::Zero());
  };
  Vec3 local;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.shape->core())) {
    local = round(cylinder->axis, cylinder->radius);
    local[cylinder->axis] = way[cylinder->axis] > 0 ? cylinder->half_height : -cylinder->half_height;
  } else if (const auto* cone = std::get_if<Cone>(&shape.shape->core())) {
    local = round(cone->axis, cone->radius);
    local[cone->axis] = -cone->half_height;
    const Vec3 apex = cone->half_height * Vec3::Unit(cone->axis);
    if (apex.dot(way) > local.dot(way)) local = apex;
  } else if (const auto* spheres = std::get_if<SphereHull>(&shape.shape->core())) {
    local = spheres->support(way);
  } else {
    const Vec3& radii = std::get<Ellipsoid>(shape.shape->core()).radii;
    local = radii.cwiseProduct(radii.cwiseProduct(way)) / radii.cwiseProduct(way).norm();
  }
  return rotation * local + shape.pose.translation();
}

class Cover {
 public:
  Cover(const Side& side, double slack, double window, std::uint64_t stamp, SolverCore& core, CoverBuffers& buffers)
      : wrapper_(side.wrapper),
        own_(side.own),
        slack_(slack),
        window_(window),
        stamp_(stamp),
        core_(core),
        buffers_(buffers) {}

  /// Whether the piece is one of many children of a body's compound.
  [[nodiscard]] bool of_many() const {
    const btCollisionObjectWrapper* parent = wrapper_.m_parent;
    return parent != nullptr && parent->m_parent == nullptr && parent->getCollisionShape()->isCompound() &&
           static_cast<const btCompoundShape*>(parent->getCollisionShape())->getNumChildShapes() > kManyChildren;
  }

  /// Sets the piece at hand: one that is kept, or made anew.
  void take_own() {
    UnionPiece* const kept = buffers_.near.kept(wrapper_, core_);
    const bool known = kept != nullptr && !kept->planes.empty();
    buffers_.own = known ? kept : &buffers_.made;
    if (!known) set_piece(own_, buffers_.made);
  }

  /// Collects what is near the contact: only what could cover its feature against n, or (n zero) all.
  /// @return whether there is anything
  bool look_round(const Vec3& foot, double margin, const Vec3& n) {
    // The corners of the window's square are farther than its sides; so are flush surfaces of other margins.
    const double reach = 1.5 * window_ + slack_;
    const Beyond beyond{n, n.dot(foot) + margin + 2 * slack_};
    buffers_.near.forget_made();
    buffers_.near.find(wrapper_, foot, reach, slack_, n.isZero(0) ? nullptr : &beyond, stamp_, core_, buffers_.found);
    return !buffers_.found.empty();
  }

  /// How far beyond doubt the feature of the piece at `foot` (on its core) that faces n is covered: the least sine over
  /// the corners of its part within the window, kBeyondDoubt where it is more; -1 where one is free. Of a facet, no
  /// more is found out than whether it is kDecided.
  double covered(Vec3 foot, const Vec3& n) {
    const Touched touched = touched_at(foot, n);
    if (!touched.any) return -1;
    double least = kBeyondDoubt;
    if (touched.facet < 0) {
      least = std::min(least, most_covered(foot, n, least));
      if (least <= 0) return least;
    }
    set_feature(touched, foot, n);
    if (buffers_.feature.empty() && touched.facet >= 0) return -1;
    for (const Vec3& corner : buffers_.feature) {
      least = std::min(least, most_covered(corner, n, least));
      if (least <= (touched.facet >= 0 ? kDecided : 0)) break;
    }
    return least;
  }

  /// Whether the feature of the triangle at hand at `foot` is covered beyond doubt by the triangle next to it.
  [[nodiscard]] bool led_on_by_neighbour(const Vec3& foot, const Vec3& n) const {
    return buffers_.near.neighbour_leads_on(*buffers_.own, foot, n, kLedOn, 2 * slack_);
  }

  /// Whether one other piece covers all of the piece's facet: so it covers every part of it.
  [[nodiscard]] bool is_sealed(std::size_t facet) const {
    if (buffers_.own == &buffers_.made || !of_many()) return false;
    return buffers_.near.facts().sealed(static_cast<const btCompoundShape&>(*wrapper_.m_parent->getCollisionShape()),
                                        wrapper_.m_index, facet, core_);
  }

 private:
  /// What of the piece touches a point.
  struct Touched {
    bool any = false;
    int facet = -1;  ///< that of the normal asked for
    const Plane* first = nullptr;
    const Plane* second = nullptr;
    int count = 0;
  };

  /// The largest sine of all pieces near at a point of this one's core, or one that is enough.
  double most_covered(const Vec3& point, const Vec3& n, double enough) {
    double most = -1;
    for (const UnionPiece* near : buffers_.found) {
      if (most >= enough) break;
      const UnionPiece& piece = *near;
      // Surfaces lie flush, not cores, where margins differ.
      const Vec3 level = point + (buffers_.own->margin - piece.margin) * n;
      most = std::max(most, covered_sine(piece, level, n, slack_, enough, buffers_.active));
    }
    return most;
  }

  /// @param foot  moved into the piece, and on the facet if there is one
  Touched touched_at(Vec3& foot, const Vec3& n) const {
    const std::vector<Plane>& planes = buffers_.own->planes;
    Touched touched;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const Plane& plane = planes[i];
      const double height = plane.height(foot);
      if (height > 2 * slack_) return {};
      // The edges of a triangle are no facets.
      if (!buffers_.own->flat && plane.normal.dot(n) >= 1 - kSameNormal) touched.facet = static_cast<int>(i);
      if (height < -2 * slack_) continue;
      if (touched.count == 0) touched.first = &plane;
      if (touched.count == 1) touched.second = &plane;
      ++touched.count;
    }
    touched.any = true;
    for (const Plane& plane : planes) foot -= std::max(plane.height(foot), 0.0) * plane.normal;
    if (touched.facet >= 0) {
      const Plane& facet = planes[static_cast<std::size_t>(touched.facet)];
      foot -= facet.height(foot) * facet.normal;
    }
    return touched;
  }

  /// The part of the feature within the window, by its corners. They lie in the piece up to half the slack, so that a
  /// flush neighbour holds them.
  void set_feature(const Touched& touched, const Vec3& foot, const Vec3& n) {
    std::vector<Vec3>& feature = buffers_.feature;
    feature.clear();
    const bool flat = buffers_.own->flat;
    if (touched.facet >= 0) {
      const Vec3 u = n.unitOrthogonal() * window_;
      const Vec3 w = n.cross(u);
      feature = {foot + u + w, foot - u + w, foot - u - w, foot + u - w};
      clip_to_piece(*buffers_.own, 0.5 * slack_, feature, buffers_.spare);
      return;
    }
    // Of a triangle, its two sides and one edge; of a solid, two facets.
    if (touched.count != (flat ? 3 : 2)) return;
    const Plane* second = flat ? edge_of_triangle(foot) : touched.second;
    Vec3 along = second != nullptr ? Vec3(touched.first->normal.cross(second->normal)) : Vec3(Vec3::Zero());
    if (along.norm() <= kLevel) return;
    along *= window_ / along.norm();
    feature = {foot - along, foot + along};
    clip_to_piece(*buffers_.own, 0.5 * slack_, feature, buffers_.spare);
  }

  const Plane* edge_of_triangle(const Vec3& foot) const {
    const std::vector<Plane>& planes = buffers_.own->planes;
    for (std::size_t i = 2; i < planes.size(); ++i) {
      if (planes[i].height(foot) >= -2 * slack_) return &planes[i];
    }
    return nullptr;
  }

  const btCollisionObjectWrapper& wrapper_;
  const PosedShape& own_;
  double slack_;
  double window_;
  std::uint64_t stamp_;
  SolverCore& core_;
  CoverBuffers& buffers_;
};

void drop(ContactManifold& points, int i) {
  --points.count;
  points.points[static_cast<std::size_t>(i)] = points.points[static_cast<std::size_t>(points.count)];
}

/// The manifold along one facet of the piece, of points that lie on it.
ContactManifold along_facet(const Side& side, const Plane& facet, double depth, const Vec3& farthest, double threshold,
                            double slack, const UnionPiece& own, ManifoldScratch& scratch) {
  PenetrationDepth answer;
  answer.contact = depth > 0 ? ContactClass::overlapping : ContactClass::separated;
  answer.depth = std::max(depth, 0.0);
  answer.distance = std::max(-depth, 0.0);
  answer.normal = side.is_b ? facet.normal : Vec3(-facet.normal);
  const Vec3 on_other = farthest - side.other.shape->margin() * facet.normal;
  const Vec3 on_own = on_other + depth * facet.normal;
  answer.witness_a = side.is_b ? on_other : on_own;
  answer.witness_b = side.is_b ? on_own : on_other;
  ContactManifold points =
      side.is_b ? contact_manifold(side.other, side.own, answer, threshold, scratch, DeepestPoint::as_lifted)
                : contact_manifold(side.own, side.other, answer, threshold, scratch, DeepestPoint::as_lifted);
  for (int i = points.count - 1; i >= 0; --i) {
    const Vec3 foot = side.on_piece(points.points[static_cast<std::size_t>(i)]) - own.margin * facet.normal;
    const bool outside = std::any_of(own.planes.begin(), own.planes.end(),
                                     [&](const Plane& plane) { return plane.height(foot) > 2 * slack; });
    if (outside) drop(points, i);
  }
  return points;
}

/// What one side's piece does to the manifold.
class SideRule {
 public:
  SideRule(const Side& side, double threshold, double window, double slack, std::uint64_t stamp, SolverCore& core,
           ThreadBuffers& buffers)
      : side_(side),
        threshold_(threshold),
        window_(window),
        slack_(slack),
        buffers_(buffers),
        cover_(side_, slack, window, stamp, core, buffers.cover) {}

  /// @return whether `points` was changed
  bool apply(double depth, const Vec3& witness, LazyPoints& points) {
    const Vec3 n = side_.outward(points.normal());
    if (pushes_from_triangle(n)) return false;
    const double margin = side_.own.shape->margin();
    const Vec3 foot = witness - margin * n;
    // Of few pieces, most have none near that could cover.
    const bool seals = cover_.of_many();
    if (!seals && !is_flat(side_.own) && !cover_.look_round(foot, margin, n)) return false;
    cover_.take_own();
    const UnionPiece& own = *buffers_.cover.own;
    if (own.planes.empty()) return false;
    const auto best =
        std::max_element(own.planes.begin(), own.planes.end() - (own.flat ? 3 : 0),
                         [&](const Plane& x, const Plane& y) { return x.normal.dot(n) < y.normal.dot(n); });
    const double cosine = best->normal.dot(n);
    const bool facet = cosine >= 1 - kSameNormal;
    if (facet && cover_.is_sealed(static_cast<std::size_t>(best - own.planes.begin()))) {
      points.set(nearest_free(n, depth, foot));
      return true;
    }
    if (seals && !cover_.look_round(foot, margin, n)) return false;
    if (facet) return !own.flat && facet_contact(depth, best->normal, foot, points.get());
    const double sine = covered_here(foot, n);
    if (sine <= kLevel) return false;
    if (sine < kDecided && (cosine < kNearNormal || is_facet_of_other(n))) return false;
    points.set(own.flat && cosine >= kNearNormal ? turned(*best) : nearest_free(n, depth, foot));
    return true;
  }

 private:
  /// Whether n is the normal of one side of a triangle: nothing covers those, and most contacts end here.
  [[nodiscard]] bool pushes_from_triangle(const Vec3& n) const {
    return is_flat(side_.own) &&
           std::abs((side_.own.pose.rotation() * side_.own.shape->polytope()->facet_normal(0)).dot(n)) >=
               1 - kSameNormal;
  }

  /// Whether the other body meets this one with a facet: -n is its normal then, and no noise.
  [[nodiscard]] bool is_facet_of_other(const Vec3& n) const {
    const ConvexPolytope* polytope = side_.other.shape->polytope();
    if (polytope == nullptr) return false;
    const Vec3 local = -(side_.other.pose.rotation().transpose() * n);
    for (int f = 0; f < polytope->num_facets(); ++f) {
      if (polytope->facet_normal(f).dot(local) >= 1 - kSameNormal) return true;
    }
    return false;
  }

  /// A contact in the middle of a triangle that does not push along its normal is the triangle's own: what lies round
  /// it is not looked for.
  double covered_here(const Vec3& foot, const Vec3& n) {
    const UnionPiece& own = *buffers_.cover.own;
    if (own.flat) {
      const double own_sine = covered_sine(own, foot, n, slack_, kBeyondDoubt, buffers_.cover.active);
      if (own_sine > kDecided) return own_sine;
      if (cover_.led_on_by_neighbour(foot, n)) return kLedOn;
      cover_.look_round(foot, own.margin, n);
    }
    return cover_.covered(foot, n);
  }

  /// A solid's facet: each point by itself.
  bool facet_contact(double depth, const Vec3& n, const Vec3& foot, ContactManifold& points) {
    const double margin = buffers_.cover.own->margin;
    const int before = points.count;
    for (int i = points.count - 1; i >= 0; --i) {
      const Vec3 on_core = side_.on_piece(points.points[static_cast<std::size_t>(i)]) - margin * n;
      if (cover_.covered(on_core, n) > kDecided) drop(points, i);
    }
    if (points.count == before) return false;
    if (points.count == 0) points = nearest_free(n, depth, foot);
    return true;
  }

  double depth_along(const Plane& facet, Vec3& farthest) const {
    farthest = farthest_against(side_.other, facet.normal);
    return side_.other.shape->margin() + buffers_.cover.own->margin - facet.height(farthest);
  }

  ContactManifold turned(const Plane& facet) {
    Vec3 farthest;
    const double depth = depth_along(facet, farthest);
    if (depth < -threshold_) return {};
    return along_facet(side_, facet, depth, farthest, threshold_, slack_, *buffers_.cover.own, buffers_.manifold);
  }

  /// The contact along the nearest facet of the piece, but that of n, that is not covered and lies within reach.
  ContactManifold nearest_free(const Vec3& n, double depth, const Vec3& foot) {
    const UnionPiece& own = *buffers_.cover.own;
    if (!own.flat) cover_.look_round(foot, own.margin, Vec3::Zero());
    std::vector<std::pair<double, int>>& facets = buffers_.cover.facets;
    facets.clear();
    const double limit = std::max(4 * depth, window_);
    const int count = static_cast<int>(own.planes.size()) - (own.flat ? 3 : 0);
    Vec3 farthest;
    for (int f = 0; f < count; ++f) {
      const Plane& facet = own.planes[static_cast<std::size_t>(f)];
      if (facet.normal.dot(n) >= 1 - kSameNormal || facet.normal.dot(side_.front) < 0) continue;
      const double along = depth_along(facet, farthest);
      if (along < -threshold_) return {};  // apart along a facet: nothing of this piece is near
      if (along <= limit) facets.emplace_back(along, f);
    }
    std::sort(facets.begin(), facets.end());
    for (int i = 0; i < std::min(kTries, static_cast<int>(facets.size())); ++i) {
      const auto f = static_cast<std::size_t>(facets[static_cast<std::size_t>(i)].second);
      if (cover_.is_sealed(f)) continue;
      const Plane& facet = own.planes[f];
      ContactManifold points = turned(facet);
      for (int k = points.count - 1; k >= 0 && !own.flat; --k) {
        const Vec3 on_core = side_.on_piece(points.points[static_cast<std::size_t>(k)]) - own.margin * facet.normal;
        if (cover_.covered(on_core, facet.normal) > kDecided) drop(points, k);
      }
      if (points.count > 0) return points;
    }
    return {};
  }

  Side side_;
  double threshold_;
  double window_;
  double slack_;
  ThreadBuffers& buffers_;
  Cover cover_;
};

/// How far from a contact a union is looked at: as far as the bodies may move before contacts are found again.
double window_of(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, double depth, double threshold,
                 double seconds) {
  const Vec3 way = seconds * (linear_velocity(*a.getCollisionObject()) - linear_velocity(*b.getCollisionObject()));
  return threshold + std::abs(depth) + way.norm();
}

}  // namespace

void keep_uncovered(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const PairAnswer& answer,
                    const Vec3& front, double threshold, double seconds, std::uint64_t stamp, SolverCore& core,
                    ThreadBuffers& buffers, AnswerPoints given, ContactManifold& points) {
  LazyPoints lazy(answer, threshold, buffers.manifold, given, points);
  if (lazy.none()) return;
  const double slack = seam_slack(answer.a, answer.b);
  double depth = -answer.depth.signed_distance();
  const double window = window_of(a, b, depth, threshold, seconds);
  Vec3 witness_b = answer.depth.witness_b;
  if (is_piece(b)) {
    SideRule rule({b, answer.b, answer.a, true, front}, threshold, window, slack, stamp, core, buffers);
    if (rule.apply(depth, witness_b, lazy)) {
      buffers.counters.covered.add();
      if (points.count == 0) return;
      const auto deepest = std::max_element(points.points.begin(), points.points.begin() + points.count,
                                            [](const auto& x, const auto& y) { return x.depth < y.depth; });
      depth = deepest->depth;
      witness_b = deepest->position_b;
    }
  }
  if (is_piece(a)) {
    SideRule rule({a, answer.a, answer.b, false}, threshold, window, slack, stamp, core, buffers);
    if (rule.apply(depth, witness_b - depth * lazy.normal(), lazy)) buffers.counters.covered.add();
  }
  lazy.get();
}

void drop_covered(const btCollisionObjectWrapper& a, const PosedShape& body, const btCollisionObjectWrapper& b,
                  double threshold, double seconds, std::uint64_t stamp, SolverCore& core, ThreadBuffers& buffers,
                  ContactManifold& points) {
  const Vec3 n = -points.normal;
  const double margin = body.shape->margin();
  const double slack = seam_slack(body, body);
  const Side side{a, body, body, false};
  for (int i = points.count - 1; i >= 0; --i) {
    const ContactPoint& point = points.points[static_cast<std::size_t>(i)];
    const Vec3 foot = point.position_a - margin * n;
    Cover cover(side, slack, window_of(a, b, point.depth, threshold, seconds), stamp, core, buffers.cover);
    if (!cover.look_round(foot, margin, n)) continue;
    cover.take_own();
    if (buffers.cover.own->planes.empty() || cover.covered(foot, n) <= kDecided) continue;
    drop(points, i);
    buffers.counters.covered.add();
  }
}

ContactManifold along_front(const btCollisionObjectWrapper& triangle, const PairAnswer& answer, const Vec3& front,
                            double threshold, ThreadBuffers& buffers) {
  UnionPiece& own = buffers.cover.made;
  set_piece(answer.b, own);
  if (own.planes.empty()) return {};
  const Plane& side = own.planes[own.planes[0].normal.dot(front) > 0 ? 0 : 1];
  const Vec3 farthest = farthest_against(answer.a, side.normal);
  const double depth = answer.a.shape->margin() + own.margin - side.height(farthest);
  return along_facet({triangle, answer.b, answer.a, true, front}, side, depth, farthest, threshold,
                     seam_slack(answer.a, answer.b), own, buffers.manifold);
}

}  // namespace pd::detail
