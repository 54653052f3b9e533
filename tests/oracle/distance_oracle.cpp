#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "oracle/depth_oracle.hpp"

namespace pd::oracle {

namespace {

/// The point of the simplex nearest to the origin, in doubles, by trying every face (largest first does not matter: the
/// least norm among the valid projections wins). Keeps only the vertices of the face that holds it.
struct Simplex {
  std::array<Vec3, 4> points{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  int count = 0;

  Vec3 reduce() {
    Vec3 best = Vec3::Zero();
    double best_norm = std::numeric_limits<double>::infinity();
    unsigned best_mask = 0;
    for (unsigned mask = 1; mask < (1U << count); ++mask) {
      std::array<Vec3, 4> corner = points;
      int n = 0;
      for (int k = 0; k < count; ++k) {
        if ((mask >> k & 1U) != 0) corner[n++] = points[k];
      }
      Vec3 nearest;
      if (!project(corner, n, nearest)) continue;
      if (nearest.squaredNorm() < best_norm) {
        best_norm = nearest.squaredNorm();
        best = nearest;
        best_mask = mask;
      }
    }
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      if ((best_mask >> k & 1U) != 0) points[kept++] = points[k];
    }
    count = kept;
    return best;
  }

 private:
  // Gram-Schmidt on the differences; false when the projection falls outside the simplex.
  static bool project(const std::array<Vec3, 4>& corner, int n, Vec3& nearest) {
    if (n == 1) {
      nearest = corner[0];
      return true;
    }
    if (n == 4) {
      const Vec3 u = corner[1] - corner[0];
      const Vec3 v = corner[2] - corner[0];
      const Vec3 w = corner[3] - corner[0];
      const double det = u.cross(v).dot(w);
      if (det == 0) return false;
      const Vec3 p = -corner[0];
      const double s = p.cross(v).dot(w) / det;
      const double t = u.cross(p).dot(w) / det;
      const double r = u.cross(v).dot(p) / det;
      nearest = Vec3::Zero();
      return s >= 0 && t >= 0 && r >= 0 && s + t + r <= 1;
    }
    const Vec3 u = corner[1] - corner[0];
    if (n == 2) {
      const double t = -corner[0].dot(u) / u.squaredNorm();
      nearest = corner[0] + t * u;
      return t >= 0 && t <= 1;
    }
    const Vec3 v = corner[2] - corner[0];
    const Vec3 normal = u.cross(v);
    const double n2 = normal.squaredNorm();
    if (!(n2 > 0)) return false;
    nearest = normal * (normal.dot(corner[0]) / n2);
    const double s = (nearest - corner[0]).cross(v).dot(normal) / n2;
    const double t = u.cross(nearest - corner[0]).dot(normal) / n2;
    return s >= 0 && t >= 0 && s + t <= 1;
  }
};

Vec3 rounded_point(const ExactPair::Rounded& r, const Vec3& direction) {
  std::size_t best = 0;
  double value = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < r.x.size(); ++k) {
    const double d = r.x[k] * direction.x() + r.y[k] * direction.y() + r.z[k] * direction.z();
    if (d > value) {
      value = d;
      best = k;
    }
  }
  return {r.x[best], r.y[best], r.z[best]};
}

/// A guess at the point of P nearest to the origin (Gilbert-Johnson-Keerthi in doubles; never trusted).
Vec3 guess_nearest(const ExactPair& pair) {
  Simplex simplex;
  Vec3 x = pair.rounded_offset() + rounded_point(pair.rounded_b(), Vec3::UnitX()) -
           rounded_point(pair.rounded_a(), Vec3::UnitX());
  simplex.points[simplex.count++] = x;
  for (int step = 0; step < 200; ++step) {
    const Vec3 p = pair.rounded_offset() + rounded_point(pair.rounded_b(), -x) - rounded_point(pair.rounded_a(), x);
    if (x.dot(p) >= x.squaredNorm() * (1 - 0x1p-48)) break;
    if (simplex.count == 4) break;
    simplex.points[simplex.count++] = p;
    const Vec3 next = simplex.reduce();
    if (next.squaredNorm() >= x.squaredNorm()) break;
    x = next;
  }
  return x;
}

/// A face of one body by up to three of its points.
struct Face {
  std::array<int, 3> corner{-1, -1, -1};
  int count = 0;
};

/// The exact minimum between the affine hulls of two faces, when it is unique and inside both.
struct Minimum {
  IVec direction;  ///< from A to B, zero when they meet
  Integer numerator_squared;
  Integer denominator;
};

class FacePairs {
 public:
  explicit FacePairs(const ExactPair& pair) : pair_(pair) {}

  bool minimum(const Face& a, const Face& b, Minimum& result) const {
    if (a.count == 1 && b.count == 1) {
      result.direction = from_a_to_b(a.corner[0], b.corner[0]);
      result.numerator_squared = dot(result.direction, result.direction);
      result.denominator = 1;
      return true;
    }
    if (a.count == 1 && b.count == 2) {
      return point_edge(-from_a_to_b(a.corner[0], b.corner[0]), edge_b(b), false, result);
    }
    if (a.count == 2 && b.count == 1) return point_edge(from_a_to_b(a.corner[0], b.corner[0]), edge_a(a), true, result);
    if (a.count == 2 && b.count == 2) return edge_edge(a, b, result);
    if (a.count == 1 && b.count == 3) {
      const IVec corners[3] = {-from_a_to_b(a.corner[0], b.corner[0]), -from_a_to_b(a.corner[0], b.corner[1]),
                               -from_a_to_b(a.corner[0], b.corner[2])};
      return point_triangle(corners, false, result);
    }
    if (a.count == 3 && b.count == 1) {
      const IVec corners[3] = {from_a_to_b(a.corner[0], b.corner[0]), from_a_to_b(a.corner[1], b.corner[0]),
                               from_a_to_b(a.corner[2], b.corner[0])};
      return point_triangle(corners, true, result);
    }
    return false;
  }

