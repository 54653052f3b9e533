#include "c_interface/answers.hpp"

#include <optional>
#include <utility>

#include "pd/compound/compound_depth.hpp"
#include "pd/contact/finite_answer.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/derivatives.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/solid/solid_depth.hpp"

namespace pd::c_interface {

namespace {

/// The memory of a pair while one thread uses it.
class PairUse {
 public:
  explicit PairUse(pdepth_pair* pair) : pair_(pair) {
    if (pair != nullptr && pair->in_use.exchange(true, std::memory_order_acquire)) {
      refuse(PDEPTH_IN_USE, "another thread uses the pair, or it stands in two rows", "pair");
    }
  }
  ~PairUse() {
    if (pair_ != nullptr) pair_->in_use.store(false, std::memory_order_release);
  }
  PairUse(const PairUse&) = delete;
  PairUse& operator=(const PairUse&) = delete;

  [[nodiscard]] WarmCertificate* certificate() const { return pair_ == nullptr ? nullptr : &pair_->certificate; }
  [[nodiscard]] WarmUnion* of_unions() const { return pair_ == nullptr ? nullptr : &pair_->of_unions; }

 private:
  pdepth_pair* pair_;
};

PenetrationDepth convex_depth(const Question& question, Workspace& space) {
  require_supported(question);
  const PairUse memory(question.pair);
  return penetration_depth(question.posed_a, question.posed_b, space.scratch, question.settings.depth,
                           memory.certificate());
}

void require_automatic(const Question& question) {
  if (question.settings.depth.method == Method::automatic) return;
  refuse(PDEPTH_UNSUPPORTED, "compounds and solids are answered by PDEPTH_METHOD_AUTOMATIC", "settings.method");
}

UnionDepth union_depth(const Question& question, Workspace& space) {
  require_automatic(question);
  const PairUse memory(question.pair);
  return value_of(penetration_depth(PosedCompound{&question.a.whole("question.a"), question.posed_a.pose},
                                    PosedCompound{&question.b.whole("question.b"), question.posed_b.pose},
                                    space.scratch, question.settings.of_unions, memory.of_unions()),
                  "question");
}

const MeshSolid* solid_mesh(const pdepth_shape& shape) { return shape.solid ? &shape.solid->mesh() : nullptr; }

/// True for convex shapes with an interior. A union, and a polytope that is flat, is asked as parts.
bool stands_beside_solid(const pdepth_shape& body) {
  const ConvexShape* const shape = body.convex();
  if (shape == nullptr) return false;
  return shape->polytope() == nullptr || shape->margin() > 0 || shape->polytope()->affine_dimension() == 3;
}

/// @param face  of a SolidDepth. Faces of polytopes are their facets.
pdepth_feature face_feature(const pdepth_shape& body, std::int32_t face) {
  if (face < 0) return {PDEPTH_FEATURE_NONE, 0, -1, -1};
  return {PDEPTH_FEATURE_FACET, body.solid ? PDEPTH_PART_MESH : 0, face, -1};
}

/// Two meshes, or a mesh and a convex shape. False where neither body is a mesh, or one is asked as parts, so that
/// nothing was asked.
bool answered_by_meshes(const Question& question, Workspace& space, pdepth_answer& out) {
  const MeshSolid *const mesh_a = solid_mesh(question.a), *const mesh_b = solid_mesh(question.b);
  const bool shape_a = mesh_a == nullptr && stands_beside_solid(question.a);
  const bool shape_b = mesh_b == nullptr && stands_beside_solid(question.b);
  if (mesh_a == nullptr && mesh_b == nullptr) return false;
  if ((mesh_a == nullptr && !shape_a) || (mesh_b == nullptr && !shape_b)) return false;
  require_automatic(question);
  const auto depth_of = [&](const auto& a, const auto& b) {
    return value_of(penetration_depth(a, b, space.scratch, question.settings.of_solids), "question");
  };
  const PosedShape &a = question.posed_a, &b = question.posed_b;
  const SolidDepth found = shape_b   ? depth_of(PosedSolid{mesh_a, a.pose}, PosedShape{question.b.convex(), b.pose})
                           : shape_a ? depth_of(PosedShape{question.a.convex(), a.pose}, PosedSolid{mesh_b, b.pose})
                                     : depth_of(PosedSolid{mesh_a, a.pose}, PosedSolid{mesh_b, b.pose});
  write_depth(found, out);
  out.feature_a = face_feature(question.a, found.face_a);
  out.feature_b = face_feature(question.b, found.face_b);
  return true;
}

void write_gradient(const PoseGradient& gradient, double (&out)[6]) {
  write_vector(gradient.translation, out);
  write_vector(gradient.rotation, out + 3);
}

void write_jacobian(const PoseJacobian& jacobian, double (&out)[18]) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      out[6 * i + k] = jacobian.translation(i, k);
      out[6 * i + 3 + k] = jacobian.rotation(i, k);
    }
  }
}

}  // namespace

