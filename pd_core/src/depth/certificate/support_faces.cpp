#include "depth/certificate/support_faces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

class FacetSign final : public NormalSign {
 public:
  FacetSign(const PosedPair& pair, const FacetOfDifference& facet) : pair_(pair), facet_(facet) {}
  [[nodiscard]] int along(const PairVector& edge) const override {
    return pair_.sign_determinant(edge, facet_.u, facet_.v);
  }

 private:
  const PosedPair& pair_;
  const FacetOfDifference& facet_;
};

/// A body's vertices against the plane's normal in the body's own frame: an edge takes three products.
class LocalHeights {
 public:
  LocalHeights(const ConvexPolytope& body, const double (&rotation)[9], const Vec3& unit, double unit_error)
      : x_(body.x()), y_(body.y()), z_(body.z()) {
    double columns = 0;
    for (int j = 0; j < 3; ++j) {
      const double r0 = rotation[j], r1 = rotation[3 + j], r2 = rotation[6 + j];
      normal_[j] = r0 * unit.x() + r1 * unit.y() + r2 * unit.z();
      columns = std::max(columns, std::abs(r0) + std::abs(r1) + std::abs(r2));
    }
    // A coordinate of the normal: the unit's error and its rounding, the rotation's, a product and two sums; of a
    // height then a difference, a product and two sums. No coordinate of `unit` is greater than 1.
    relative_ = columns * (unit_error + 10 * kUnitRoundoff) * (1 + 16 * kUnitRoundoff);
    const Vec3& box = body.max_abs_coordinates();
    largest_error_ = 2 * relative_ * (box.x() + box.y() + box.z()) + kLeast;
  }

  /// Sign of the rise, 0 where doubles cannot tell.
  [[nodiscard]] int rise(int from, int to) const {
    const double x = x_[to] - x_[from], y = y_[to] - y_[from], z = z_[to] - z_[from];
    const double value = x * normal_[0] + y * normal_[1] + z * normal_[2];
    const double size = std::abs(value);
    if (size > largest_error_ || size > relative_ * (std::abs(x) + std::abs(y) + std::abs(z)) + kLeast) {
      return value > 0 ? 1 : -1;
    }
    return 0;
  }

 private:
  static constexpr double kLeast = 0x1p-900;  ///< what underflow may lose, and more

  const double* x_;
  const double* y_;
  const double* z_;
  double normal_[3];
  double relative_ = 0;  ///< error of a rise in units of the edge's 1-norm
  double largest_error_ = 0;
};

/// Over a plane across a coordinate axis, where a body's vertices rise as one of their own coordinates does, exactly.
class CoordinateHeights {
 public:
  CoordinateHeights() = default;
  /// @param sign  of the plane's normal along its axis.
  CoordinateHeights(const PosedPair::OwnCoordinate& own, double sign)
      : height_(own.x), reversed_(own.sign * sign < 0) {}

  [[nodiscard]] bool known() const { return height_ != nullptr; }
  [[nodiscard]] int rise(int from, int to) const {
    const int sign = (height_[to] > height_[from]) - (height_[to] < height_[from]);
    return reversed_ ? -sign : sign;
  }

 private:
  const double* height_ = nullptr;
  bool reversed_ = false;
};

/// Of more vertices the edges of those in the plane are asked.
constexpr int kMostScanned = 64;

/// Signs of <edge, normal of the plane>, exact, doubles first.
class AlongNormal {
 public:
  AlongNormal(const PosedPair& pair, const FacetPlane& plane, const NormalSign& sign)
      : pair_(pair), sign_(sign), filtered_(plane.known()), axis_(plane.axis) {
    if (!filtered_) return;
    unit_ = {plane.unit.x.hi, plane.unit.y.hi, plane.unit.z.hi};
    // The unit normal's own error and its rounding, products and sums; then the edge's error against |unit|_1 <= 2.
    relative_ = plane.unit_error + 8 * kUnitRoundoff;
    absolute_ = 2 * pair.vector_error() * (1 + 16 * kUnitRoundoff);
    if (pair.scale_exponent() != 0) return;
    if (axis_ >= 0) {
      along_a_ = CoordinateHeights(pair.own_coordinate_a(axis_), unit_[axis_]);
      along_b_ = CoordinateHeights(pair.own_coordinate_b(axis_), unit_[axis_]);
      if (along_a_.known() && along_b_.known()) return;
    }
    of_a_.emplace(pair.a(), pair.rotation_a(), unit_, plane.unit_error);
    of_b_.emplace(pair.b(), pair.rotation_b(), unit_, plane.unit_error);
  }

