#include "union_contact/cover.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

bool is_flat(const PosedShape& body) {
  const ConvexPolytope* polytope = body.shape->polytope();
  return polytope != nullptr && polytope->affine_dimension() == 2;
}

void Cover::take_own() {
  const UnionPiece* const kept = around_.own();
  const bool known = kept != nullptr && !kept->planes.empty();
  buffers_.own = known ? kept : &buffers_.made;
  if (!known) set_piece(own_, buffers_.made);
}

bool Cover::look_round(const Vec3& foot, const Vec3& n) {
  // The corners of the window's square are farther than its sides; so are flush surfaces of other margins. Of a
  // triangle, only what lies in it is asked about: a deep contact's window holds much more of a mesh.
  const double reach = 1.5 * (own().flat ? std::min(window_, farthest_corner(foot)) : window_) + slack_;
  const Beyond beyond{n, n.dot(foot) + own().margin + 2 * slack_};
  around_.find({foot, reach, slack_}, n.isZero(0) ? nullptr : &beyond, buffers_.found);
  return !buffers_.found.empty();
}

double Cover::farthest_corner(const Vec3& foot) const {
  double squared = 0;
  const ConvexPolytope& triangle = *own_.shape->polytope();
  for (int v = 0; v < triangle.num_vertices(); ++v) {
    squared = std::max(squared, (frame_.place(own_.pose.apply(triangle.vertex(v))) - foot).squaredNorm());
  }
  return std::sqrt(squared);
}

bool Cover::may_be_covered(const Vec3& foot) const {
  // An edge or vertex is covered only where its foot is, which `touched_at` moves by less than this.
  const double reach = 8 * slack_;
  return around_.may_hold({foot, reach, 4 * slack_});
}

double Cover::covered(Vec3 foot, const Vec3& n) {
  const Touched touched = touched_at(foot, n);
  if (!touched.any) return -1;
  double least = kBeyondDoubt;
  if (touched.facet >= 0) {
    if (has_free_corner(foot, n)) return -1;
  } else {
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

FacetCover Cover::cover_of(std::size_t facet) const { return around_.cover_of(facet, 4 * slack_); }

double Cover::most_covered(const Vec3& point, const Vec3& n, double enough) {
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

Cover::Touched Cover::touched_at(Vec3& foot, const Vec3& n) const {
  const std::vector<PiecePlane>& planes = buffers_.own->planes;
  Touched touched;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PiecePlane& plane = planes[i];
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
  for (const PiecePlane& plane : planes) foot -= std::max(plane.height(foot), 0.0) * plane.normal;
  if (touched.facet >= 0) {
    const PiecePlane& facet = planes[static_cast<std::size_t>(touched.facet)];
    foot -= facet.height(foot) * facet.normal;
  }
  return touched;
}

std::array<Vec3, 4> Cover::window_corners(const Vec3& foot, const Vec3& n) const {
  const Vec3 u = n.unitOrthogonal() * window_;
  const Vec3 w = n.cross(u);
  return {foot + u + w, foot - u + w, foot - u - w, foot + u - w};
}

bool Cover::has_free_corner(const Vec3& foot, const Vec3& n) {
  const std::vector<PiecePlane>& planes = buffers_.own->planes;
  const auto corners = window_corners(foot, n);
  return std::any_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
    const auto beyond = [&](const PiecePlane& plane) { return plane.height(corner) > 0.5 * slack_; };
    return std::none_of(planes.begin(), planes.end(), beyond) && most_covered(corner, n, kBeyondDoubt) <= kDecided;
  });
}

void Cover::set_feature(const Touched& touched, const Vec3& foot, const Vec3& n) {
  std::vector<Vec3>& feature = buffers_.feature;
  feature.clear();
  const bool flat = buffers_.own->flat;
  if (touched.facet >= 0) {
    const auto corners = window_corners(foot, n);
    feature.assign(corners.begin(), corners.end());
    clip_to_piece(*buffers_.own, 0.5 * slack_, feature, buffers_.spare);
    return;
  }
  // Of a triangle, its two sides and one edge; of a solid, two facets.
  if (touched.count != (flat ? 3 : 2)) return;
  const PiecePlane* second = flat ? edge_of_triangle(foot) : touched.second;
  Vec3 along = second != nullptr ? Vec3(touched.first->normal.cross(second->normal)) : Vec3(Vec3::Zero());
  if (along.norm() <= kLevel) return;
  along *= window_ / along.norm();
  feature = {foot - along, foot + along};
  clip_to_piece(*buffers_.own, 0.5 * slack_, feature, buffers_.spare);
}

const PiecePlane* Cover::edge_of_triangle(const Vec3& foot) const {
  const std::vector<PiecePlane>& planes = buffers_.own->planes;
  for (std::size_t i = 2; i < planes.size(); ++i) {
    if (planes[i].height(foot) >= -2 * slack_) return &planes[i];
  }
  return nullptr;
}

}  // namespace pd::detail