  /// No point of P lies on the origin's side of the plane through the minimum, orthogonal to its direction.
  [[nodiscard]] bool supported(const Face& a, const Face& b, const IVec& direction) const {
    const Integer value = dot(from_a_to_b(a.corner[0], b.corner[0]), direction);
    return -pair_.exact_support(-direction, -to_unit(direction)) == value;
  }

 private:
  [[nodiscard]] IVec from_a_to_b(int i, int j) const { return pair_.offset() + pair_.point_b(j) - pair_.point_a(i); }
  [[nodiscard]] IVec edge_a(const Face& f) const { return pair_.point_a(f.corner[1]) - pair_.point_a(f.corner[0]); }
  [[nodiscard]] IVec edge_b(const Face& f) const { return pair_.point_b(f.corner[1]) - pair_.point_b(f.corner[0]); }

  // w = point - edge start; the direction found runs from the edge to the point.
  static bool point_edge(const IVec& w, const IVec& e, bool edge_is_a, Minimum& m) {
    const Integer along = dot(w, e);
    const Integer e2 = dot(e, e);
    if (along.sign() <= 0 || along >= e2) return false;
    m.direction = w * e2 - e * along;
    if (!edge_is_a) m.direction = -m.direction;
    m.numerator_squared = dot(w, w) * e2 - along * along;
    m.denominator = e2;
    return true;
  }

  bool edge_edge(const Face& a, const Face& b, Minimum& m) const {
    const IVec e = edge_a(a);
    const IVec f = edge_b(b);
    const IVec n = cross(e, f);
    const Integer n2 = dot(n, n);
    if (n2.is_zero()) return false;
    const IVec w = from_a_to_b(a.corner[0], b.corner[0]);
    const Integer s = dot(cross(w, f), n);
    const Integer t = dot(cross(w, e), n);
    if (s.sign() < 0 || s > n2 || t.sign() < 0 || t > n2) return false;
    return along_normal(dot(w, n), n, n2, m);
  }

  // corners: point - corner.
  static bool point_triangle(const IVec (&corners)[3], bool triangle_is_a, Minimum& m) {
    const IVec n = cross(corners[0] - corners[1], corners[0] - corners[2]);
    const Integer n2 = dot(n, n);
    if (n2.is_zero()) return false;
    for (int k = 0; k < 3; ++k) {
      const IVec edge = corners[k] - corners[(k + 1) % 3];
      if (dot(cross(edge, corners[k]), n).sign() < 0) return false;
    }
    Integer height = dot(corners[0], n);
    if (!triangle_is_a) height = -height;
    return along_normal(height, n, n2, m);
  }

  static bool along_normal(const Integer& height, const IVec& n, const Integer& n2, Minimum& m) {
    m.direction = height.sign() > 0 ? n : height.sign() < 0 ? -n : IVec{};
    m.numerator_squared = height * height;
    m.denominator = n2;
    return true;
  }

  const ExactPair& pair_;
};

/// The faces all of whose corners are near. A triangle's corner inside a facet bears no edge and is always let through.
std::vector<Face> faces_within(const Body& body, const std::vector<int>& near) {
  std::vector<char> in(body.exact.size(), 1);
  for (const int v : body.vertices) in[v] = 0;
  for (const int v : near) in[v] = 1;
  std::vector<Face> faces;
  for (const int v : near) faces.push_back({{v, -1, -1}, 1});
  for (const Body::Edge& e : body.edges) {
    if (in[e.from] && in[e.to]) faces.push_back({{e.from, e.to, -1}, 2});
  }
  for (const Body::Triangle& t : body.triangles) {
    if (in[t.corner[0]] && in[t.corner[1]] && in[t.corner[2]]) {
      faces.push_back({{t.corner[0], t.corner[1], t.corner[2]}, 3});
    }
  }
  return faces;
}

}  // namespace

bool exact_distance(const ExactPair& pair, ExactLength& distance) {
  const Vec3 guess = guess_nearest(pair);
  const FacePairs pairs(pair);
  std::vector<int> near_a;
  std::vector<int> near_b;
  if (pair.a().dimension == 0 && pair.b().dimension == 0) {
    const IVec& w = pair.offset();
    distance = pair.length(dot(w, w), 1);
    return true;
  }
  std::size_t tried = 0;
  // Faces near the guessed supporting plane, then ever more, at last all: the certificate decides, not the guess.
  for (double slack = 0x1p-46; tried < 2; slack *= 256) {
    const bool all = slack > 8 || guess.squaredNorm() == 0;
    if (all) {
      near_a = pair.a().vertices;
      near_b = pair.b().vertices;
      ++tried;
    } else {
      const Vec3 unit = guess.normalized();
      pair.near_support(false, unit, slack * pair.magnitude(), near_a);
      pair.near_support(true, -unit, slack * pair.magnitude(), near_b);
    }
    if (near_a.size() * near_b.size() > 4000000) return false;
    const std::vector<Face> faces_a = faces_within(pair.a(), near_a);
    const std::vector<Face> faces_b = faces_within(pair.b(), near_b);
    for (const Face& a : faces_a) {
      for (const Face& b : faces_b) {
        if (a.count + b.count > 4) continue;
        Minimum m;
        if (!pairs.minimum(a, b, m)) continue;
        if (is_zero(m.direction) ? true : pairs.supported(a, b, m.direction)) {
          distance = pair.length(m.numerator_squared, m.denominator);
          return true;
        }
      }
    }
    if (all) return false;
  }
  return false;
}

}  // namespace pd::oracle