pdepth_feature feature_of(const Feature& feature, std::int32_t part) {
  static_assert(static_cast<int>(Feature::Kind::facet) == PDEPTH_FEATURE_FACET);
  return {static_cast<std::int32_t>(feature.kind), part, feature.first, feature.second};
}

void write_depth(const PenetrationDepth& answer, pdepth_answer& out) {
  static_assert(static_cast<int>(ContactClass::overlapping) == PDEPTH_OVERLAPPING);
  require_finite(is_finite(answer));
  out.status = PDEPTH_OK;
  out.contact = static_cast<std::int32_t>(answer.contact);
  out.method = static_cast<std::int32_t>(answer.method);
  out.warm = answer.warm ? 1 : 0;
  out.bracket_reached = answer.bracket_reached ? 1 : 0;
  out.depth = answer.depth;
  out.lower = answer.lower;
  out.upper = answer.upper;
  out.distance = answer.distance;
  out.distance_lower = answer.distance_lower;
  out.distance_upper = answer.distance_upper;
  write_vector(answer.translation, out.translation);
  write_vector(answer.normal, out.normal);
  write_vector(answer.witness_a, out.witness_a);
  write_vector(answer.witness_b, out.witness_b);
  out.feature_a = feature_of(answer.feature_a, 0);
  out.feature_b = feature_of(answer.feature_b, 0);
  out.support_calls = answer.statistics.support_calls;
  out.facets_visited = answer.statistics.facets_visited;
  out.exact_signs = answer.statistics.exact_signs;
  clear_newer_fields(out);
}

void require_supported(const Question& question) {
  const Method method = question.settings.depth.method;
  if (method == Method::automatic || supports(method, *question.posed_a.shape, *question.posed_b.shape)) return;
  refuse(PDEPTH_UNSUPPORTED, "the method does not answer for these shapes; PDEPTH_METHOD_AUTOMATIC does",
         "settings.method");
}

void ask_depth(const Question& question, Workspace& space, pdepth_answer& out) {
  if (question.is_convex()) {
    write_depth(convex_depth(question, space), out);
    return;
  }
  if (answered_by_meshes(question, space, out)) return;
  const UnionDepth found = union_depth(question, space);
  write_depth(found, out);
  out.bracket_reached = found.bracket_reached && found.closed ? 1 : 0;
  out.feature_a.part = found.part_a;
  out.feature_b.part = found.part_b;
}

void ask_manifold(const Question& question, double breaking_threshold, Workspace& space, pdepth_manifold& out) {
  question.require_convex();
  require_length(breaking_threshold, "breaking_threshold");
  const PenetrationDepth answer = convex_depth(question, space);
  const ContactManifold found =
      contact_manifold(question.posed_a, question.posed_b, answer, breaking_threshold, space.manifold);
  require_finite(is_finite(found));
  out.status = PDEPTH_OK;
  out.contact = static_cast<std::int32_t>(answer.contact);
  out.count = found.count;
  write_vector(found.normal, out.normal);
  for (int i = 0; i < 4; ++i) {
    out.points[i] = {};
    if (i >= found.count) continue;
    const ContactPoint& point = found.points[static_cast<std::size_t>(i)];
    write_vector(point.position_a, out.points[i].position_a);
    write_vector(point.position_b, out.points[i].position_b);
    out.points[i].depth = point.depth;
    out.points[i].feature_id = point.feature_id;
  }
  clear_newer_fields(out);
}

void ask_derivatives(const Question& question, Workspace& space, pdepth_derivatives& out, pdepth_answer* answer) {
  question.require_convex();
  const DepthDerivatives found = depth_derivatives(question.posed_a, question.posed_b, space.scratch);
  require_finite(all_finite(found.signed_depth));
  if (answer != nullptr) write_depth(found.answer, *answer);
  out.status = PDEPTH_OK;
  out.reserved = 0;
  out.unique_direction = found.unique_direction ? 1 : 0;
  out.unique_witness = found.unique_witness ? 1 : 0;
  out.stable_features = found.stable_features ? 1 : 0;
  out.signed_depth = found.signed_depth;
  write_gradient(found.by_a, out.by_a);
  write_gradient(found.by_b, out.by_b);
  write_jacobian(found.normal_by_a, out.normal_by_a);
  write_jacobian(found.normal_by_b, out.normal_by_b);
  write_jacobian(found.witness_a_by_a, out.witness_a_by_a);
  write_jacobian(found.witness_a_by_b, out.witness_a_by_b);
  write_jacobian(found.witness_b_by_a, out.witness_b_by_a);
  write_jacobian(found.witness_b_by_b, out.witness_b_by_b);
  clear_newer_fields(out);
}

}  // namespace pd::c_interface
