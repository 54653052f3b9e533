#include <cmath>

#include "bench/peers/jolt_pair.hpp"
#include "bench/peers/solver.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {

namespace {

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
Vec3 to_vec(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// Jolt's bodies stand along y, ours along z.
Mat3 upright() {
  Mat3 turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

bool stands(const JoltBody& body) {
  using Kind = JoltBody::Kind;
  return body.kind == Kind::capsule || body.kind == Kind::cylinder || body.kind == Kind::cone;
}

JoltBody to_jolt(const ConvexShape& shape) {
  using Kind = JoltBody::Kind;
  JoltBody body;
  const auto scalar = [](double x) { return static_cast<float>(x); };
  body.radius = scalar(shape.margin());
  if (const auto* e = std::get_if<Ellipsoid>(&shape.core())) {
    body.kind = Kind::ellipsoid;
    body.radii = to_floats(e->radii);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.core())) {
    body.kind = Kind::cylinder;
    body.radius = scalar(cylinder->radius);
    body.half_height = scalar(cylinder->half_height);
  } else if (const auto* cone = std::get_if<Cone>(&shape.core())) {
    body.kind = Kind::cone;
    body.radius = scalar(cone->radius);
    body.half_height = scalar(cone->half_height);
  } else if (shape.polytope()->num_vertices() == 1) {
    body.kind = Kind::sphere;
  } else if (shape.polytope()->num_vertices() == 2) {
    body.kind = Kind::capsule;
    body.half_height = scalar(length_of(shape) / 2);
  } else if (const auto half = half_extents_of(shape)) {
    body.kind = Kind::box;
    body.radii = to_floats(*half);
  } else {
    for (const Vec3& p : vertices_of(shape)) body.vertices.push_back(to_floats(p));
  }
  return body;
}

enum class JoltQuery : std::uint8_t { depth, distance, beyond };

class JoltAttempt final : public Attempt {
 public:
  JoltAttempt(const Bodies& bodies, JoltQuery query, bool warm, bool wide) : query_(query), warm_(warm) {
    const JoltBody a = to_jolt(bodies.a), b = to_jolt(bodies.b);
    if (stands(a)) turn_a_ = upright();
    if (stands(b)) turn_b_ = upright();
    pair_ = make_jolt_pair(a, b, wide);
  }
  void stand(const Pose& a, const Pose& b) override {
    const Pose at_a = scenes::to_single(a), at_b = scenes::to_single(b);
    to_world_ = at_a.rotation() * turn_a_;
    const Mat3 turn = to_world_.transpose() * at_b.rotation() * turn_b_;
    std::array<float, 9> columns{};
    for (int k = 0; k < 9; ++k) columns[static_cast<std::size_t>(k)] = static_cast<float>(turn(k % 3, k / 3));
    pair_->stand(columns, to_floats(to_world_.transpose() * (at_b.translation() - at_a.translation())));
  }
  void limit(double distance) override {
    if (query_ == JoltQuery::beyond) limit_ = static_cast<float>(distance);
  }
  void run() override { answer_ = query_ == JoltQuery::depth ? pair_->depth() : pair_->distance(limit_, warm_); }
  [[nodiscard]] Answer answer() const override {
    const Vec3 way = to_world_ * (to_vec(answer_.b) - to_vec(answer_.a));
    if (query_ == JoltQuery::depth) return {answer_.overlapping, way.norm(), way};
    if (answer_.farther) return {false, 0, to_world_ * to_vec(answer_.axis), std::numeric_limits<double>::infinity()};
    return {answer_.overlapping, 0, way, way.norm()};
  }

 private:
  JoltQuery query_;
  bool warm_;
  float limit_ = 1e15F;
  Mat3 turn_a_ = Mat3::Identity();
  Mat3 turn_b_ = Mat3::Identity();
  Mat3 to_world_ = Mat3::Identity();
  std::unique_ptr<JoltPair> pair_;
  JoltAnswer answer_;
};

class JoltSolver final : public Solver {
 public:
  JoltSolver(std::string_view name, JoltQuery query, bool warm = false, bool wide = false)
      : name_(name), query_(query), warm_(warm), wide_(wide) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    return !std::holds_alternative<SphereHull>(bodies.a.core()) && !std::holds_alternative<SphereHull>(bodies.b.core());
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<JoltAttempt>(bodies, query_, warm_, wide_);
  }

 private:
  std::string_view name_;
  JoltQuery query_;
  bool warm_;
  bool wide_;
};

}  // namespace

void add_jolt(Solvers& solvers) {
  solvers.push_back(std::make_unique<JoltSolver>("jolt-epa", JoltQuery::depth));
  solvers.push_back(std::make_unique<JoltSolver>("jolt-epa-wide", JoltQuery::depth, false, true));
}

void add_jolt_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<JoltSolver>("jolt-gjk", JoltQuery::distance));
  solvers.push_back(std::make_unique<JoltSolver>("jolt-gjk-warm", JoltQuery::distance, true));
  solvers.push_back(std::make_unique<JoltSolver>("jolt-beyond", JoltQuery::beyond));
  solvers.push_back(std::make_unique<JoltSolver>("jolt-beyond-warm", JoltQuery::beyond, true));
}

std::string jolt_note() { return "Jolt " + jolt_version() + " (float), convex radius 0, tolerance 1e-5"; }

}  // namespace pd::bench
