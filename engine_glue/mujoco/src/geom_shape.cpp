#include "geom_shape.hpp"

#include <algorithm>
#include <bit>
#include <mutex>
#include <span>

#include "kept_bodies.hpp"

namespace pd::detail {

namespace {

constexpr std::array<const char*, 8> kTypeNames = {"plane",     "hfield",   "sphere", "capsule",
                                                   "ellipsoid", "cylinder", "box",    "mesh"};

/// The number of entries of `geom_size` that a type reads.
int numbers_read(int type) {
  switch (type) {
    case mjGEOM_SPHERE:
      return 1;
    case mjGEOM_CAPSULE:
    case mjGEOM_CYLINDER:
      return 2;
    case mjGEOM_ELLIPSOID:
    case mjGEOM_BOX:
      return 3;
    default:
      return 0;
  }
}

/// A mesh of a model, as MuJoCo's narrow phase reads it.
struct MeshView {
  std::span<const float> vertices;  ///< three numbers each
  const int* hull = nullptr;        ///< indices of the hull's vertices, where MuJoCo's compiler made a hull
  std::size_t hull_size = 0;

  [[nodiscard]] std::size_t corners() const { return hull != nullptr ? hull_size : vertices.size() / 3; }
  [[nodiscard]] std::size_t corner(std::size_t i) const {
    return hull != nullptr ? static_cast<std::size_t>(hull[i]) : i;
  }
};

MeshView mesh_of(const mjModel& model, int geom) {
  const int mesh = model.geom_dataid[geom];
  if (model.geom_type[geom] != mjGEOM_MESH || mesh < 0 || mesh >= model.nmesh) return {};
  MeshView view;
  view.vertices = {model.mesh_vert + 3 * static_cast<std::size_t>(model.mesh_vertadr[mesh]),
                   3 * static_cast<std::size_t>(std::max(model.mesh_vertnum[mesh], 0))};
  if (model.mesh_graphadr[mesh] >= 0) {
    // The graph: how many vertices and faces, where the edges of each vertex begin, the vertices' indices, the rest.
    const int* graph = model.mesh_graph + model.mesh_graphadr[mesh];
    view.hull = graph + 2 + graph[0];
    view.hull_size = static_cast<std::size_t>(std::max(graph[0], 0));
  }
  return view;
}

GeomSource source_of(const mjModel& model, int geom) {
  GeomSource source;
  source.type = model.geom_type[geom];
  for (int i = 0; i < numbers_read(source.type); ++i) {
    source.size[static_cast<std::size_t>(i)] = static_cast<double>(model.geom_size[3 * geom + i]);
  }
  const MeshView mesh = mesh_of(model, geom);
  for (std::size_t i = 0; i < mesh.corners(); ++i) {
    const std::size_t v = mesh.corner(i);
    if (v >= mesh.vertices.size() / 3) continue;
    source.corners.push_back(static_cast<std::int32_t>(v));
    source.vertices.insert(source.vertices.end(), &mesh.vertices[3 * v], &mesh.vertices[3 * v] + 3);
  }
  return source;
}

BodyKind kind_of(int type) {
  switch (type) {
    case mjGEOM_SPHERE:
      return BodyKind::sphere;
    case mjGEOM_CAPSULE:
      return BodyKind::capsule;
    case mjGEOM_CYLINDER:
      return BodyKind::cylinder;
    case mjGEOM_ELLIPSOID:
      return BodyKind::ellipsoid;
    case mjGEOM_BOX:
      return BodyKind::box;
    default:
      return BodyKind::hull;
  }
}

Expected<ConvexShape> shape_of(const GeomSource& source) {
  const std::vector<double> points(source.vertices.begin(), source.vertices.end());
  auto shape = make_body({kind_of(source.type), source.size, points});
  if (shape) return shape;
  const std::string size = source.type == mjGEOM_MESH ? "mesh_vert" : "geom_size";
  return Error{shape.error().code, shape.error().message, size + " (" + shape.error().where + ")"};
}

std::uint64_t fingerprint(const GeomSource& source) {
  std::uint64_t number = static_cast<std::uint64_t>(source.type);
  const auto add = [&](std::uint64_t bits) {
    number = (number ^ bits) * 0x9E3779B97F4A7C15ULL;
    number ^= number >> 32;
  };
  for (const double x : source.size) add(std::bit_cast<std::uint64_t>(x));
  for (const float x : source.vertices) add(std::bit_cast<std::uint32_t>(x));
  return number;
}

struct SharedShapes {
  std::mutex mutex;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const GeomShape>> shapes;
  std::size_t look_through = 64;  ///< a table of this size is searched for shapes that nobody uses

