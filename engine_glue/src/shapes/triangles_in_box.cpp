#include "shapes/triangles_in_box.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

class Collector : public btTriangleCallback {
 public:
  Collector(const btVector3& lower, const btVector3& upper, double margin)
      : lower_(lower), upper_(upper), margin_(margin) {}

  void processTriangle(btVector3* corners, int part, int index) override {
    // A tree of quantised boxes, and heightfields, offer more than what the box meets.
    const auto margin = static_cast<btScalar>(margin_);
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      if (low - margin > upper_[axis] || high + margin < lower_[axis]) return;
    }
    const std::array points{to_pd(corners[0]), to_pd(corners[1]), to_pd(corners[2])};
    auto hull = ConvexPolytope::from_points(points);
    if (!hull) return;
    auto shape = ConvexShape(std::move(hull).value()).with_margin(margin_);
    if (shape) triangles.push_back({std::make_shared<const ConvexShape>(std::move(shape).value()), part, index});
  }

  std::vector<BoxedTriangle> triangles;

 private:
  btVector3 lower_;
  btVector3 upper_;
  double margin_;
};

}  // namespace

std::vector<BoxedTriangle> triangles_in_box(const btConcaveShape& concave, const btVector3& lower,
                                            const btVector3& upper) {
  // A plane has no margin in Bullet's contacts; a mesh's triangles have its own.
  const bool plane = concave.getShapeType() == STATIC_PLANE_PROXYTYPE;
  Collector collector(lower, upper, plane ? 0 : static_cast<double>(concave.getMargin()));
  concave.processAllTriangles(&collector, lower, upper);
  return std::move(collector.triangles);
}

}  // namespace pd::detail
