#include "body_argument.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "mesh/mesh_file.hpp"
#include "options.hpp"
#include "protocol/solid_reader.hpp"
#include "support/refusal.hpp"

namespace pd::cli {

namespace {

constexpr query::Limits kLimits{.max_vertices = 50'000'000};
constexpr int kAlongZ = 2;
constexpr const char* kStandardInput = "standard input";

struct Primitive {
  std::string_view name;
  std::string_view sizes;  ///< as help names them
  std::string_view meaning;
  std::size_t count;
  Expected<ConvexShape> (*make)(const std::vector<double>& sizes);
};

Expected<ConvexShape> make_box(const std::vector<double>& n) {
  auto box = ConvexPolytope::box({n[0], n[1], n[2]});
  if (!box) return box.error();
  return ConvexShape(*std::move(box));
}

constexpr std::string_view kRadiusAndHeight = "radius and half the height, along z";

constexpr std::array kPrimitives{
    Primitive{"box", "X,Y,Z", "half extents", 3, make_box},
    Primitive{"sphere", "R", "the radius", 1, [](const std::vector<double>& n) { return ConvexShape::sphere(n[0]); }},
    Primitive{"ellipsoid", "X,Y,Z", "radii", 3,
              [](const std::vector<double>& n) {
                return ConvexShape::ellipsoid({n[0], n[1], n[2]});
              }},
    Primitive{"capsule", "R,H", kRadiusAndHeight, 2,
              [](const std::vector<double>& n) { return ConvexShape::capsule(n[0], n[1], kAlongZ); }},
    Primitive{"cylinder", "R,H", kRadiusAndHeight, 2,
              [](const std::vector<double>& n) { return ConvexShape::cylinder(n[0], n[1], kAlongZ); }},
    Primitive{"cone", "R,H", kRadiusAndHeight, 2,
              [](const std::vector<double>& n) { return ConvexShape::cone(n[0], n[1], kAlongZ); }},
};

const Primitive* find_primitive(std::string_view word) {
  const std::size_t colon = word.find(':');
  for (const Primitive& primitive : kPrimitives) {
    if (colon != word.npos && word.substr(0, colon) == primitive.name) return &primitive;
  }
  return nullptr;
}

query::NamedShape shape_of(const Primitive& primitive, const std::string& word) {
  const std::vector<double> sizes = parse_numbers(word.substr(primitive.name.size() + 1), word);
  if (sizes.size() != primitive.count) {
    query::refuse("bad_value",
                  fmt::format("{}: expected is {}:{}, {}", word, primitive.name, primitive.sizes, primitive.meaning),
                  "");
  }
  Expected<ConvexShape> shape = primitive.make(sizes);
  if (!shape) {
    query::refuse(to_string(shape.error().code),
                  fmt::format("{}: {} ({}:{} is {})", word, shape.error().message, primitive.name, primitive.sizes,
                              primitive.meaning),
                  "");
  }
  return {*std::move(shape), {}};
}

std::string read_standard_input() {
  std::string bytes;
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t got = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) query::refuse("unreadable_file", std::string("standard input: ") + std::strerror(errno), "");
    if (got == 0) return bytes;
    bytes.append(buffer.data(), static_cast<std::size_t>(got));
    if (bytes.size() > query::kMaxMeshBytes) query::refuse("limit_exceeded", "standard input: more than 1 GiB", "");
  }
}

/// Standard input can be read once only.
const std::string& standard_input() {
  static const std::string bytes = read_standard_input();
  return bytes;
}

/// The words of a reader name an option of `pdepth query` behind its limit.
std::string without_option(std::string words) {
  constexpr std::string_view kOption = " (--max-vertices)";
  const std::size_t at = words.find(kOption);
  return at == words.npos ? words : words.erase(at, kOption.size());
}

