#include "union_contact/piece_store.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "compound/part_pairs.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "shape/mesh/polygon_triangles.hpp"

namespace pd {

using detail::PieceStore;
using detail::TriangleBox;

namespace {

Error refused(ErrorCode code, std::string message, std::string where) {
  return {code, std::move(message), std::move(where)};
}

std::string place(const char* list, std::size_t i) { return list + ("[" + std::to_string(i)) + "]"; }

/// Returns the fault of a coordinate or length, if it has one.
std::optional<Error> fault_of(double value, const std::string& where) {
  if (!std::isfinite(value)) return refused(ErrorCode::non_finite, "must be a finite number", where);
  if (std::abs(value) > kMaxCoordinate) {
    return refused(ErrorCode::out_of_range, "coordinates and lengths may be 1e300 at most", where);
  }
  return {};
}

/// Returns the unit normal of the mean plane of a loop; zero if the loop has no area. A power of two keeps products in
/// range.
Vec3 normal_of(std::span<const Vec3> points, std::span<const std::int32_t> loop) {
  const auto way_to = [&](std::size_t k) {
    return Vec3(points[static_cast<std::size_t>(loop[k])] - points[static_cast<std::size_t>(loop[0])]);
  };
  double longest = 0;
  for (std::size_t k = 1; k < loop.size(); ++k) longest = std::max(longest, way_to(k).cwiseAbs().maxCoeff());
  if (!(longest > 0)) return Vec3::Zero();
  const int exponent = -std::ilogb(longest);
  const auto way = [&](std::size_t k) { return detail::times_power(way_to(k), exponent); };
  Vec3 across = Vec3::Zero();
  for (std::size_t k = 2; k < loop.size(); ++k) across += way(k - 1).cross(way(k));
  const double area = across.norm();
  return area > 0 ? Vec3(across / area) : Vec3(Vec3::Zero());
}

void add_triangle(const std::array<Vec3, 3>& corners, int face, PieceStore& store) {
  const Vec3 margin = Vec3::Constant(store.margin);
  store.triangles.push_back(corners);
  store.numbers.push_back(face);
  store.boxes.push_back({corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]) - margin,
                         corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]) + margin});
}

}  // namespace

PieceBody PieceBody::of_compound(Compound compound) {
  auto store = std::make_shared<PieceStore>();
  for (const Compound::Part& part : compound.parts()) {
    const detail::Box box = detail::bounding_box({&part.shape, part.pose});
    store->boxes.push_back({box.low, box.high});
  }
  store->tree = detail::TriangleTree(store->boxes);
  store->compound = std::move(compound);
  return PieceBody(std::move(store));
}

Expected<PieceBody> PieceBody::of_sheet(const MeshView& mesh, double margin) {
  if (auto fault = fault_of(margin, "margin")) return *std::move(fault);
  if (margin < 0) return refused(ErrorCode::bad_value, "a margin must be 0 or greater", "margin");
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (const double coordinate : mesh.points[i]) {
      if (auto fault = fault_of(coordinate, place("points", i))) return *std::move(fault);
    }
  }
  auto store = std::make_shared<PieceStore>();
  store->margin = margin;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (std::size_t face = 0; face + 1 < mesh.offsets.size(); ++face) {
    const std::int32_t first = mesh.offsets[face], last = mesh.offsets[face + 1];
    if (first < 0 || last < first || static_cast<std::size_t>(last) > mesh.corners.size()) {
      return refused(ErrorCode::bad_faces, "the offsets of this face do not fit the list of corners",
                     place("faces", face));
    }
    const auto loop = mesh.corners.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
    if (std::any_of(loop.begin(), loop.end(), [&](std::int32_t corner) {
          return corner < 0 || static_cast<std::size_t>(corner) >= mesh.points.size();
        })) {
      return refused(ErrorCode::bad_faces,
                     "a vertex index lies outside [0, " + std::to_string(mesh.points.size()) + ")",
                     place("faces", face));
    }
    const Vec3 normal = normal_of(mesh.points, loop);
    if (normal.isZero(0)) continue;
    triangles.clear();
    if (!detail::append_triangles(mesh.points, loop, normal, triangles)) {
      return refused(ErrorCode::bad_faces, "this face crosses itself", place("faces", face));
    }
    for (const auto& triangle : triangles) {
      std::array<Vec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.points[static_cast<std::size_t>(triangle[k])];
      add_triangle(corners, static_cast<int>(face), *store);
    }
  }
  if (store->triangles.empty()) {
    return refused(ErrorCode::too_few_points, "a sheet needs a face that has an area", "faces");
  }
  store->tree = detail::TriangleTree(store->boxes);
  return PieceBody(std::move(store));
}

bool PieceBody::is_sheet() const { return !store_->compound; }

std::int64_t PieceBody::num_pieces() const { return static_cast<std::int64_t>(store_->boxes.size()); }

