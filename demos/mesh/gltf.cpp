/// @file
/// glTF 2 (.gltf, .glb): every mesh of the scene, once for every node that shows it.
///
/// [GLTF] Khronos Group, "glTF 2.0 Specification", sections 3.5 (scenes, nodes), 3.7 (meshes) and 4 (GLB).
///
/// The time and memory of a file are those of its bytes and of what --max-vertices allows: nodes are a tree, which is
/// checked before the walk, a mesh is read once however many nodes show it, and only the vertices that its faces name
/// are made.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "mesh/gltf_file.hpp"
#include "mesh/mesh_text.hpp"
#include "protocol/line/bounded_line.hpp"

namespace pd::query {

namespace {

using Placement = Eigen::Affine3d;

/// Deepest chain of nodes. Skeletons of animals have some tens.
constexpr int kMaxNodeDepth = 1000;

// ---- the file ----------------------------------------------------------------------------------------------------

struct GltfParts {
  std::string_view json;
  std::optional<std::string_view> chunk;
};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

/// JSON and binary chunk. A GLB is known by its first four bytes, whatever the file is called.
GltfParts parts_of(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return {bytes, std::nullopt};
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto malformed = [](const std::string& what) { refuse("unreadable_file", "GLB: " + what, ""); };
  if (bytes.size() < kHeader + kChunkHeader) malformed("the file ends in its header");
  if (word_at(bytes, 4) != 2) malformed("version " + std::to_string(word_at(bytes, 4)) + "; 2 is read");
  if (word_at(bytes, 8) > bytes.size()) {
    malformed("it claims " + std::to_string(word_at(bytes, 8)) + " bytes, the file has " +
              std::to_string(bytes.size()));
  }
  GltfParts parts;
  for (std::size_t at = kHeader; at + kChunkHeader <= bytes.size();) {
    const std::uint32_t length = word_at(bytes, at), type = word_at(bytes, at + 4);
    at += kChunkHeader;
    if (length > bytes.size() - at) {
      malformed("a chunk claims " + std::to_string(length) + " bytes, " + std::to_string(bytes.size() - at) +
                " are left");
    }
    if (type == kJson && parts.json.empty()) parts.json = bytes.substr(at, length);
    if (type == kBinary && !parts.chunk) parts.chunk = bytes.substr(at, length);
    at += length;
  }
  return parts;
}

void require_version_2(const Node& root) {
  const Node asset = root.at("asset");
  require_object(asset);
  const Node version = asset.at("version");
  if (!read_string(version).starts_with("2.")) version.refuse("unsupported", "only glTF 2 is read");
  const auto required = root.find("extensionsRequired");
  if (!required) return;
  require_array(*required, "an array of names");
  for (std::size_t i = 0; i < required->size(); ++i) {
    const Node name = required->element(i);
    for (const char* unread : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
                               "EXT_mesh_gpu_instancing"}) {
      if (read_string(name) == unread) name.refuse("unsupported", std::string(unread) + " is not read");
    }
  }
}

// ---- meshes ------------------------------------------------------------------------------------------------------

/// A mesh in its own frame: the vertices that some element names.
struct GltfMesh {
  struct Element {
    std::int32_t end;  ///< of its corners
    bool is_face;
  };
  std::vector<Vec3> points;
  std::vector<std::int32_t> corners;
  std::vector<Element> elements;
};

enum Mode : std::int64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

class MeshReader {
 public:
  MeshReader(const Node& primitives, GltfBuffers& buffers, const VertexCollector& limits)
      : primitives_(primitives), buffers_(buffers), limits_(limits) {}

  GltfMesh read() {
    require_array(primitives_, "an array of primitives");
    for (std::size_t i = 0; i < primitives_.size(); ++i) read_primitive(primitives_.element(i));
    return std::move(mesh_);
  }

 private:
  void read_primitive(const Node& primitive) {
    const Node attributes = primitive.at("attributes");
    require_object(attributes);
    const auto position = attributes.find("POSITION");
    if (!position) return;  // nothing that has a place
    const GltfValues points = buffers_.values(read_integer(*position, 0, kMostIndex), "VEC3");
    std::vector<std::int64_t> order;
    if (const auto indices = primitive.find("indices")) {
      const GltfValues numbers = buffers_.values(read_integer(*indices, 0, kMostIndex), "SCALAR");
      announce(numbers.size());
      order.reserve(static_cast<std::size_t>(numbers.size()));
      for (std::int64_t i = 0; i < numbers.size(); ++i) {
        const double index = numbers.at(i, 0);
        if (!(index >= 0 && index < static_cast<double>(points.size()))) {
          indices->refuse("bad_value", "a face names a vertex that is not there");
        }
        order.push_back(static_cast<std::int64_t>(index));
      }
    } else {
      limits_.announce(points.size());
      announce(points.size());
      for (std::int64_t i = 0; i < points.size(); ++i) order.push_back(i);
    }
    const std::int64_t mode = gltf_integer(primitive, "mode", kTriangles);
    if (mode > kTriangleFan) primitive.refuse("bad_value", "\"mode\" must be 0 to 6");
    add_elements(mode, number_used(points, order));
  }

