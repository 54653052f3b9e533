#include "solid/solid_contact.hpp"

#include <vector>

#include "solid/triangle_meeting.hpp"
#include "solid/winding.hpp"

namespace pd::detail {

namespace {

class ContactSearch {
 public:
  explicit ContactSearch(const PosedSolids& solids)
      : solids_(solids),
        running_along_{std::vector<char>(static_cast<std::size_t>(solids.solid(Body::a).num_shells()), 0),
                       std::vector<char>(static_cast<std::size_t>(solids.solid(Body::b).num_shells()), 0)} {}

  SolidContact run() {
    visit(0, 0);
    if (found_.contact != ContactClass::overlapping && (lies_inside(Body::a) || lies_inside(Body::b))) {
      found_.contact = ContactClass::overlapping;
      found_.triangle_a = found_.triangle_b = -1;
    }
    return found_;
  }

 private:
  [[nodiscard]] const TriangleNode& node(Body body, std::int32_t at) const {
    return solids_.solid(body).nodes()[static_cast<std::size_t>(at)];
  }

  void visit(std::int32_t at_a, std::int32_t at_b) {
    if (found_.contact == ContactClass::overlapping) return;
    const TriangleNode &a = node(Body::a, at_a), &b = node(Body::b, at_b);
    const TriangleBox box_a = solids_.box(Body::a, a), box_b = solids_.box(Body::b, b);
    if (!box_a.meets(box_b)) return;
    if (a.is_leaf() && b.is_leaf()) {
      for (std::int32_t s = a.first; s < a.last; ++s) {
        for (std::int32_t t = b.first; t < b.last; ++t) test(s, t);
      }
      return;
    }
    const bool split_a =
        !a.is_leaf() && (b.is_leaf() || (box_a.high - box_a.low).maxCoeff() >= (box_b.high - box_b.low).maxCoeff());
    if (split_a) {
      visit(a.left, at_b);
      visit(a.right, at_b);
    } else {
      visit(at_a, b.left);
      visit(at_a, b.right);
    }
  }

  void test(std::int32_t s, std::int32_t t) {
    if (found_.contact == ContactClass::overlapping) return;
    ++found_.pairs;
    const Meeting meeting = meeting_of(solids_, s, t);
    if (meeting == Meeting::apart) return;
    if (meeting == Meeting::overlap || meeting == Meeting::arc || found_.triangle_a < 0) {
      found_.triangle_a = s;
      found_.triangle_b = t;
    }
    found_.contact = meeting == Meeting::overlap ? ContactClass::overlapping : ContactClass::touching;
    if (meeting != Meeting::arc) return;
    running_along_[0][static_cast<std::size_t>(solids_.solid(Body::a).triangle(s).shell)] = 1;
    running_along_[1][static_cast<std::size_t>(solids_.solid(Body::b).triangle(t).shell)] = 1;
  }

  /// True if a shell lies in the other's interior but for finitely many points. One that runs along the other's surface
  /// somewhere does not, or the meeting there would have told an overlap.
  bool lies_inside(Body body) {
    std::vector<char> known = running_along_[body == Body::a ? 0 : 1];
    const auto& triangles = solids_.solid(body).triangles();
    for (const MeshSolid::Triangle& triangle : triangles) {
      char& told = known[static_cast<std::size_t>(triangle.shell)];
      if (told != 0) continue;
      told = 1;
      if (inside(body, triangle)) return true;
    }
    return false;
  }

  /// The place of a point of the triangle that does not lie on the other's surface. Each of the other's triangles meets
  /// this one in one point at most, or the shell would run along it. One sample more than the other has triangles
  /// therefore tells.
  [[nodiscard]] bool inside(Body body, const MeshSolid::Triangle& triangle) const {
    const auto place_of = [&](std::int32_t second, int shift) {
      const std::int32_t whole = std::int32_t{1} << shift;
      return place_in(solids_, other(body),
                      solids_.mean(body, triangle.vertices, {whole - second - 1, second, 1}, shift));
    };
    PointPlace place = place_in(solids_, other(body), solids_.point(body, triangle.vertices[0]));
    for (int shift = 2; place.on_surface && shift < 24; ++shift) place = place_of(1, shift);
    const std::size_t samples = solids_.solid(other(body)).triangles().size();
    for (std::size_t k = 0; place.on_surface && k <= samples; ++k)
      place = place_of(static_cast<std::int32_t>(k) + 2, 30);
    return !place.on_surface && place.winding > 0;
  }

  const PosedSolids& solids_;
  std::array<std::vector<char>, 2> running_along_;
  SolidContact found_;
};

}  // namespace

SolidContact contact_of(const PosedSolids& solids) { return ContactSearch(solids).run(); }

}  // namespace pd::detail
