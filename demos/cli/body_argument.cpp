#include "body_argument.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "options.hpp"
#include "protocol/solid_reader.hpp"
#include "support/refusal.hpp"

namespace pd::cli {

namespace {

constexpr query::Limits kLimits{.max_vertices = 50'000'000};
constexpr int kAlongZ = 2;

struct Primitive {
  std::string_view name;
  std::string_view sizes;  ///< as help names them
  std::size_t count;
  Expected<ConvexShape> (*make)(const std::vector<double>& sizes);
};

Expected<ConvexShape> make_box(const std::vector<double>& n) {
  auto box = ConvexPolytope::box({n[0], n[1], n[2]});
  if (!box) return box.error();
  return ConvexShape(*std::move(box));
}

constexpr std::array kPrimitives{
    Primitive{"box", "X,Y,Z", 3, make_box},
    Primitive{"sphere", "R", 1, [](const std::vector<double>& n) { return ConvexShape::sphere(n[0]); }},
    Primitive{"ellipsoid", "X,Y,Z", 3,
              [](const std::vector<double>& n) {
                return ConvexShape::ellipsoid({n[0], n[1], n[2]});
              }},
    Primitive{"capsule", "R,H", 2,
              [](const std::vector<double>& n) { return ConvexShape::capsule(n[0], n[1], kAlongZ); }},
    Primitive{"cylinder", "R,H", 2,
              [](const std::vector<double>& n) { return ConvexShape::cylinder(n[0], n[1], kAlongZ); }},
    Primitive{"cone", "R,H", 2, [](const std::vector<double>& n) { return ConvexShape::cone(n[0], n[1], kAlongZ); }},
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
                  fmt::format("{}: {} expected, {}:{}", word, primitive.count == 1 ? "a number is" : "numbers are",
                              primitive.name, primitive.sizes),
                  "");
  }
  Expected<ConvexShape> shape = primitive.make(sizes);
  if (!shape) query::refuse(to_string(shape.error().code), word + ": " + shape.error().message, "");
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

/// Read once: a mesh is looked at as a solid and then as a hull.
const std::string& standard_input() {
  static const std::string bytes = read_standard_input();
  return bytes;
}

/// Asks `body_of` for the body of the mesh that standard input holds; a refusal names where the mesh came from.
template <class BodyOf>
auto body_of_standard_input(BodyOf&& body_of) {
  const std::string name = "standard input";
  try {
    return body_of(query::read_mesh_bytes(standard_input(), kLimits.max_vertices), name);
  } catch (const query::Refusal& refusal) {
    query::refuse(refusal.code, refusal.message.starts_with(name) ? refusal.message : name + ": " + refusal.message,
                  "");
  }
}

query::NamedShape shape_of_standard_input(query::MeshAs as) {
  return body_of_standard_input(
      [&](query::MeshPoints mesh, const std::string& name) { return query::hull_of_mesh(std::move(mesh), name, as); });
}

}  // namespace

std::optional<MeshSolid> read_solid_argument(const std::string& word) {
  if (find_primitive(word) != nullptr) return std::nullopt;
  const query::SolidWish wish{.hull_words = "--hull"};
  if (word != "-") return query::load_solid(word, kLimits, wish);
  return body_of_standard_input(
      [&](const query::MeshPoints& mesh, const std::string& name) { return query::solid_of_mesh(mesh, name, wish); });
}

query::NamedShape read_body_argument(const BodyArgument& argument) {
  const Primitive* const primitive = find_primitive(argument.word);
  query::NamedShape body = primitive != nullptr   ? shape_of(*primitive, argument.word)
                           : argument.word == "-" ? shape_of_standard_input(argument.as)
                                                  : query::load_mesh_shape(argument.word, kLimits, argument.as);
  if (argument.margin == 0) return body;
  auto swept = body.shape.with_margin(argument.margin);
  if (!swept) query::refuse(to_string(swept.error().code), "--margin: " + swept.error().message, "");
  body.shape = *std::move(swept);
  return body;
}

}  // namespace pd::cli