  /// Makes the points that `order` names, and returns the numbers of its corners in the mesh.
  std::vector<std::int32_t> number_used(const GltfValues& points, const std::vector<std::int64_t>& order) {
    std::vector<std::int64_t> used = order;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto first = static_cast<std::int64_t>(mesh_.points.size());
    limits_.announce(first + static_cast<std::int64_t>(used.size()));
    for (const std::int64_t index : used) mesh_.points.push_back(points.point(index));
    std::vector<std::int32_t> numbers;
    numbers.reserve(order.size());
    for (const std::int64_t index : order) {
      const auto place = std::lower_bound(used.begin(), used.end(), index) - used.begin();
      numbers.push_back(static_cast<std::int32_t>(first + place));
    }
    return numbers;
  }

  void add_elements(std::int64_t mode, const std::vector<std::int32_t>& order) {
    const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
      for (const std::size_t k : {a, b, c}) mesh_.corners.push_back(order[k]);
      end_element(true);
    };
    const std::size_t n = order.size();
    if (mode == kTriangles) {
      for (std::size_t i = 0; i + 2 < n; i += 3) triangle(i, i + 1, i + 2);
    } else if (mode == kTriangleStrip) {
      for (std::size_t i = 0; i + 2 < n; ++i) triangle(i, i + 1 + i % 2, i + 2 - i % 2);
    } else if (mode == kTriangleFan) {
      for (std::size_t i = 1; i + 1 < n; ++i) triangle(0, i, i + 1);
    } else {
      mesh_.corners.insert(mesh_.corners.end(), order.begin(), order.end());
      end_element(false);
    }
  }
  void end_element(bool is_face) {
    announce(0);
    mesh_.elements.push_back({static_cast<std::int32_t>(mesh_.corners.size()), is_face});
  }
  void announce(std::int64_t corners) const {
    limits_.announce_corners(static_cast<std::int64_t>(mesh_.corners.size()) + corners);
  }

  static constexpr std::int64_t kMostIndex = std::int64_t{1} << 32;

  const Node& primitives_;
  GltfBuffers& buffers_;
  const VertexCollector& limits_;
  GltfMesh mesh_;
};

// ---- the scene ---------------------------------------------------------------------------------------------------

class SceneReader {
 public:
  SceneReader(const Node& root, GltfBuffers& buffers, VertexCollector& vertices)
      : root_(root),
        nodes_(root.find("nodes")),
        mesh_list_(root.find("meshes")),
        buffers_(buffers),
        vertices_(vertices) {
    if (nodes_) require_array(*nodes_, "an array");
    if (mesh_list_) require_array(*mesh_list_, "an array");
    meshes_.resize(mesh_list_ ? mesh_list_->size() : 0);
  }

