#include "depth/expansion/exact_expanding_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "depth/expansion/tetrahedron.hpp"

namespace pd::detail {

namespace {

struct Face {
  std::int32_t v[3];
  std::int32_t adj[3];
  double lower;  ///< bounds of the signed distance of the plane, scaled lengths
  double upper;
  bool alive;
  bool facet;  ///< known to support P
};

/// A vertex of P and, once it was asked for, its exact place.
struct Vertex : VertexPair {
  explicit Vertex(const VertexPair& id) : VertexPair(id) {}
  std::optional<Dyadic3> exact;
};

class Hull {
 public:
  explicit Hull(const PosedPair& pair) : pair_(pair) {}

  std::vector<Vertex> vertices;
  std::vector<Face> faces;

  [[nodiscard]] PairVector edge(int from, int to) const {
    return PairVector::difference(vertices[from].a, vertices[from].b, vertices[to].a, vertices[to].b);
  }
  [[nodiscard]] PairVector point(int v) const { return PairVector::point(vertices[v].a, vertices[v].b); }

  /// Times the pair's homogeneous factor.
  [[nodiscard]] const Dyadic3& exact_point(int v) {
    std::optional<Dyadic3>& exact = vertices[v].exact;
    if (!exact) exact = pair_.exact(point(v));
    return *exact;
  }
  [[nodiscard]] Dyadic3 exact_edge(int from, int to) { return exact_point(to) - exact_point(from); }

  /// Side of vertex v against the plane of face f: +1 outside.
  [[nodiscard]] int side(int f, int v) {
    const Face& face = faces[f];
    const std::optional<int> rounded =
        pair_.sign_determinant_rounded(edge(face.v[0], v), edge(face.v[0], face.v[1]), edge(face.v[0], face.v[2]));
    return rounded ? *rounded : dot(exact_normal(f), exact_edge(face.v[0], v)).sign();
  }
  /// Of a face that is alive; outward.
  [[nodiscard]] const Dyadic3& exact_normal(int f) {
    normals_.resize(faces.size());
    std::optional<Dyadic3>& normal = normals_[f];
    if (!normal) normal = cross(exact_edge(faces[f].v[0], faces[f].v[1]), exact_edge(faces[f].v[0], faces[f].v[2]));
    return *normal;
  }

  int add_face(int a, int b, int c) {
    Face f{{a, b, c}, {-1, -1, -1}, 0, 0, true, false};
    set_bounds(f);
    if (!free_.empty()) {
      const int slot = free_.back();
      free_.pop_back();
      faces[slot] = f;
      if (slot < static_cast<int>(normals_.size())) normals_[slot].reset();
      return slot;
    }
    faces.push_back(f);
    return static_cast<int>(faces.size()) - 1;
  }

  void start() {
    const int order = pair_.sign_determinant(edge(0, 3), edge(0, 1), edge(0, 2));
    if (order > 0) std::swap(vertices[1], vertices[2]);
    for (int f = 0; f < 4; ++f) {
      add_face(kTetrahedronFaces[f][0], kTetrahedronFaces[f][1], kTetrahedronFaces[f][2]);
      for (int e = 0; e < 3; ++e) faces[f].adj[e] = kTetrahedronBeyond[f][e].face;
    }
  }

  /// Replaces the faces strictly below vertex v, `from` among them. Exact sides of a convex surface: always a disc; no
  /// new triangle is degenerate, since v would have to lie on the line of an edge of a face visible from it.
  void insert(int from, int v) {
    struct Visit {
      int face, edge, left;
    };
    struct Horizon {
      int face, edge, from, to;
    };
    std::vector<Visit> visits{{from, 0, 3}};
    std::vector<Horizon> horizon;
    std::vector<int> removed{from};
    faces[from].alive = false;
    while (!visits.empty()) {
      Visit& visit = visits.back();
      if (visit.left == 0) {
        visits.pop_back();
        continue;
      }
      const int f = visit.face;
      const int e = visit.edge;
      visit.edge = (e + 1) % 3;
      --visit.left;
      const int g = faces[f].adj[e];
      if (!faces[g].alive) continue;
      int entered = 0;
      while (faces[g].adj[entered] != f || faces[g].v[(entered + 1) % 3] != faces[f].v[e]) ++entered;
      if (side(g, v) > 0) {
        faces[g].alive = false;
        removed.push_back(g);
        visits.push_back({g, (entered + 1) % 3, 2});
      } else {
        horizon.push_back({g, entered, faces[f].v[e], faces[f].v[(e + 1) % 3]});
      }
    }
    free_.insert(free_.end(), removed.begin(), removed.end());
    std::vector<int> fan;
    for (const Horizon& h : horizon) {
      const int f = add_face(h.from, h.to, v);
      faces[f].adj[0] = h.face;
      faces[h.face].adj[h.edge] = f;
      fan.push_back(f);
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const std::size_t j = i + 1 == fan.size() ? 0 : i + 1;
      faces[fan[i]].adj[1] = fan[j];
      faces[fan[j]].adj[2] = fan[i];
    }
  }