  static SharedShapes& instance() {
    static SharedShapes shapes;
    return shapes;
  }
};

}  // namespace

Expected<Pose> geom_pose(const mjData& data, int geom) {
  const mjtNum* matrix = data.geom_xmat + 9 * geom;
  const mjtNum* position = data.geom_xpos + 3 * geom;
  Mat3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = static_cast<double>(matrix[i]);
  const Vec3 translation(static_cast<double>(position[0]), static_cast<double>(position[1]),
                         static_cast<double>(position[2]));
  return checked_pose(rotation, translation);
}

bool made_from(const GeomShape& shape, const mjModel& model, int geom) {
  const GeomSource& source = shape.source;
  if (model.geom_type[geom] != source.type) return false;
  for (int i = 0; i < numbers_read(source.type); ++i) {
    // Bits, so that a NaN equals itself and is not converted again in every step.
    if (std::bit_cast<std::uint64_t>(static_cast<double>(model.geom_size[3 * geom + i])) !=
        std::bit_cast<std::uint64_t>(source.size[static_cast<std::size_t>(i)])) {
      return false;
    }
  }
  if (source.type != mjGEOM_MESH) return true;
  const MeshView mesh = mesh_of(model, geom);
  if (mesh.corners() != source.corners.size()) return false;
  std::uint32_t different = 0;
  for (std::size_t i = 0; i < source.corners.size(); ++i) {
    const std::size_t v = mesh.corner(i);
    if (v != static_cast<std::size_t>(source.corners[i]) || v >= mesh.vertices.size() / 3) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      different |= std::bit_cast<std::uint32_t>(mesh.vertices[3 * v + k]) ^
                   std::bit_cast<std::uint32_t>(source.vertices[3 * i + k]);
    }
  }
  return different == 0;
}

std::shared_ptr<const GeomShape> shared_shape(const mjModel& model, int geom) {
  GeomSource source = source_of(model, geom);
  const std::uint64_t number = fingerprint(source);
  SharedShapes& shared = SharedShapes::instance();
  const std::scoped_lock lock(shared.mutex);
  const auto [first, last] = shared.shapes.equal_range(number);
  for (auto entry = first; entry != last; ++entry) {
    if (auto known = entry->second.lock(); known && made_from(*known, model, geom)) return known;
  }
  if (shared.shapes.size() >= shared.look_through) {
    std::erase_if(shared.shapes, [](const auto& entry) { return entry.second.expired(); });
    shared.look_through = 2 * shared.shapes.size() + 64;
  }
  auto body = shape_of(source);
  const double radius = body ? bounding_radius(*body) : 0;
  auto shape = std::make_shared<const GeomShape>(GeomShape{std::move(source), std::move(body), radius});
  shared.shapes.emplace(number, shape);
  return shape;
}

std::vector<std::shared_ptr<const GeomShape>>& GeomShapes::geoms_of(const mjModel& model) {
  const auto found = std::find_if(models_.begin(), models_.end(), [&](const Model& m) { return m.model == &model; });
  if (found == models_.end()) {
    if (models_.size() == kModels) models_.pop_back();
    models_.insert(models_.begin(), Model{&model, {}});
  } else if (found != models_.begin()) {
    std::rotate(models_.begin(), found, found + 1);
  }
  auto& geoms = models_.front().geoms;
  if (geoms.size() != static_cast<std::size_t>(model.ngeom)) geoms.resize(static_cast<std::size_t>(model.ngeom));
  return geoms;
}

const GeomShape& GeomShapes::find(const mjModel& model, int geom, std::int64_t& conversions) {
  std::shared_ptr<const GeomShape>& known = geoms_of(model)[static_cast<std::size_t>(geom)];
  if (!known || !made_from(*known, model, geom)) {
    known = shared_shape(model, geom);
    ++conversions;
  }
  return *known;
}

std::string name_of(const mjModel& model, int geom) {
  const char* name = mj_id2name(&model, mjOBJ_GEOM, geom);
  const auto type = static_cast<std::size_t>(model.geom_type[geom]);
  std::string text = "geom " + std::to_string(geom) + " (";
  if (name != nullptr && *name != 0) text += "\"" + std::string(name) + "\", ";
  return text + (type < kTypeNames.size() ? kTypeNames[type] : "of another type") + ")";
}

}  // namespace pd::detail