/// A word that names no file, but may have been meant as a primitive: "Box:1,1,1", "cube:1", "sphere".
void refuse_unknown_primitive(const std::string& word) {
  std::error_code missing;
  if (query::is_mesh_name(word) || std::filesystem::exists(word, missing)) return;
  std::string forms;
  for (const Primitive& primitive : kPrimitives) {
    forms += fmt::format("{}{}:{}", forms.empty() ? "" : ", ", primitive.name, primitive.sizes);
  }
  query::refuse("unreadable_file", word + ": neither a file nor a primitive; the primitives are " + forms, "");
}

/// Reads the mesh that an argument names. A refusal begins with the file's name, or says that it was standard input.
query::MeshPoints read_points_of(const std::string& word) {
  if (word != "-") {
    refuse_unknown_primitive(word);
    return read_mesh_argument(word, kLimits.max_vertices);
  }
  try {
    return query::read_mesh_bytes(standard_input(), kLimits.max_vertices);
  } catch (const query::Refusal& refusal) {
    query::refuse(refusal.code, kStandardInput + (": " + without_option(refusal.message)), "");
  }
}

std::string name_of(const std::string& word) { return word == "-" ? kStandardInput : word; }

/// Reads and checks a file once: a mesh is looked at as a solid and then as a hull.
const query::MeshBody& mesh_argument(const std::string& word) {
  static std::map<std::string, query::MeshBody> known;
  const auto [place, fresh] = known.try_emplace(word);
  if (fresh) {
    place->second =
        query::body_of_mesh(read_points_of(word), name_of(word), {.hull_words = "--hull", .parts_words = "--parts"});
  }
  return place->second;
}

query::NamedShape shape_of_mesh(const BodyArgument& argument) {
  if (argument.as == query::MeshAs::found) {
    if (const auto& hull = mesh_argument(argument.word).hull) return *hull;
  }
  return query::hull_of_mesh(read_points_of(argument.word), name_of(argument.word), argument.as);
}

}  // namespace

query::MeshPoints read_mesh_argument(const std::string& file, std::int64_t most_points) {
  std::error_code missing;  // a missing file is refused by its reader
  if (std::filesystem::is_directory(file, missing)) {
    query::refuse("unreadable_file", file + ": a folder; a file is expected", "");
  }
  try {
    return query::read_mesh_points(file, most_points, query::kMaxMeshBytes);
  } catch (const query::Refusal& refusal) {
    query::refuse(refusal.code, without_option(refusal.message), refusal.where);
  }
}

bool names_mesh(const std::string& word) { return find_primitive(word) == nullptr; }

std::shared_ptr<const MeshSolid> read_solid_argument(const std::string& word) {
  return find_primitive(word) != nullptr ? nullptr : mesh_argument(word).solid;
}

query::NamedShape read_body_argument(const BodyArgument& argument) {
  const Primitive* const primitive = find_primitive(argument.word);
  query::NamedShape body = primitive != nullptr ? shape_of(*primitive, argument.word) : shape_of_mesh(argument);
  if (argument.margin == 0) return body;
  auto swept = body.shape.with_margin(argument.margin);
  if (!swept) query::refuse(to_string(swept.error().code), "--margin: " + swept.error().message, "");
  body.shape = *std::move(swept);
  return body;
}

query::NamedBody read_parts_argument(const BodyArgument& argument) {
  if (find_primitive(argument.word) != nullptr) {
    query::NamedShape shape = read_body_argument(argument);
    Compound compound(shape.shape);
    return {std::move(compound), {std::move(shape)}};
  }
  query::NamedBody body =
      query::parts_of_mesh(read_points_of(argument.word), name_of(argument.word), {.hull_words = "--hull"});
  if (argument.margin > 0) {
    auto swept = body.compound.with_margin(argument.margin);
    if (!swept) query::refuse(to_string(swept.error().code), "--margin: " + swept.error().message, "");
    body.compound = *std::move(swept);
  }
  return body;
}

}  // namespace pd::cli