 private:
  void set_bounds(Face& f) const {
    const Vec3DD p = pair_.approximate_dd(point(f.v[0]));
    const Vec3DD u = pair_.approximate_dd(edge(f.v[0], f.v[1]));
    const Vec3DD v = pair_.approximate_dd(edge(f.v[0], f.v[2]));
    const Vec3DD n = cross(u, v);
    const DoubleDouble squared = dot(n, n);
    // The determinant <p, u x v> and the normal, each with the errors of its arguments and of double-double products.
    const double e = pair_.vector_error_dd();
    const double a = norm1(p) + 3 * e, b = norm1(u) + 3 * e, c = norm1(v) + 3 * e;
    const double volume_error = 64 * 0x1p-104 * a * b * c + 2 * e * (b * c + a * c + a * b) + 0x1p-900;
    const double normal_error = 64 * 0x1p-104 * b * c + 4 * e * (b + c) + 0x1p-900;
    const double length = std::sqrt(squared.hi);
    if (!(length > 1e6 * normal_error)) {
      f.lower = -std::numeric_limits<double>::infinity();
      f.upper = std::numeric_limits<double>::infinity();
      return;
    }
    const DoubleDouble distance = dot(p, n) / sqrt(squared);
    const double error = 2 * (volume_error + std::abs(distance.hi) * normal_error) / length;
    const double value = to_double(distance);
    const double slack = error + std::abs(value) * 0x1p-52;
    f.lower = value - slack;
    f.upper = value + slack;
  }

  const PosedPair& pair_;
  std::vector<int> free_;
  std::vector<std::optional<Dyadic3>> normals_;  ///< of faces, once they were asked for
};

VertexPair support(const PosedPair& pair, const ExactDirection& direction) {
  return {support_face_a(pair, direction).front(), support_face_b(pair, direction).front()};
}

/// @param scale  lengths of the pair's own are the caller's over this.
void report(const SearchWatch& watch, const PosedPair& pair, const Hull& hull, int number, int nearest,
            const ExactDirection& direction, double upper, const VertexPair& support, double scale) {
  SurfaceSnapshot snapshot;
  const auto place = [&](const VertexPair& id) {
    const Vec3DD x = pair.approximate_dd(PairVector::point(id.a, id.b));
    return Vec3(scale * to_double(x.x), scale * to_double(x.y), scale * to_double(x.z));
  };
  for (const VertexPair& id : hull.vertices) snapshot.points.push_back(place(id));
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Face& face = hull.faces[f];
    if (!face.alive) continue;
    if (static_cast<int>(f) == nearest) snapshot.nearest = static_cast<int>(snapshot.faces.size());
    snapshot.faces.push_back({{face.v[0], face.v[1], face.v[2]}, {-1, -1, -1}, Vec3::Zero(), scale * face.lower});
  }
  report_step(watch, kExactArithmetic, number, snapshot, scale * hull.faces[nearest].lower, scale * upper,
              direction.unit, place(support));
}

/// Finds four affinely independent vertices of P, or shows that P is flat (false).
bool full_dimensional(const PosedPair& pair, Hull& hull, std::int64_t& support_calls,
                      std::optional<ExactDirection>& flat) {
  const auto independent = [&](const VertexPair& id) {
    const std::vector<Vertex>& v = hull.vertices;
    const auto difference = [&](const VertexPair& to) { return PairVector::difference(v[0].a, v[0].b, to.a, to.b); };
    if (v.empty()) return true;
    const PairVector d = difference(id);
    if (v.size() == 1) {
      const Dyadic3 e = pair.exact(d);
      return e.x.sign() != 0 || e.y.sign() != 0 || e.z.sign() != 0;
    }
    if (v.size() == 2) return !pair.parallel(d, difference(v[1]));
    return pair.sign_determinant(d, difference(v[1]), difference(v[2])) != 0;
  };
  std::vector<Vertex> given;
  given.swap(hull.vertices);
  for (const Vertex& id : given) {
    if (hull.vertices.size() < 4 && independent(id)) hull.vertices.push_back(id);
  }
  while (hull.vertices.size() < 4) {
    const std::vector<Vertex>& v = hull.vertices;
    // Directions normal to what is spanned, enough to find anything outside it.
    std::vector<Dyadic3> directions;
    const Dyadic one(1.0), zero(0.0);
    const std::array<Dyadic3, 3> axes{Dyadic3{one, zero, zero}, Dyadic3{zero, one, zero}, Dyadic3{zero, zero, one}};
    if (v.size() <= 1) {
      directions.assign(axes.begin(), axes.end());
    } else if (v.size() == 2) {
      const Dyadic3 e = pair.exact(hull.edge(0, 1));
      for (const Dyadic3& axis : axes) directions.push_back(cross(e, axis));
    } else {
      directions.push_back(cross(pair.exact(hull.edge(0, 1)), pair.exact(hull.edge(0, 2))));
    }
    bool found = false;
    for (const Dyadic3& d : directions) {
      if (d.x.sign() == 0 && d.y.sign() == 0 && d.z.sign() == 0) continue;
      for (const int sign : {1, -1}) {
        const ExactDirection direction(sign > 0 ? d : Dyadic3{-d.x, -d.y, -d.z});
        ++support_calls;
        const VertexPair s = support(pair, direction);
        if (independent(s)) {
          hull.vertices.emplace_back(s);
          found = true;
          break;
        }
        flat = direction;
      }
      if (found) break;
    }
    if (!found) return false;
  }
  return true;
}

/// The nearest face that is not known to support P, -1 when all are.
int nearest_candidate(const Hull& hull) {
  int nearest = -1;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Face& face = hull.faces[f];
    if (face.alive && !face.facet && (nearest < 0 || face.lower < hull.faces[nearest].lower)) {
      nearest = static_cast<int>(f);
    }
  }
  return nearest;
}