namespace detail {

namespace {

/// A matrix that is a rotation up to 1e-6 and its transpose miss each other's inverse by no more than this share of the
/// coordinates.
constexpr double kNoInverse = 0x1p-17;

/// Returns a box around a turned and moved box.
TriangleBox turned(const TriangleBox& box, const Mat3& rotation, const Vec3& translation) {
  const Vec3 middle = rotation * (0.5 * box.low + 0.5 * box.high) + translation;
  Vec3 half = rotation.cwiseAbs() * (0.5 * box.high - 0.5 * box.low);
  half.array() +=
      kNoInverse * (box.low.cwiseAbs().maxCoeff() + box.high.cwiseAbs().maxCoeff() + translation.cwiseAbs().maxCoeff());
  return {middle - half, middle + half};
}

}  // namespace

PieceBody scaled(const PieceBody& body, int exponent) {
  const PieceStore& from = body.store();
  if (from.compound) {
    std::vector<Compound::Part> parts;
    for (const Compound::Part& part : from.compound->parts()) {
      parts.push_back(
          {scaled(part.shape, exponent),
           Pose::from_trusted_matrix(part.pose.rotation(), times_power(part.pose.translation(), exponent))});
    }
    auto compound = Compound::from_parts(std::move(parts));
    return PieceBody::of_compound(std::move(compound).value());
  }
  auto store = std::make_shared<PieceStore>();
  store->margin = std::ldexp(from.margin, exponent);
  for (std::size_t i = 0; i < from.triangles.size(); ++i) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = times_power(from.triangles[i][k], exponent);
    add_triangle(corners, from.numbers[i], *store);
  }
  store->tree = TriangleTree(store->boxes);
  return PieceBody(std::move(store));
}

Expected<StandingPieces> StandingPieces::stand(const PosedPieces& posed) {
  std::vector<PosedShape> parts;
  if (const auto& compound = posed.body->store().compound) {
    auto standing = compound->posed(posed.pose);
    if (!standing) return standing.error();
    parts = std::move(standing).value();
  }
  return StandingPieces(posed, std::move(parts));
}

TriangleBox StandingPieces::in_world(const TriangleBox& local) const {
  return turned(local, pose_.rotation(), pose_.translation());
}

TriangleBox StandingPieces::box(int piece) const { return in_world(store_->boxes[static_cast<std::size_t>(piece)]); }

TriangleBox StandingPieces::whole_box() const {
  const auto& root = store_->tree.nodes().front();
  return in_world({root.low, root.high});
}

void StandingPieces::meeting(const TriangleBox& world, std::vector<int>& pieces) const {
  const Mat3 back = pose_.rotation().transpose();
  const TriangleBox local = turned(world, back, -(back * pose_.translation()));
  pieces.clear();
  const auto& nodes = store_->tree.nodes();
  std::array<std::int32_t, 96> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const auto& node = nodes[static_cast<std::size_t>(waiting[--count])];
    if (!local.meets({node.low, node.high})) continue;
    if (!node.is_leaf()) {
      waiting[count++] = node.left;
      waiting[count++] = node.right;
      continue;
    }
    for (std::int32_t k = node.first; k < node.last; ++k) {
      const std::int32_t i = store_->tree.order()[static_cast<std::size_t>(k)];
      if (local.meets(store_->boxes[static_cast<std::size_t>(i)])) pieces.push_back(i);
    }
  }
  std::sort(pieces.begin(), pieces.end());
}

const ConvexShape* StandingPieces::shape(int piece) {
  const auto i = static_cast<std::size_t>(piece);
  if (!is_sheet()) return parts_[i].shape;
  const auto [known, is_new] = shapes_.try_emplace(piece);
  if (is_new) {
    auto triangle = ConvexPolytope::from_points(store_->triangles[i]);
    if (triangle && triangle.value().affine_dimension() == 2) {
      auto grown = ConvexShape(std::move(triangle).value()).with_margin(store_->margin);
      if (grown) known->second = std::move(grown).value();
    }
  }
  return known->second ? &*known->second : nullptr;
}

const UnionPiece& StandingPieces::planes(int piece) {
  const auto [known, is_new] = planes_.try_emplace(piece);
  if (!is_new) return known->second;
  if (is_sheet()) {
    const std::array<Vec3, 3>& corners = store_->triangles[static_cast<std::size_t>(piece)];
    set_triangle({pose_.apply(corners[0]), pose_.apply(corners[1]), pose_.apply(corners[2])}, store_->margin,
                 known->second);
  } else {
    set_piece(parts_[static_cast<std::size_t>(piece)], known->second);
  }
  return known->second;
}

Vec3 StandingPieces::front(int piece) const {
  const std::array<Vec3, 3>& corners = store_->triangles[static_cast<std::size_t>(piece)];
  return (pose_.rotation() * (corners[1] - corners[0]).cross(corners[2] - corners[0])).normalized();
}

void PieceAmong::find(const NearPoint& near, const Beyond* beyond, std::vector<const UnionPiece*>& found) {
  found.clear();
  const Vec3 reach = Vec3::Constant(near.reach);
  all_.meeting({near.point - reach, near.point + reach}, near_);
  for (const int i : near_) {
    if (i == piece_) continue;
    if (beyond != nullptr) {
      const TriangleBox box = all_.box(i);
      const Vec3 far = beyond->n.cwiseProduct(box.low).cwiseMax(beyond->n.cwiseProduct(box.high));
      if (far.sum() <= beyond->level) continue;
    }
    const UnionPiece& piece = all_.planes(i);
    if (!piece.planes.empty()) found.push_back(&piece);
  }
}

}  // namespace detail

}  // namespace pd
