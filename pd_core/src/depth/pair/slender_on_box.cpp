#include "depth/pair/slender_on_box.hpp"

#include <algorithm>
#include <cmath>

#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/facets/facet_contact.hpp"
#include "depth/facets/gauss_boxes.hpp"
#include "depth/pair/contact_facets.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// A height errs by 13u of the end's distance from the box's centre (its place, the cofactors, product and quotient),
/// 11u of the box's half extent and 4u of each body's own coordinates.
constexpr double kHeightError = 24 * kUnitRoundoff;
/// Matrices further from a rotation have longer cofactors than the error bounds allow for.
constexpr double kSkew = 0x1p-10;
/// Sizes beyond it are left to those who rescale.
constexpr double kLargest = 0x1p100;

/// The end of the body nearest to the face, and what is known of it.
struct EndOverFace {
  int end = -1;
  int axis = 0;
  double side = 1;    ///< the face lies at side * half extent
  double beyond = 0;  ///< its height in the box's coordinates
};

class SlenderOnBox {
 public:
  SlenderOnBox(const ConvexPolytope& body, const Pose& pose_body, const BoxFrame& box, const Pose& pose_box)
      : body_(body), box_(box), columns_(pose_box.rotation()) {
    offset_ = pose_body.translation() - pose_box.translation();
    centre_ = columns_ * box.centre;
    const Vec3 x = columns_.col(0), y = columns_.col(1), z = columns_.col(2);
    cofactors_.col(0) = y.cross(z);
    cofactors_.col(1) = z.cross(x);
    cofactors_.col(2) = x.cross(y);
    volume_ = x.dot(cofactors_.col(0));
    share_ = 1 / volume_;
    for (int v = 0; v < body.num_vertices(); ++v) {
      turned_[v] = pose_body.rotation() * body.vertex(v);
      from_centre_[v] = (turned_[v] + offset_) - centre_;
      local_[v] = share_ * (cofactors_.transpose() * from_centre_[v]);
    }
  }

  /// False where the body is not over a single face for certain.
  bool contact(FacetContact& out, EndOverFace& over) const {
    if (!(std::abs(volume_ - 1) < kSkew)) return false;
    over = nearest_end();
    if (!(over.beyond > 0)) return false;
    const Vec3 cofactor = cofactors_.col(over.axis);
    const double squared = cofactor.squaredNorm();
    if (!(std::abs(squared - 1) < 2 * kSkew)) return false;
    const double per_length = 1 / std::sqrt(squared);
    const Vec3& place = from_centre_[over.end];
    // Of the farther end, too: which of them is the nearest is known up to both their errors.
    const double far =
        std::sqrt(std::max(place.squaredNorm(), from_centre_[body_.num_vertices() - 1 - over.end].squaredNorm()));
    const double half = box_.half_extents[over.axis];
    const double error = kHeightError * (far + half) + 8 * kUnitRoundoff * (body_.radius() + centre_.cwiseAbs().sum());
    out.normal = (over.side * per_length) * cofactor;
    out.gap = (over.side * cofactor.dot(place) - half * volume_) * per_length;
    if (!(out.gap > 4 * error) || !(far < kLargest)) return false;
    // The foot on the face, in the box's coordinates; a column's cofactor is across the two others.
    for (const int k : {(over.axis + 1) % 3, (over.axis + 2) % 3}) {
      const double foot = local_[over.end][k] - out.gap * share_ * cofactors_.col(k).dot(out.normal);
      if (!(std::abs(foot) + 4 * error < box_.half_extents[k])) return false;
    }
    out.certified = true;
    out.lower = out.gap - error;
    out.upper = out.gap + error;
    out.largest = place.cwiseAbs().maxCoeff();
    out.body = {turned_[over.end], over.end};
    return true;
  }

 private:
  /// The end nearest to that face of the box which has the body farthest before it.
  [[nodiscard]] EndOverFace nearest_end() const {
    EndOverFace best;
    const int last = body_.num_vertices() - 1;
    for (int k = 0; k < 3; ++k) {
      const double x = local_[0][k], y = local_[last][k];
      const double side = x + y < 0 ? -1 : 1;
      const double beyond = std::min(side * x, side * y) - box_.half_extents[k];
      if (best.end < 0 || beyond > best.beyond) best = {side * x <= side * y ? 0 : last, k, side, beyond};
    }
    return best;
  }

  const ConvexPolytope& body_;
  const BoxFrame& box_;
  Mat3 columns_;
  Mat3 cofactors_;
  double volume_ = 1;  ///< of the columns
  double share_ = 1;   ///< its inverse
  Vec3 offset_;
  Vec3 centre_;          ///< of the box, relative to its translation
  Vec3 turned_[2];       ///< the body's vertices, relative to its translation
  Vec3 from_centre_[2];  ///< relative to the box's centre
  Vec3 local_[2];        ///< in units of the box's columns
};

}  // namespace

bool answer_slender_on_box(const PolytopePair& pair, const DepthSettings& settings, PenetrationDepth& out) {
  const int of = pair.a->num_vertices() <= 2 ? 1 : 0;
  const ConvexPolytope& body = of == 1 ? *pair.a : *pair.b;
  const ConvexPolytope& owner = of == 1 ? *pair.b : *pair.a;
  if (body.num_vertices() > 2 || owner.num_vertices() != 8) return false;
  const std::optional<BoxFrame> box = box_frame(owner);
  if (!box) return false;
  const Pose& pose_body = of == 1 ? *pair.pose_a : *pair.pose_b;
  FacetContact contact;
  EndOverFace over;
  if (!SlenderOnBox(body, pose_body, *box, of == 1 ? *pair.pose_b : *pair.pose_a).contact(contact, over)) return false;
  const BracketWidth width{kCertifiedWidth, settings.contact_tolerance};
  if (contact.upper - contact.lower > width.limit(contact.largest)) return false;
  set_contact_on_facet(contact, of == 0, pair.margins, pose_body.translation(), out);
  const Feature facet{Feature::Kind::facet, facet_of_box(owner, over.axis, over.side > 0), -1};
  const Feature vertex{Feature::Kind::vertex, contact.body.id, -1};
  out.feature_a = of == 0 ? facet : vertex;
  out.feature_b = of == 0 ? vertex : facet;
  return true;
}

}  // namespace pd::detail
