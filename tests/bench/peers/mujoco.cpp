#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/peers/solver.hpp"
#include "engine/engine_collision_gjk.h"
#include "scenes/single_precision.hpp"

namespace pd::bench {

namespace {

constexpr int kIterations = 1000;
constexpr mjtNum kTolerance = 1e-12;

/// A model with one body: the arrays that convex collision reads, as MuJoCo's compiler fills them. Vertices are in
/// single precision there, all else in double.
class MujocoBody {
 public:
  explicit MujocoBody(const ConvexShape& shape) {
    if (const auto* e = std::get_if<Ellipsoid>(&shape.core())) {
      set(mjGEOM_ELLIPSOID, e->radii);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.core())) {
      set(mjGEOM_CYLINDER, {cylinder->radius, cylinder->half_height, 0});
    } else if (shape.polytope()->num_vertices() == 1) {
      set(mjGEOM_SPHERE, {shape.margin(), 0, 0});
    } else if (shape.polytope()->num_vertices() == 2) {
      set(mjGEOM_CAPSULE, {shape.margin(), length_of(shape) / 2, 0});
    } else if (const auto half = half_extents_of(shape)) {
      set(mjGEOM_BOX, *half);
    } else {
      set(mjGEOM_MESH, Vec3::Zero());
      set_mesh(*shape.polytope());
    }
  }
  MujocoBody(const MujocoBody&) = delete;
  MujocoBody& operator=(const MujocoBody&) = delete;

  [[nodiscard]] mjCCDObj stand(const Pose& pose) {
    for (int i = 0; i < 9; ++i) rotation_[i] = pose.rotation()(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) position_[i] = pose.translation()[i];
    mjCCDObj object{};
    mjc_initCCDObj(&object, &model_, &data_, 0, 0);
    return object;
  }

 private:
  void set(int type, const Vec3& size) {
    type_ = type;
    for (int i = 0; i < 3; ++i) size_[i] = size[i];
    model_.geom_type = &type_;
    model_.geom_size = size_;
    model_.geom_dataid = &zero_;
    data_.geom_xpos = position_;
    data_.geom_xmat = rotation_;
  }

  void set_mesh(const ConvexPolytope& polytope) {
    count_ = polytope.num_vertices();
    for (int v = 0; v < count_; ++v) {
      for (int k = 0; k < 3; ++k) vertices_.push_back(static_cast<float>(polytope.vertex(v)[k]));
    }
    set_graph(polytope);
    set_extrema();
    model_.mesh_vert = vertices_.data();
    model_.mesh_vertnum = &count_;
    model_.mesh_vertadr = model_.mesh_graphadr = model_.mesh_polyadr = &zero_;
    model_.mesh_polynum = &zero_;
    model_.mesh_polymapadr = model_.mesh_polymapnum = model_.mesh_polymap = &zero_;
    model_.mesh_polyvertadr = model_.mesh_polyvertnum = model_.mesh_polyvert = &zero_;
    model_.mesh_polynormal = size_;
    model_.mesh_graph = graph_.data();
    model_.mesh_extrema = extrema_;
  }

  /// Numbers of vertices and faces, where each vertex' neighbours begin, the vertices' ids, the neighbours up to a -1.
  void set_graph(const ConvexPolytope& polytope) {
    std::vector<std::set<int>> neighbours(static_cast<std::size_t>(count_));
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const auto corners = polytope.facet_vertices(f);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const int from = corners[i], to = corners[(i + 1) % corners.size()];
        neighbours[static_cast<std::size_t>(from)].insert(to);
        neighbours[static_cast<std::size_t>(to)].insert(from);
      }
    }
    std::vector<int> lists;
    graph_ = {count_, 0};
    for (const auto& list : neighbours) {
      graph_.push_back(static_cast<int>(lists.size()));
      lists.insert(lists.end(), list.begin(), list.end());
      lists.push_back(-1);
    }
    for (int v = 0; v < count_; ++v) graph_.push_back(v);
    graph_.insert(graph_.end(), lists.begin(), lists.end());
  }

  /// The vertex that is extreme in each of the directions to a cube's middle, corners, edges and faces.
  void set_extrema() {
    int k = 0;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z, ++k) {
          const auto along = [&](int v) {
            const float* p = vertices_.data() + 3 * v;
            return p[0] * static_cast<float>(x) + p[1] * static_cast<float>(y) + p[2] * static_cast<float>(z);
          };
          for (int v = 1; v < count_; ++v) {
            if (along(v) > along(extrema_[k])) extrema_[k] = v;
          }
        }
      }
    }
  }

  mjModel model_{};
  mjData data_{};
  int type_ = 0;
  int zero_ = 0;
  int count_ = 0;
  mjtNum size_[3] = {};
  mjtNum position_[3] = {};
  mjtNum rotation_[9] = {};
  std::vector<float> vertices_;
  std::vector<int> graph_;
  int extrema_[27] = {};
};

