/// @file
/// What every engine that enumerates facets of P does with one: its plane bounded in doubles, the class of the contact
/// decided exactly, the nearest handed to `FacetSelection`.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "depth/facets/facet_selection.hpp"
#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/face_sum.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// Bounds of every plane's distance in doubles; the class of the contact, exactly.
class PlaneSearch {
 public:
  PlaneSearch(const OverlayWalk& walk, FacetCandidates& candidates, double upper)
      : walk_(walk), pair_(walk.pair()), a_(walk.buffers().a), b_(walk.buffers().b), nearest_(walk, candidates, upper) {
    PairVector translation;
    translation.translated = true;
    offset_ = pair_.approximate(translation);
    const double error = pair_.vector_error();
    reach_ = (a_.reach + b_.reach + norm1(offset_) + 3 * error) * (1 + 8 * kUnitRoundoff);
    point_error_ = (3 * error + 2 * kUnitRoundoff * reach_) * (1 + 8 * kUnitRoundoff);
    // For edges x, y and n = x x y the error of n is e (|x| + |y| + 2e) + 3u |x||y| per coordinate (1-norms), and that
    // of <point, n> is reach error(n) + |n|_1 (error(point) + 4u reach) + 3 error(n) error(point). With 2 reach
    // error(n) for the length of n, all of it is a polynomial in |x| and |y| whose coefficients belong to the pair.
    const double edge_error = std::max(a_.edge_error, b_.edge_error);
    const double per_normal_error = 3 * reach_ + 3 * point_error_;
    constant_ = (2 * edge_error * edge_error * per_normal_error) * (1 + 16 * kUnitRoundoff) + 0x1p-900;
    linear_ = edge_error * per_normal_error * (1 + 16 * kUnitRoundoff);
    bilinear_ =
        (3 * kUnitRoundoff * per_normal_error + point_error_ + 4 * kUnitRoundoff * reach_) * (1 + 16 * kUnitRoundoff);
    // |vector|_1 of an edge is its size less this, rounded up.
    size_a_ = a_.edge_size * (1 - 4 * kUnitRoundoff);
    size_b_ = b_.edge_size * (1 - 4 * kUnitRoundoff);
    square_upper();
  }

  /// False when the origin lies strictly outside some facet (`piece` is it).
  bool consume(std::span<const OverlayPiece> pieces) {
    visited_ += static_cast<std::int64_t>(pieces.size());
    for (const OverlayPiece& piece : pieces) {
      if (piece.kind == OverlayPiece::Kind::edges && far_edges(piece)) continue;
      if (!consider(piece, evaluate(piece))) return false;
    }
    return true;
  }

  /// Takes a facet whose distance is known to lie in [lower, upper], lower > 0.
  void offer(const OverlayPiece& piece, double lower, double upper) {
    ++visited_;
    if (zero_) return;
    nearest_.offer(piece, lower, upper);
    square_upper();
  }

