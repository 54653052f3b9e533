/// @file
/// The contact of two bodies of many pieces takes each of them as one body: edges and faces inside of it have no
/// contact.
///
/// Every two pieces that are near each other are asked as if they were alone, and covered_contact.hpp decides which
/// part of their answer holds for the whole. If pieces of two solid bodies are so deep in each other that no part does,
/// the way out of the whole answers (deep_union.hpp). The remaining points are sorted by normal into patches of at most
/// four points (patches.hpp).
///
/// A sheet has two sides, and each triangle is left by the nearer one; or one side (`one_sided`), from which the
/// corners run counter-clockwise, as the surface of a solid has (one_sided.hpp). Points are those of one placement:
/// nothing is known of the step before. Points and normals are in the common frame, lengths in the unit of the input.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/union_contact/covered_contact.hpp"
#include "pd/union_contact/piece_body.hpp"
#include "pd/union_contact/union_exit.hpp"

namespace pd {

struct UnionContactSettings {
  double breaking_threshold = 0;  ///< >= 0: pairs of points with a wider gap are left out
  /// >= 0: the bodies may move so far against each other before contacts are found again. The part of a facet that is
  /// looked at around a contact grows by it.
  double way = 0;
  bool one_sided = false;  ///< sheets have fronts only
};

/// A contact point and the pieces that it lies between, by the caller's numbers.
struct UnionContactPoint {
  Vec3 normal = Vec3::UnitX();  ///< unit, from B to A
  ContactPoint contact;
  int piece_a = -1;
  int piece_b = -1;
};

/// At most four points of about one normal, which is that of the deepest of them.
struct UnionContactPatch {
  Vec3 normal = Vec3::UnitX();
  std::array<UnionContactPoint, 4> points;
  int count = 0;
};

/// If no contact of two pieces holds for the whole and no body is a sheet, `penetration_depth` of the two unions says
/// the normal and the pieces, whose own points are the contact.
struct UnionManifold {
  std::vector<UnionContactPatch> patches;  ///< at most eight, that of the deepest point first
  std::int64_t covered = 0;                ///< contacts of two pieces that were dropped or turned as covered
  Vec3 normal = Vec3::Zero();              ///< of the deepest point; zero if a sheet has no contact
  int piece_a = -1;                        ///< the pieces of the deepest point, -1 if a sheet has no contact
  int piece_b = -1;
};

/// Memory of one thread.
struct UnionManifoldScratch {
  Scratch& depth;
  ManifoldScratch& manifold;
  CoverBuffers cover = {};
  UnionExit exit = {};
};

/// Finds the contact of two bodies of pieces.
///
/// @return ErrorCode::unsupported ("a") if both bodies are sheets, which have no inside.
/// @return ErrorCode::unsupported ("one_sided") if none is a sheet.
/// @return ErrorCode::bad_value ("breaking_threshold", "way"), out_of_range ("pose_a", "pose_b").
/// @return ErrorCode::limit_exceeded ("a") if more pairs of pieces are near each other than one answer may ask, or the
/// way out of the whole takes more.
/// Time: one query of depth for each pair of pieces whose boxes come within the breaking threshold of each other, and
/// the time of covered_contact.hpp for those that have contacts.
[[nodiscard]] Expected<UnionManifold> union_manifold(const PosedPieces& a, const PosedPieces& b,
                                                     const UnionContactSettings& settings,
                                                     UnionManifoldScratch& scratch);

}  // namespace pd