enum class MujocoQuery : std::uint8_t { depth, distance, beyond };

class MujocoAttempt final : public Attempt {
 public:
  MujocoAttempt(const Bodies& bodies, MujocoQuery query) : query_(query), a_(bodies.a), b_(bodies.b) {
    buffer_.resize(mjc_ccdSize(0, 0, kIterations));
    config_.max_iterations = kIterations;
    config_.tolerance = kTolerance;
    config_.max_contacts = 1;
    config_.dist_cutoff = query == MujocoQuery::depth ? 0 : mjMAX_LIMIT;
    config_.buffer = buffer_.data();
  }
  void stand(const Pose& a, const Pose& b) override {
    objects_[0] = a_.stand(scenes::to_single(a));
    objects_[1] = b_.stand(scenes::to_single(b));
  }
  void limit(double distance) override {
    if (query_ == MujocoQuery::beyond) config_.dist_cutoff = distance;
  }
  void run() override {
    // What the last call found is not carried on.
    for (mjCCDObj& object : objects_) object.vertindex = object.meshindex = -1;
    distance_ = mjc_ccd(&config_, &status_, &objects_[0], &objects_[1]);
  }
  [[nodiscard]] Answer answer() const override {
    const Vec3 on_a(status_.x1[0], status_.x1[1], status_.x1[2]);
    const Vec3 on_b(status_.x2[0], status_.x2[1], status_.x2[2]);
    if (query_ == MujocoQuery::depth) return {distance_ < 0, std::max(-distance_, 0.0), on_b - on_a};
    if (distance_ >= mjMAX_LIMIT) return {false, 0, on_b - on_a, std::numeric_limits<double>::infinity()};
    return {distance_ < 0, 0, on_b - on_a, std::max(distance_, 0.0)};
  }

 private:
  MujocoQuery query_;
  MujocoBody a_;
  MujocoBody b_;
  std::vector<std::uint8_t> buffer_;
  mjCCDConfig config_{};
  mjCCDStatus status_{};
  mjCCDObj objects_[2];
  double distance_ = 0;
};

bool has_a_shape_for(const ConvexShape& shape) {
  return !std::holds_alternative<Cone>(shape.core()) && !std::holds_alternative<SphereHull>(shape.core());
}

class MujocoSolver final : public Solver {
 public:
  MujocoSolver(std::string_view name, MujocoQuery query) : name_(name), query_(query) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    return has_a_shape_for(bodies.a) && has_a_shape_for(bodies.b);
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<MujocoAttempt>(bodies, query_);
  }

 private:
  std::string_view name_;
  MujocoQuery query_;
};

}  // namespace

void add_mujoco(Solvers& solvers) {
  static_assert(sizeof(mjtNum) == sizeof(double));
  solvers.push_back(std::make_unique<MujocoSolver>("mujoco-ccd", MujocoQuery::depth));
}

void add_mujoco_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<MujocoSolver>("mujoco-distance", MujocoQuery::distance));
  solvers.push_back(std::make_unique<MujocoSolver>("mujoco-beyond", MujocoQuery::beyond));
}

std::string mujoco_note() {
  return fmt::format("MuJoCo {} (double, vertices in float), {} iterations, tolerance {}", mjVERSION_HEADER,
                     kIterations, kTolerance);
}

}  // namespace pd::bench
