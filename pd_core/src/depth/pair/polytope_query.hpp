/// @file
/// The stages of one query about two posed polytopes share this state (stages.hpp). A stage passes nothing on to the
/// next ones but the result of the surface.
#pragma once

#include <optional>

#include "depth/certificate/exact_answer.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/expansion_goal.hpp"
#include "depth/facets/gauss_boxes.hpp"
#include "depth/pair/polytope_depth.hpp"
#include "shape/posed_pair.hpp"

namespace pd::detail {

class PolytopeQuery {
 public:
  PolytopeQuery(const PolytopePair& asked_pair, const DepthSettings& asked, ScratchBuffers& scratch,
                WarmCertificate* certificate)
      : pair(asked_pair),
        settings(asked),
        buffers(scratch),
        warm(certificate),
        bracket(bracket_of(asked)),
        difference(*asked_pair.a, *asked_pair.pose_a, *asked_pair.b, *asked_pair.pose_b) {}

  const PolytopePair& pair;
  const DepthSettings& settings;
  ScratchBuffers& buffers;
  WarmCertificate* const warm;  ///< or nullptr
  const Bracket bracket;        ///< what the answer needs: an approximate one is never rounded exactly
  PolytopeDifference difference;
  ExpansionResult surface;  ///< once a stage has asked for it; its faces are in the scratch

  /// The difference, ready for supports: the vertices are transformed on first use.
  const PolytopeDifference& with_supports() {
    difference.prepare_supports(buffers.posed);
    return difference;
  }

  /// The pair for exact signs, made on first use.
  const PosedPair& exact() {
    if (!exact_) exact_.emplace(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b);
    return *exact_;
  }
  /// Decisions that exact arithmetic took; the answer itself counts as one.
  [[nodiscard]] std::int64_t exact_signs() const {
    return exact_ ? 1 + exact_->stages().double_double + exact_->stages().exact : 0;
  }

  /// True if both bodies are boxes. It is found out on first use.
  bool boxes() {
    if (!boxes_known_) {
      boxes_known_ = true;
      frame_a_ = box_frame(*pair.a);
      if (frame_a_) frame_b_ = box_frame(*pair.b);
    }
    return frame_b_.has_value();
  }
  /// Require `boxes()`.
  [[nodiscard]] const BoxFrame& frame_a() const { return *frame_a_; }
  [[nodiscard]] const BoxFrame& frame_b() const { return *frame_b_; }

  /// Whether doubles with error bounds may answer alone.
  [[nodiscard]] bool doubles_suffice() const {
    return bracket != Bracket::tightest && settings.method != Method::decomposition;
  }
  /// Whether the answer may be as wide as `contact_tolerance` and needs no exact numbers.
  [[nodiscard]] bool for_contact() const { return bracket == Bracket::contact; }
  /// A bracket of doubles that is this narrow is enough.
  [[nodiscard]] BracketWidth width() const { return {kCertifiedWidth, for_contact() ? settings.contact_tolerance : 0}; }
  /// A bracket of doubles may be this wide, in the unit of the input.
  [[nodiscard]] double widest_bracket() const { return width().limit(difference.reach()); }
  [[nodiscard]] int vertices() const { return pair.a->num_vertices() + pair.b->num_vertices(); }
  /// Sizes outside this range are left to the exact stages, which rescale.
  [[nodiscard]] bool within_range() const { return difference.reach() > 0x1p-100 && difference.reach() < 0x1p100; }

  /// The bracket that an answer is made for.
  static Bracket bracket_of(const DepthSettings& asked) {
    if (asked.bracket == Bracket::contact) {
      const bool searched = asked.method == Method::automatic || asked.method == Method::expansion;
      return searched ? Bracket::contact : Bracket::certified;
    }
    return asked.delta == 0 ? asked.bracket : Bracket::certified;
  }

 private:
  std::optional<PosedPair> exact_;
  bool boxes_known_ = false;
  std::optional<BoxFrame> frame_a_, frame_b_;
};

}  // namespace pd::detail
