#include "depth/features/local_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/difference/barycentric.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// Steps of Newton's method; most need two.
constexpr int kMostSteps = 5;
/// Directions turn by less in one step, or the minimum is that of other features.
constexpr double kMostTurn = 0.5;
/// Narrower cones are worth no point of a surface.
constexpr double kLeastCone = 0x1p-6;
/// Constants of a cone err by some 2^-40 of themselves at worst.
constexpr double kSafety = 1 - 0x1p-10;

/// The sphere of a hull whose surface holds a point of its own; any of them would do for points of the hull.
int sphere_of(const SphereHull& hull, const Vec3& local) {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.spheres().size(); ++i) {
    const Sphere& sphere = hull.spheres()[i];
    const double off = std::abs((local - sphere.centre).norm() - sphere.radius);
    if (off < least) {
      least = off;
      best = static_cast<int>(i);
    }
  }
  return best;
}

/// What a support belongs to: a vertex or apex (its point alone), a rim or a sphere of a body.
struct BodyFeature {
  int number = 0;   ///< of those with the same centre: none; -1: not looked into
  int axis = -1;    ///< of a rim's disc
  double rim = 0;   ///< radius
  double ball = 0;  ///< radius
  Vec3 centre;      ///< local
};

struct FeatureOf {
  Vec3 local;

  BodyFeature operator()(const ConvexPolytope& /*a vertex*/) const { return {0, -1, 0, 0, local}; }
  BodyFeature operator()(const Ellipsoid& /*not looked into*/) const { return {-1, -1, 0, 0, local}; }
  BodyFeature operator()(const Cylinder& c) const { return on_rim(c.radius, c.axis); }
  BodyFeature operator()(const Cone& c) const {
    return local[c.axis] < 0 ? on_rim(c.radius, c.axis) : BodyFeature{1, -1, 0, 0, local};
  }
  BodyFeature operator()(const SphereHull& hull) const {
    const int i = sphere_of(hull, local);
    const Sphere& sphere = hull.spheres()[static_cast<std::size_t>(i)];
    return {i, -1, 0, sphere.radius, sphere.centre};
  }

 private:
  BodyFeature on_rim(double radius, int axis) const {
    BodyFeature rim{local[axis] < 0 ? 0 : 2, axis, radius, 0, Vec3::Zero()};
    rim.centre[axis] = local[axis];
    return rim;
  }
};

/// A pair of features, A's and B's, and its point of P.
struct Piece {
  BodyFeature of[2];
  Vec3 centre;  ///< of the two discs or balls, in P
  Vec3 x;

  [[nodiscard]] bool same_as(const Piece& other) const {
    for (const int k : {0, 1}) {
      if (of[k].number != other.of[k].number || of[k].centre != other.of[k].centre) return false;
    }
    return true;
  }
};

/// Of a rim about the direction as it is.
struct RimAtDirection {
  double along = 0;             ///< the length of the direction's part in the rim's plane
  Vec3 outward = Vec3::Zero();  ///< that part's direction, or none
  Vec3 tangent = Vec3::Zero();  ///< unit
};

/// What two pieces add to their supporting planes: along (e) and across (w) their edge.
struct Growth {
  double ball = 0;
  double ee = 0, ew = 0, ww = 0;  ///< of a quadratic form
};

class LocalSearch {
 public:
  LocalSearch(const SmoothDifference& difference, const Vec3& normal, double relative)
      : difference_(difference), unit_(normal), relative_(relative) {}

  /// The distinct pairs of features of the corners. False where one is not looked into.
  bool take_pieces(const DifferenceVertex (&corners)[3]) {
    for (const DifferenceVertex& corner : corners) {
      if (corner.a < 0) return false;
      const PointPair& points = difference_.points(corner);
      Piece& piece = pieces_[count_];
      piece.of[0] = std::visit(FeatureOf{points.local_a}, difference_.core_of(0));
      piece.of[1] = std::visit(FeatureOf{points.local_b}, difference_.core_of(1));
      if (piece.of[0].number < 0 || piece.of[1].number < 0) return false;
      if (std::any_of(pieces_, pieces_ + count_, [&](const Piece& other) { return piece.same_as(other); })) continue;
      piece.centre = (difference_.rotation_of(1) * piece.of[1].centre + difference_.offset()) -
                     difference_.rotation_of(0) * piece.of[0].centre;
      for (const int k : {0, 1}) {
        if (piece.of[k].axis >= 0) axis_[k] = difference_.rotation_of(k).col(piece.of[k].axis);
      }
      ++count_;
    }
    return true;
  }

