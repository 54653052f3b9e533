#include "depth/facets/aligned_boxes.hpp"

#include "depth/facets/box_sat.hpp"

namespace pd::detail {

namespace {

/// Vertices are in lexicographic order: the first has the least coordinates, the last the greatest.
constexpr int kFirst = 0, kLast = 7;

/// The vertex of either end that is farthest in the direction `sign` of the frame's axis.
int end_vertex(const PosedPair::OwnCoordinate& along, double sign) { return along.sign * sign > 0 ? kLast : kFirst; }

bool less(const DoubleDouble& x, const DoubleDouble& y) { return x.hi < y.hi || (x.hi == y.hi && x.lo < y.lo); }

}  // namespace

AlignedBoxes nearest_of_aligned_boxes(const PosedPair& pair, ProvenFacet& nearest, SupportFaces& faces) {
  DoubleDouble least;
  int axis = -1;
  double sign = 0;
  bool tied = false;
  for (int k = 0; k < 3; ++k) {
    if (!pair.has_own_coordinate(k)) return AlignedBoxes::other;
  }
  for (int k = 0; k < 3; ++k) {
    const PosedPair::OwnCoordinate &of_a = pair.own_coordinate_a(k), &of_b = pair.own_coordinate_b(k);
    for (const double s : {1.0, -1.0}) {
      const PairVector corner = PairVector::point(end_vertex(of_a, -s), end_vertex(of_b, s));
      DoubleDouble height;
      if (!pair.exact_coordinate(corner, k, height)) return AlignedBoxes::other;
      if (s < 0) height = -height;
      if (!(height.hi > 0)) return AlignedBoxes::tied;
      if (axis >= 0 && !less(height, least)) {
        tied = tied || !less(least, height);
        continue;
      }
      least = height;
      axis = k;
      sign = s;
      tied = false;
    }
  }
  if (tied) return AlignedBoxes::tied;
  const PosedPair::OwnCoordinate &of_a = pair.own_coordinate_a(axis), &of_b = pair.own_coordinate_b(axis);
  const int a = end_vertex(of_a, -sign), b = end_vertex(of_b, sign);
  nearest.facet = FacetOfDifference::from_facet_of_b(pair.b(), facet_of_box(pair.b(), of_b.axis, b == kLast), a);
  nearest.plane = plane_across_axis(axis, sign, sign > 0 ? least : -least);
  collect_box_face(7 & ~(4 >> of_a.axis), a, faces.on_a);
  collect_box_face(7 & ~(4 >> of_b.axis), b, faces.on_b);
  return AlignedBoxes::found;
}

}  // namespace pd::detail