  [[nodiscard]] int edge_a(int from, int to) const {
    if (along_a_.known()) return along_a_.rise(from, to);
    const int told = of_a_ ? of_a_->rise(from, to) : 0;
    return told != 0 ? told : (*this)(PairVector::edge_a(from, to));
  }
  [[nodiscard]] int edge_b(int from, int to) const {
    if (along_b_.known()) return along_b_.rise(from, to);
    const int told = of_b_ ? of_b_->rise(from, to) : 0;
    return told != 0 ? told : (*this)(PairVector::edge_b(from, to));
  }

 private:
  [[nodiscard]] int operator()(const PairVector& edge) const {
    DoubleDouble exact;
    if (axis_ >= 0 && pair_.exact_coordinate(edge, axis_, exact)) {
      const double value = exact.hi * unit_[axis_];
      return (value > 0) - (value < 0);
    }
    if (filtered_ && !of_a_) {
      const Vec3 e = pair_.approximate(edge);
      const double value = e.dot(unit_);
      const double size = std::abs(e.x()) + std::abs(e.y()) + std::abs(e.z());
      if (std::abs(value) > (relative_ * size + absolute_) * (1 + 16 * kUnitRoundoff)) return value > 0 ? 1 : -1;
    }
    return sign_.along(edge);
  }

  const PosedPair& pair_;
  const NormalSign& sign_;
  bool filtered_;
  int axis_;  ///< of the plane
  Vec3 unit_ = Vec3::Zero();
  double relative_ = 0;
  double absolute_ = 0;
  CoordinateHeights along_a_;
  CoordinateHeights along_b_;
  std::optional<LocalHeights> of_a_;
  std::optional<LocalHeights> of_b_;
};

/// Completes the face that some of its vertices are known of. `rises(from, to)`: sign of the change along the body's
/// own outward direction.
template <class Rises>
bool complete(const ConvexPolytope& body, Rises&& rises, SupportFace& face) {
  constexpr std::size_t kFew = 16;
  for (std::size_t i = 0; i < face.size(); ++i) {
    // No edge of the first rises: it is farthest, and what is level with it is a face. A large one is not walked round,
    // looking for every corner among all that were found, but read from the facet's loop.
    if (i > 0 && face.size() > kFew) {
      if (const int facet = facet_holding(body, face[0], face[1], face[2]); facet >= 0) {
        const auto loop = body.facet_vertices(facet);
        face.assign(loop.begin(), loop.end());
        break;
      }
    }
    const std::int32_t from = face[i];
    for (const std::int32_t to : body.neighbours(from)) {
      if (std::find(face.begin(), face.end(), to) != face.end()) continue;
      const int sign = rises(from, to);
      if (sign > 0) return false;
      if (sign == 0) face.push_back(to);
    }
  }
  std::sort(face.begin(), face.end());
  return true;
}

template <class Rises>
bool collect(const ConvexPolytope& body, const Feature& feature, Rises&& rises, SupportFace& face) {
  if (feature.kind == Feature::Kind::facet) {
    // Facets are merged exactly: nothing else of the body lies in the plane.
    const auto loop = body.facet_vertices(feature.first);
    face.assign(loop.begin(), loop.end());
    std::sort(face.begin(), face.end());
    return true;
  }
  face.assign(1, feature.first);
  if (feature.kind == Feature::Kind::edge) face.push_back(feature.second);
  return complete(body, rises, face);
}

/// All vertices as far along a coordinate as one of them. False where others are farther.
bool scan(const ConvexPolytope& body, const PosedPair::OwnCoordinate& own, double sign, int known, SupportFace& face) {
  face.clear();
  const double upwards = own.sign * sign, level = upwards * own.x[known];
  for (int v = 0; v < body.num_vertices(); ++v) {
    const double height = upwards * own.x[v];
    if (height > level) return false;
    if (height == level) face.push_back(v);
  }
  return true;
}

