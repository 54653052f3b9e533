#include "union/plane_contacts.hpp"

#include <vector>

#include "pair/plane_ground.hpp"
#include "pair/solver_core.hpp"
#include "pieces/compound_facts.hpp"
#include "shapes/compound_children.hpp"
#include "union/pieces_in_result.hpp"

namespace pd::detail {

namespace {

class PlaneContacts final : public UnionContacts {
 public:
  bool find(const UnionQuestion& question, Patches& patches) override;
  [[nodiscard]] PointPieces pieces_of(int child) const override { return {children_[static_cast<std::size_t>(child)]}; }

 private:
  std::vector<Child> children_;
};

bool PlaneContacts::find(const UnionQuestion& question, Patches& patches) {
  ThreadBuffers& buffers = question.buffers;
  const btCollisionObjectWrapper& compound = question.a;
  const btCollisionObjectWrapper& plane = question.b;
  children_.clear();
  if (!is_finite(compound.getWorldTransform()) || !is_finite(plane.getWorldTransform())) return true;
  if (!all_children(compound, *plane.getCollisionShape(), children_)) return false;
  const Halfspace3 ground = ground_of(plane);
  const auto threshold = static_cast<double>(question.threshold);
  buffers.near.begin_pair(question.stamp);
  look_at(question.a, children_, buffers.near.facts(), question.core.cache);
  for (std::size_t i = 0; i < children_.size(); ++i) {
    const Child& child = children_[i];
    const auto& shape = static_cast<const btConvexShape&>(*child.shape);
    if (box_above(shape, child.pose, ground, threshold)) continue;
    std::shared_ptr<CachedShape>& known = question.memory.shape_of_child(0, child.index);
    HalfspaceContact found;
    const GroundQuestion asked{.body = shape,
                               .pose = child.pose,
                               .ground = ground,
                               .stamp = question.stamp,
                               .shape = known,
                               .threshold = threshold,
                               .sharp_box = true};
    const SolverCore::Outcome outcome = question.core.stand_on(asked, buffers, found);
    if (outcome == SolverCore::Outcome::unsupported) return false;
    if (outcome != SolverCore::Outcome::answered || found.manifold.count == 0) continue;
    const ChildInResult piece(question.result, compound, child);
    if (is_piece(piece.wrapper())) {
      const PosedShape posed{(known->sharp ? known->sharp : known->body).get(), to_pd(child.pose)};
      AskedPieces pieces = question.of_pieces(piece.wrapper(), plane);
      count_covered(drop_covered(pieces.as(posed, posed), found.manifold), buffers);
    }
    patches.add(found.manifold, static_cast<int>(i), child.index, -1);
  }
  return true;
}

}  // namespace

std::unique_ptr<UnionContacts> plane_contacts() { return std::make_unique<PlaneContacts>(); }

}  // namespace pd::detail