  bool find(LocalMinimum& out) {
    if (count_ == 3 && !meet_in_plane()) return false;
    if (count_ == 2 && !meet_in_edge()) return false;
    if (count_ == 1 && !meet_on_disc()) return false;
    const double tangent = tangent_of_cone(out.weights);
    if (!(tangent > 0)) return false;
    // Supports of the difference, whose errors are known.
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      out.corners[i] = i < count_ ? corner(i) : out.corners[0];
      lowest = std::min(lowest, out.corners[i].x.dot(unit_));
    }
    out.lower = lowest - face_error(difference_) - loss_;
    out.upper = difference_.support(unit_, nullptr).x.dot(unit_) + support_plane_error(difference_);
    out.normal = unit_;
    out.cosine = 1 / std::sqrt(1 + tangent * tangent);
    return out.lower > 0 && out.upper - lowest <= slack() + 2 * support_plane_error(difference_);
  }

 private:
  [[nodiscard]] double slack() const { return 0.125 * relative_ * lowest(); }
  [[nodiscard]] double height(int i) const { return pieces_[i].x.dot(unit_); }
  [[nodiscard]] double lowest() const {
    double least = height(0);
    for (int i = 1; i < count_; ++i) least = std::min(least, height(i));
    return least;
  }
  [[nodiscard]] double highest() const {
    double most = height(0);
    for (int i = 1; i < count_; ++i) most = std::max(most, height(i));
    return most;
  }

  /// The pieces' points in the direction as it is.
  void turn_pieces() {
    for (const int k : {0, 1}) {
      const Vec3 across = unit_ - unit_.dot(axis_[k]) * axis_[k];
      RimAtDirection& rim = rims_[k];
      rim.along = across.norm();
      rim.outward = rim.along > 0 ? Vec3(across / rim.along) : Vec3(Vec3::Zero());
      rim.tangent = axis_[k].cross(rim.outward);
    }
    for (Piece* piece = pieces_; piece != pieces_ + count_; ++piece) {
      // Of A the points farthest the other way count, with the other sign.
      piece->x = piece->centre + (piece->of[0].ball + piece->of[1].ball) * unit_ + piece->of[0].rim * rims_[0].outward +
                 piece->of[1].rim * rims_[1].outward;
    }
  }
  /// A piece's point as a support, with its points of both bodies.
  [[nodiscard]] DifferenceVertex corner(int i) const {
    Vec3 at[2];
    for (const int k : {0, 1}) {
      const BodyFeature& feature = pieces_[i].of[k];
      at[k] = feature.centre;
      if (feature.rim == 0 && feature.ball == 0) continue;
      const Vec3 turned = difference_.rotation_of(k).transpose() * unit_;
      const Vec3 outward = k == 0 ? Vec3(-turned) : turned;
      if (feature.rim == 0) {
        at[k] += feature.ball * outward;
        continue;
      }
      Vec3 across = count_ == 1 ? in_disc_ : outward;
      across[feature.axis] = 0;
      const double length = count_ == 1 ? feature.rim : across.norm();
      if (length > 0) at[k] += (feature.rim / length) * across;
    }
    return difference_.vertex(at[0], at[1]);
  }

  /// Three points: the normal of their plane, until it is their own. Where the foot lies outside, two are left.
  bool meet_in_plane() {
    for (int step = 0;; ++step) {
      turn_pieces();
      if (step > 0 && highest() - lowest() <= slack()) break;
      if (step == kMostSteps) return false;
      const Vec3 normal = (pieces_[1].x - pieces_[0].x).cross(pieces_[2].x - pieces_[0].x);
      const double length = normal.norm();
      const double cosine = normal.dot(unit_) / length;
      if (!(std::abs(cosine) > 1 - kMostTurn * kMostTurn / 2)) return false;
      unit_ = normal / (cosine < 0 ? -length : length);
    }
    double weights[3];
    share_triangle(weights);
    const int least = static_cast<int>(std::min_element(weights, weights + 3) - weights);
    if (weights[least] > 0) return true;
    pieces_[least] = pieces_[2];
    count_ = 2;
    return true;
  }

  /// Two points: the direction across their edge of the least height, by Newton's method.
  bool meet_in_edge() {
    for (int step = 0; step < kMostSteps; ++step) {
      turn_pieces();
      const Vec3 between = pieces_[1].x - pieces_[0].x;
      const double length = between.norm();
      if (!(length > 0)) return false;
      edge_ = between / length;
      const double rise = edge_.dot(unit_);
      across_ = unit_.cross(edge_).normalized();
      fall_ = pieces_[0].x.dot(across_);
      const Growth growth = growth_of_pieces(0);
      const double bend = 2 * growth.ww + growth.ball - lowest();
      if (!(bend > 0)) return false;
      if (std::abs(rise) * length <= slack() && 8 * fall_ * fall_ <= bend * slack()) return true;
      const double turn = -fall_ / bend;
      if (!(std::abs(turn) < kMostTurn)) return false;
      unit_ = (unit_ - rise * edge_ + turn * across_).normalized();
    }
    return false;
  }

  /// One point of a rim and a vertex: where the disc faces the vertex, the direction is its axis.
  bool meet_on_disc() {
    const Piece& piece = pieces_[0];
    const int k = piece.of[0].axis >= 0 ? 0 : 1;
    const BodyFeature& rim = piece.of[k];
    if (rim.axis < 0 || piece.of[1 - k].rim > 0 || piece.of[1 - k].ball > 0) return false;
    const bool upwards = (rim.centre[rim.axis] < 0) == (k == 0);
    const Vec3 axis = upwards ? axis_[k] : Vec3(-axis_[k]);
    if (!(axis.dot(unit_) > 1 - kMostTurn * kMostTurn / 2)) return false;
    unit_ = axis;
    pieces_[0].x = piece.centre;
    const Vec3 aside = piece.centre - height(0) * unit_;
    inside_disc_ = rim.rim - aside.norm();
    const Vec3 turned = difference_.rotation_of(k).transpose() * aside;
    in_disc_ = k == 0 ? turned : Vec3(-turned);
    return inside_disc_ > 0;
  }

  void share_triangle(double (&weights)[3]) const {
    const DifferenceVertex corners[3] = {{pieces_[0].x, 0, 0}, {pieces_[1].x, 0, 0}, {pieces_[2].x, 0, 0}};
    project_origin(corners, unit_, weights);
  }
  /// The shares of the two points in the foot.
  void share_edge(double (&weights)[3]) const {
    const double before = -pieces_[0].x.dot(edge_), behind = pieces_[1].x.dot(edge_);
    weights[0] = behind / (before + behind);
    weights[1] = before / (before + behind);
    weights[2] = 0;
  }

  /// Within |y| <= reach, as shared by the two pieces.
  [[nodiscard]] Growth growth_of_pieces(double reach) const {
    double weights[3];
    share_edge(weights);
    for (double& weight : weights) weight = std::clamp(weight, 0.0, 1.0);
    Growth sum;
    for (const int k : {0, 1}) {
      const BodyFeature& first = pieces_[0].of[k];
      const BodyFeature& second = pieces_[1].of[k];
      sum.ball += weights[0] * first.ball + weights[1] * second.ball;
      const double radius = weights[0] * first.rim + weights[1] * second.rim;
      if (!(radius > 0 && rims_[k].along > 0)) continue;
      const double coefficient = radius / (2 * (rims_[k].along + reach));
      const double e = rims_[k].tangent.dot(edge_), w = rims_[k].tangent.dot(across_);
      sum.ee += coefficient * e * e;
      sum.ew += coefficient * e * w;
      sum.ww += coefficient * w * w;
    }
    return sum;
  }
  [[nodiscard]] bool equally_round() const {
    for (const int k : {0, 1}) {
      const BodyFeature& first = pieces_[0].of[k];
      const BodyFeature& second = pieces_[1].of[k];
      if (first.rim != second.rim || first.ball != second.ball) return false;
    }
    return true;
  }

  /// tan of the cone's half angle, and the weights of the foot; 0 where there is none.
  double tangent_of_cone(double (&weights)[3]) {
    if (count_ == 3) return tangent_of_facet(foot_in_triangle(weights));
    if (count_ == 2) return tangent_of_edge(weights);
    weights[0] = 1;
    weights[1] = weights[2] = 0;
    return tangent_of_facet(inside_disc_);
  }

  /// |y| up to which a facet's corners outgrow |n + y|: <p, y> of one of them is at least |y| times the distance of the
  /// foot from the facet's border.
  double tangent_of_facet(double inside) const {
    inside -= 8 * face_error(difference_);
    return inside > 0 ? kSafety * std::min(1.0, 2 * inside / highest()) : 0;
  }

  /// Its distance from the edges, negative outside; 0 where two corners are one, and there is no triangle.
  double foot_in_triangle(double (&weights)[3]) const {
    share_triangle(weights);
    double inside = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const Vec3& from = pieces_[i].x;
      const Vec3 along = pieces_[(i + 1) % 3].x - from;
      const double length = along.norm();
      if (!(length > 0)) return 0;
      const double area = from.cross(along).dot(unit_);
      const double opposite = along.cross(pieces_[(i + 2) % 3].x - from).dot(unit_);
      inside = std::min(inside, (opposite < 0 ? -area : area) / length);
    }
    return inside;
  }

  /// The same of an edge: along it as of a facet, across it by roundness.
  double tangent_of_edge(double (&weights)[3]) {
    share_edge(weights);
    const double before = -pieces_[0].x.dot(edge_), behind = pieces_[1].x.dot(edge_);
    const double inside = std::min(before, behind) - 8 * face_error(difference_);
    if (!(inside > 0)) return 0;
    const double slope = std::abs(fall_) + face_error(difference_);
    double best = 0;
    for (double reach = 1; reach > best && reach > kLeastCone; reach *= 0.5) {
      const Growth growth = growth_of_pieces(reach);
      // Points that differ in roundness give up as much of it as they shift their weights along the edge.
      const double spare = 1 - highest() / (2 * growth.ww + growth.ball);
      if (!(spare > 0)) continue;
      const double shifted = equally_round() ? 0 : 0.5 * spare;
      const double kept = 1 - shifted;
      const double excess = highest() - kept * growth.ball;
      const double half = excess > 0 ? 0.5 * excess : excess / (1 + std::sqrt(1 + reach * reach));
      const double across = kept * growth.ww - half;
      if (!(across > 0)) continue;
      // A quarter of it for the slope that is left across the edge.
      const double loss = slope * slope / across;
      const double mixed = kept * growth.ew;
      const double against = half - kept * growth.ee + mixed * mixed / (0.75 * across);
      const double advance = equally_round() ? inside : shifted * inside;
      const double tangent = against > 0 ? std::min(reach, advance / against) : reach;
      if (!(loss <= slack() && tangent > best)) continue;
      best = tangent;
      loss_ = loss;
    }
    return kSafety * best;
  }

  const SmoothDifference& difference_;
  Vec3 unit_;
  double relative_;
  Piece pieces_[3];
  int count_ = 0;
  Vec3 axis_[2] = {Vec3::Zero(), Vec3::Zero()};  ///< of the rims of A and B, if any
  RimAtDirection rims_[2];
  Vec3 edge_ = Vec3::Zero();     ///< of two pieces, unit
  Vec3 across_ = Vec3::Zero();   ///< the direction and the edge, unit
  double fall_ = 0;              ///< slope of the height across the edge
  double loss_ = 0;              ///< of height, by that slope
  double inside_disc_ = 0;       ///< how far the foot lies inside the rim
  Vec3 in_disc_ = Vec3::Zero();  ///< where, from the disc's centre, in the body's frame
};

}  // namespace

std::optional<LocalMinimum> local_minimum(const SmoothDifference& difference, const DifferenceVertex (&corners)[3],
                                          const Vec3& normal, double relative) {
  LocalSearch search(difference, normal, relative);
  LocalMinimum out;
  if (!search.take_pieces(corners) || !search.find(out)) return std::nullopt;
  return out;
}

}  // namespace pd::detail