Feature feature_of(const ConvexPolytope& body, const SupportFace& face, const Mat3& rotation, const Vec3& outward) {
  if (face.size() == 1) return {Feature::Kind::vertex, face[0], -1};
  if (face.size() == 2) return {Feature::Kind::edge, face[0], face[1]};
  return {Feature::Kind::facet, facing_facet(body, face, rotation, outward), -1};
}

}  // namespace

int facet_holding(const ConvexPolytope& body, std::int32_t v0, std::int32_t v1, std::int32_t v2, int skip) {
  const int first = body.first_half_edge(v0);
  for (int h = first; h < first + static_cast<int>(body.neighbours(v0).size()); ++h) {
    const int f = body.half_edge(h).facet;
    if (f < 0 || f == skip) continue;
    const auto loop = body.facet_vertices(f);
    if (std::find(loop.begin(), loop.end(), v1) != loop.end() &&
        std::find(loop.begin(), loop.end(), v2) != loop.end()) {
      return f;
    }
  }
  return -1;
}

bool collect_faces(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane,
                   SupportFaces& faces) {
  if (plane.axis >= 0 && pair.has_own_coordinate(plane.axis) &&
      std::max(pair.a().num_vertices(), pair.b().num_vertices()) <= kMostScanned) {
    const double sign = to_double(plane.axis == 0 ? plane.unit.x : plane.axis == 1 ? plane.unit.y : plane.unit.z);
    return scan(pair.b(), pair.own_coordinate_b(plane.axis), sign, facet.b, faces.on_b) &&
           scan(pair.a(), pair.own_coordinate_a(plane.axis), -sign, facet.a, faces.on_a);
  }
  const FacetSign sign(pair, facet);
  const AlongNormal along(pair, plane, sign);
  return collect(
             pair.b(), facet.on_b, [&](int from, int to) { return along.edge_b(from, to); }, faces.on_b) &&
         collect(
             pair.a(), facet.on_a, [&](int from, int to) { return -along.edge_a(from, to); }, faces.on_a);
}

bool collect_faces(const PosedPair& pair, const FacetPlane& plane, const NormalSign& sign,
                   std::span<const VertexPair> points, SupportFaces& faces) {
  const AlongNormal along(pair, plane, sign);
  faces.on_a.clear();
  faces.on_b.clear();
  const auto add = [](SupportFace& face, std::int32_t v) {
    if (std::find(face.begin(), face.end(), v) == face.end()) face.push_back(v);
  };
  // Of two points of the plane that share a vertex of one body the other vertices lie equally far; without a shared one
  // that need not be so (it is where the plane supports P, which is what has to be shown).
  add(faces.on_a, points[0].a);
  add(faces.on_b, points[0].b);
  const auto has = [](const SupportFace& face, std::int32_t v) {
    return std::find(face.begin(), face.end(), v) != face.end();
  };
  for (std::size_t round = 1; round < points.size(); ++round) {
    for (const VertexPair& p : points.subspan(1)) {
      if (has(faces.on_a, p.a)) add(faces.on_b, p.b);
      if (has(faces.on_b, p.b)) add(faces.on_a, p.a);
    }
  }
  return complete(
             pair.b(), [&](int from, int to) { return along.edge_b(from, to); }, faces.on_b) &&
         complete(
             pair.a(), [&](int from, int to) { return -along.edge_a(from, to); }, faces.on_a);
}

FacetFeatures features_of(const PosedPair& pair, const SupportFaces& faces, const Vec3& unit) {
  FacetFeatures f{feature_of(pair.a(), faces.on_a, pair.pose_a().rotation(), -unit),
                  feature_of(pair.b(), faces.on_b, pair.pose_b().rotation(), unit)};
  // A facet's partner is a vertex, also where more of the other body lies in its plane.
  if (f.on_b.kind == Feature::Kind::facet) {
    f.on_a = {Feature::Kind::vertex, faces.on_a.front(), -1};
  } else if (f.on_a.kind == Feature::Kind::facet) {
    f.on_b = {Feature::Kind::vertex, faces.on_b.front(), -1};
  }
  return f;
}

}  // namespace pd::detail