  void read() {
    find_parents();
    struct Visit {
      std::int64_t node;
      int depth;
      Placement parent;
    };
    std::vector<Visit> open;
    const std::vector<std::int64_t> first = roots();
    for (auto node = first.rbegin(); node != first.rend(); ++node) open.push_back({*node, 1, Placement::Identity()});
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      const Node node = gltf_element(nodes_, "nodes", visit.node);
      if (visit.depth > kMaxNodeDepth) {
        node.refuse("limit_exceeded", "nodes stand deeper than " + std::to_string(kMaxNodeDepth) + " levels");
      }
      const Placement placement = visit.parent * placement_of(node);
      if (const auto mesh = node.find("mesh")) place(read_integer(*mesh, 0, kMostIndex), placement);
      const std::vector<std::int64_t>& children = children_[static_cast<std::size_t>(visit.node)];
      for (auto child = children.rbegin(); child != children.rend(); ++child) {
        open.push_back({*child, visit.depth + 1, placement});
      }
    }
  }

 private:
  std::vector<std::int64_t> indices_of(const Node& list) const {
    require_array(list, "an array of indices");
    std::vector<std::int64_t> indices;
    for (std::size_t i = 0; i < list.size(); ++i) indices.push_back(read_integer(list.element(i), 0, kMostIndex));
    return indices;
  }

  /// [GLTF] 3.5.2: nodes are trees, so that no node has two parents. A file that says otherwise could show a mesh
  /// 2^levels times.
  void find_parents() {
    const std::size_t n = nodes_ ? nodes_->size() : 0;
    children_.resize(n);
    has_parent_.resize(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const Node node = nodes_->element(i);
      require_object(node);
      const auto list = node.find("children");
      if (!list) continue;
      children_[i] = indices_of(*list);
      for (const std::int64_t child : children_[i]) {
        (void)gltf_element(nodes_, "nodes", child);
        if (std::exchange(has_parent_[static_cast<std::size_t>(child)], char{1}) != 0) {
          list->refuse("bad_value", "node " + std::to_string(child) + " has two parents; nodes must be a tree");
        }
      }
    }
  }

  /// Nodes of the file's scene, or else of the first one, or else all without a parent.
  std::vector<std::int64_t> roots() const {
    std::vector<std::int64_t> roots;
    const auto scenes = root_.find("scenes");
    if (scenes && scenes->size() > 0) {
      const Node scene = gltf_element(scenes, "scenes", gltf_integer(root_, "scene", 0));
      require_object(scene);
      if (const auto list = scene.find("nodes")) {
        roots = indices_of(*list);
        std::vector<char> seen(has_parent_);
        for (const std::int64_t node : roots) {
          (void)gltf_element(nodes_, "nodes", node);
          if (std::exchange(seen[static_cast<std::size_t>(node)], char{1}) != 0) {
            list->refuse("bad_value", "node " + std::to_string(node) + " is no root, or stands twice");
          }
        }
      }
      return roots;
    }
    for (std::size_t i = 0; i < has_parent_.size(); ++i) {
      if (has_parent_[i] == 0) roots.push_back(static_cast<std::int64_t>(i));
    }
    return roots;
  }

  static Placement placement_of(const Node& node) {
    Placement placement = Placement::Identity();
    if (const auto matrix = node.find("matrix")) {
      const std::vector<double> m = read_numbers(*matrix, 16);
      placement.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix4d>(m.data()).topRows<3>();
      return placement;
    }
    if (const auto translation = node.find("translation")) placement.translate(read_vector(*translation));
    if (const auto rotation = node.find("rotation")) {
      const std::vector<double> q = read_numbers(*rotation, 4);
      placement.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
    }
    if (const auto scale = node.find("scale")) placement.scale(read_vector(*scale));
    return placement;
  }

  void place(std::int64_t index, const Placement& placement) {
    const Node node = gltf_element(mesh_list_, "meshes", index);
    std::optional<GltfMesh>& mesh = meshes_[static_cast<std::size_t>(index)];
    if (!mesh) {
      require_object(node);
      const Node primitives = node.at("primitives");
      mesh = MeshReader(primitives, buffers_, vertices_).read();
    }
    const auto name = node.find("name");
    // Every showing is a group: a mesh may be shown several times.
    vertices_.begin_group(std::to_string(shown_++), name && name->json().is_string() ? read_string(*name) : "mesh");
    const std::int64_t first = vertices_.size();
    for (const Vec3& point : mesh->points) vertices_.add(placement * point);
    // A mirror turns every face inside out.
    const bool mirrored = placement.linear().determinant() < 0;
    std::int32_t begin = 0;
    for (const GltfMesh::Element& element : mesh->elements) {
      for (std::int32_t k = begin; k < element.end; ++k) {
        const std::int32_t at = mirrored ? begin + element.end - 1 - k : k;
        vertices_.corner(first + mesh->corners[static_cast<std::size_t>(at)]);
      }
      vertices_.end_element(element.is_face, 0);
      begin = element.end;
    }
  }

  static constexpr std::int64_t kMostIndex = std::int64_t{1} << 32;

  const Node& root_;
  std::optional<Node> nodes_;
  std::optional<Node> mesh_list_;
  GltfBuffers& buffers_;
  VertexCollector& vertices_;
  std::int64_t shown_ = 0;
  std::vector<std::vector<std::int64_t>> children_;
  std::vector<char> has_parent_;
  std::vector<std::optional<GltfMesh>> meshes_;
};

}  // namespace

MeshPoints read_gltf(const std::string& path, std::string bytes, std::int64_t max_vertices, std::uintmax_t max_bytes) {
  const GltfParts parts = parts_of(bytes);
  try {
    const ParsedLine parsed = parse_line_within(parts.json, max_vertices);
    if (parsed.refusal) throw Refusal(*parsed.refusal);
    const Node root(parsed.object);
    require_version_2(root);
    GltfBuffers buffers(root, {path, parts.chunk, max_bytes, 16 * max_vertices});
    VertexCollector vertices(max_vertices);
    SceneReader(root, buffers, vertices).read();
    return std::move(vertices).finish();
  } catch (const Refusal& refusal) {
    const std::string where = refusal.where.empty() ? "" : " at " + refusal.where;
    const bool keeps_code = refusal.code == "limit_exceeded" || refusal.code == "unsupported";
    refuse(keeps_code ? refusal.code : "unreadable_file", "glTF" + where + ": " + refusal.message, "");
  }
}

}  // namespace pd::query
