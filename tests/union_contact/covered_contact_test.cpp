// Contacts inside of a union are dropped or turned without any engine: pieces are listed by hand.
#include "pd/union_contact/covered_contact.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::test {
namespace {

/// The pieces around one of them, in the world; all are near.
class Listed final : public PieceSurroundings {
 public:
  void add(const PosedShape& piece) { set_piece(piece, pieces_.emplace_back()); }
  const UnionFrame& frame() override { return world_; }
  const UnionPiece* own() override { return nullptr; }
  void find(const NearPoint& /*near*/, const Beyond* /*beyond*/, std::vector<const UnionPiece*>& found) override {
    found.clear();
    for (const UnionPiece& piece : pieces_) found.push_back(&piece);
  }

 private:
  UnionFrame world_;
  std::vector<UnionPiece> pieces_;
};

Pose at(double x, double y, double z) { return Pose::from_trusted_matrix(Mat3::Identity(), Vec3(x, y, z)); }

/// A small box stands on the left one of two boxes with one top, is 0.01 deep in it, and reaches 0.005 over the seam.
class OverASeam : public testing::Test {
 protected:
  int ask(PieceSurroundings* around) {
    Scratch scratch;
    const PenetrationDepth depth = penetration_depth(body_, right_, scratch, {});
    points_ = contact_manifold(body_, right_, depth, 0.02, manifold_, DeepestPoint::as_lifted);
    const PiecePair pair{.a = body_,
                         .b = right_,
                         .around_a = nullptr,
                         .around_b = around,
                         .threshold = 0.02,
                         .way = 0,
                         .pose_rounding = 0x1p-46,
                         .cover = cover_,
                         .manifold = manifold_};
    return keep_uncovered(pair, depth, AnswerPoints::made, points_);
  }

  ConvexShape large_{*ConvexPolytope::box({1, 1, 1})}, small_{*ConvexPolytope::box({0.2, 0.2, 0.2})};
  PosedShape left_{&large_, at(-1, -1, 0)}, right_{&large_, at(1, -1, 0)}, body_{&small_, at(-0.195, 0.19, 0)};
  CoverBuffers cover_;
  ManifoldScratch manifold_;
  ContactManifold points_;
};

TEST_F(OverASeam, TheShortestWayOutOfOnePieceIsSideways) {
  EXPECT_EQ(ask(nullptr), 0);
  ASSERT_GT(points_.count, 0);
  EXPECT_LT(points_.normal.x(), -0.99);
}

TEST_F(OverASeam, TheUnionPushesUp) {
  Listed around;
  around.add(left_);
  EXPECT_EQ(ask(&around), 1);
  ASSERT_GT(points_.count, 0);
  EXPECT_GT(points_.normal.y(), 0.99);
  EXPECT_NEAR(points_.points[0].depth, 0.01, 1e-12);
}

TEST_F(OverASeam, AGapThatIsWiderThanASeamCoversNothing) {
  Listed around;
  around.add({&large_, at(-1.5, -1, 0)});
  EXPECT_EQ(ask(&around), 0);
  EXPECT_LT(points_.normal.x(), -0.99);
}

}  // namespace
}  // namespace pd::test