  /// No facet whose distance is certainly greater need be offered; 0 once a facet through the origin was.
  [[nodiscard]] double upper() const { return zero_ ? 0 : nearest_.upper(); }
  [[nodiscard]] std::int64_t visited() const { return visited_; }
  [[nodiscard]] std::int64_t exact_comparisons() const { return nearest_.exact_comparisons(); }
  [[nodiscard]] bool outside() const { return outside_; }
  [[nodiscard]] bool zero() const { return zero_; }
  /// The separating, touching or nearest piece.
  [[nodiscard]] std::optional<OverlayPiece> piece(bool exactly) {
    return outside_ || zero_ ? std::optional(best_) : nearest_.winner(exactly);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  static double norm1(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }

  /// A facet's plane: offset <point, n> and normal n, neither normalised, with errors of `offset` and of each
  /// coordinate of the normal.
  struct Plane {
    Vec3 normal;
    double normal_error;
    double offset;
    double offset_error;
  };

  /// Error of <point, normal> when their coordinates err by `point_error` and `normal_error` and the sum by `relative`.
  static double offset_error(double point_norm1, double normal_norm1, double point_error, double normal_error,
                             double relative) {
    return (point_norm1 * normal_error + normal_norm1 * point_error + 3 * point_error * normal_error +
            relative * point_norm1 * normal_norm1) *
           (1 + 16 * kUnitRoundoff);
  }

  /// Whether an edge-edge plane is certainly farther than the nearest one, by one comparison of squares.
  bool far_edges(const OverlayPiece& piece) const {
    const PosedDiagram::Edge& x = b_.half_edges[static_cast<std::size_t>(piece.b)];
    const PosedDiagram::Edge& y = a_.half_edges[static_cast<std::size_t>(piece.a)];
    const Vec3& on_b = b_.points[static_cast<std::size_t>(pair_.b().half_edge(piece.b).origin)];
    const Vec3& on_a = a_.points[static_cast<std::size_t>(pair_.a().half_edge(piece.a).origin)];
    const double n0 = x.vector[1] * y.vector[2] - x.vector[2] * y.vector[1];
    const double n1 = x.vector[2] * y.vector[0] - x.vector[0] * y.vector[2];
    const double n2 = x.vector[0] * y.vector[1] - x.vector[1] * y.vector[0];
    const double offset = (on_b.x() - on_a.x() + offset_.x()) * n0 + (on_b.y() - on_a.y() + offset_.y()) * n1 +
                          (on_b.z() - on_a.z() + offset_.z()) * n2;
    const double sx = x.size - size_b_, sy = y.size - size_a_;
    const double least = offset - (constant_ + linear_ * (sx + sy) + bilinear_ * (sx * sy));
    return least > 0 && least * least > upper_squared_ * (n0 * n0 + n1 * n1 + n2 * n2) + 0x1p-900;
  }

  Plane evaluate(const OverlayPiece& piece) const {
    Plane plane;
    int va = piece.a, vb = piece.b;
    switch (piece.kind) {
      case OverlayPiece::Kind::facet_of_a: {
        const PosedDiagram::Facet& f = a_.facets[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(-f.normal[0], -f.normal[1], -f.normal[2]);
        plane.normal_error = a_.normal_errors[static_cast<std::size_t>(piece.a)];
        va = pair_.a().facet_vertices(piece.a)[0];
        break;
      }
      case OverlayPiece::Kind::facet_of_b: {
        const PosedDiagram::Facet& f = b_.facets[static_cast<std::size_t>(piece.b)];
        plane.normal = Vec3(f.normal[0], f.normal[1], f.normal[2]);
        plane.normal_error = b_.normal_errors[static_cast<std::size_t>(piece.b)];
        vb = pair_.b().facet_vertices(piece.b)[0];
        break;
      }
      case OverlayPiece::Kind::edges: {
        const PosedDiagram::Edge& x = b_.half_edges[static_cast<std::size_t>(piece.b)];
        const PosedDiagram::Edge& y = a_.half_edges[static_cast<std::size_t>(piece.a)];
        plane.normal = Vec3(x.vector[1] * y.vector[2] - x.vector[2] * y.vector[1],
                            x.vector[2] * y.vector[0] - x.vector[0] * y.vector[2],
                            x.vector[0] * y.vector[1] - x.vector[1] * y.vector[0]);
        const double e = std::max(a_.edge_error, b_.edge_error);
        const double sx = x.size - size_b_, sy = y.size - size_a_;
        plane.normal_error = (e * (sx + sy + 2 * e) + 3 * kUnitRoundoff * sx * sy) * (1 + 8 * kUnitRoundoff);
        va = pair_.a().half_edge(piece.a).origin;
        vb = pair_.b().half_edge(piece.b).origin;
      }
    }
    const Vec3 point = b_.points[static_cast<std::size_t>(vb)] - a_.points[static_cast<std::size_t>(va)] + offset_;
    plane.offset = point.dot(plane.normal);
    plane.offset_error =
        offset_error(norm1(point), norm1(plane.normal), point_error_, plane.normal_error, 4 * kUnitRoundoff) + 0x1p-900;
    return plane;
  }

  bool consider(const OverlayPiece& piece, const Plane& plane) {
    const double length = std::sqrt(plane.normal.squaredNorm());
    const double longest = length * (1 + 8 * kUnitRoundoff) + 2 * plane.normal_error;
    const double shortest = length * (1 - 8 * kUnitRoundoff) - 2 * plane.normal_error;
    if (plane.offset > plane.offset_error && shortest > 0) {
      if (zero_) return true;
      nearest_.offer(piece, (plane.offset - plane.offset_error) * (1 - 4 * kUnitRoundoff) / longest,
                     (plane.offset + plane.offset_error) * (1 + 4 * kUnitRoundoff) / shortest);
      square_upper();
      return true;
    }
    // Doubles know neither sign nor length. A piece that only cuts another one's plane (or has no area) adds nothing.
    if (piece.kind != OverlayPiece::Kind::facet_of_a && !whole_facet(walk_, piece)) return true;
    int sign = 1;
    if (!(plane.offset > plane.offset_error)) {
      const FacetOfDifference facet = facet_of(pair_, piece);
      sign = pair_.sign_determinant(facet.point(), facet.u, facet.v);
    }
    if (sign < 0) {
      outside_ = true;
      best_ = piece;
      return false;
    }
    if (sign == 0) {
      if (!zero_ || compare_rank(pair_, piece, best_) < 0) best_ = piece;
      zero_ = true;
      return true;
    }
    if (zero_) return true;
    const double upper =
        shortest > 0 ? (plane.offset + plane.offset_error) * (1 + 4 * kUnitRoundoff) / shortest : kInfinity;
    nearest_.offer(piece, 0, std::max(upper, 0.0));
    square_upper();
    return true;
  }

  /// Below the reach, as the error polynomial of `far_edges` requires.
  void square_upper() { upper_squared_ = upper() <= reach_ ? upper() * upper() * (1 + 64 * kUnitRoundoff) : kInfinity; }

  const OverlayWalk& walk_;
  const PosedPair& pair_;
  const PosedDiagram& a_;
  const PosedDiagram& b_;
  Vec3 offset_;
  double reach_;
  double point_error_;
  double constant_;
  double linear_;
  double bilinear_;
  double size_a_;
  double size_b_;
  FacetSelection nearest_;
  double upper_squared_ = kInfinity;
  bool outside_ = false;
  bool zero_ = false;
  OverlayPiece best_{};
  std::int64_t visited_ = 0;
};

}  // namespace pd::detail