/// Takes a facet of P into account. True where its plane passes through the origin: touching (the origin is known to
/// lie in P, so never beyond it).
bool rank_facet(const PosedPair& pair, Hull& hull, int facet, const ExactDirection& direction, ExactDepth& result) {
  const Dyadic3& normal = hull.exact_normal(facet);
  const Dyadic height = dot(normal, hull.exact_point(hull.faces[facet].v[0]));
  if (height.sign() <= 0) {
    result.contact = ContactClass::touching;
    result.normal = direction;
    return true;
  }
  const SquaredRatio squared{height * height,
                             dot(normal, normal) * pair.homogeneous_factor() * pair.homogeneous_factor()};
  if (!result.normal || compare(squared, result.squared) < 0) {
    result.normal = direction;
    result.squared = squared;
  }
  return false;
}

void report_outcome(const SearchWatch& watch, const ExactDepth& result, double lower, double upper) {
  ExpansionResult end;
  end.status = !result.complete                              ? ExpansionStatus::over_budget
               : result.contact == ContactClass::overlapping ? ExpansionStatus::certified
                                                             : ExpansionStatus::touching;
  end.lower = end.status == ExpansionStatus::touching ? 0 : lower;
  end.upper = end.status == ExpansionStatus::touching ? 0 : upper;
  if (result.normal) end.normal = result.normal->unit;
  report_end(watch, kExactArithmetic, end);
}

}  // namespace

ExactDepth exact_expanding_polytope(const PosedPair& pair, const VertexPair* simplex, int count, int budget,
                                    const SearchWatch& watch) {
  ExactDepth result;
  Hull hull(pair);
  // 1. and 2.
  for (int i = 0; i < count; ++i) hull.vertices.emplace_back(simplex[i]);
  if (!full_dimensional(pair, hull, result.support_calls, result.normal)) return result;  // flat: at most touching
  result.normal.reset();
  hull.start();

  const double scale = std::ldexp(1.0, pair.scale_exponent());
  bool touching = false;
  double best_lower = 0;
  double best_upper = std::numeric_limits<double>::infinity();
  // Each pass inserts a vertex of P or finds a face to be a facet for good.
  for (int step = 0;; ++step) {
    // 3.
    const int nearest = nearest_candidate(hull);
    if (nearest < 0 || hull.faces[nearest].lower > best_upper) break;
    ++result.facets_visited;
    Face& face = hull.faces[nearest];
    const ExactDirection direction(hull.exact_normal(nearest));
    result.complete = result.support_calls < budget;
    if (!result.complete) break;
    // 5.
    ++result.support_calls;
    const VertexPair s = support(pair, direction);
    if (watch) report(watch, pair, hull, step, nearest, direction, best_upper, s, scale);
    hull.vertices.emplace_back(s);
    const int v = static_cast<int>(hull.vertices.size()) - 1;
    // 9.
    if (hull.side(nearest, v) > 0) {
      hull.insert(nearest, v);
      continue;
    }
    // 7.
    hull.vertices.pop_back();
    face.facet = true;
    touching = rank_facet(pair, hull, nearest, direction, result);
    if (touching) break;
    if (face.upper < best_upper) {
      best_lower = face.lower;
      best_upper = face.upper;
    }
  }
  if (result.complete && !touching) result.contact = ContactClass::overlapping;
  if (watch) report_outcome(watch, result, scale * best_lower, scale * best_upper);
  return result;
}

}  // namespace pd::detail
