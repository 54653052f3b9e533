#include "protocol/dimension_body.hpp"

#include <algorithm>

#include "files/points_file.hpp"
#include "support/refusal.hpp"

namespace pd::query {

namespace {

constexpr std::size_t kChunk = 65536;
/// A header may claim more rows than the file holds.
constexpr std::int64_t kMostReserved = 100'000'000;

int checked_dimension(const Node& node, std::size_t dimension) {
  if (dimension < dimension::kMinDimension || dimension > dimension::kMaxDimension) {
    node.refuse("out_of_range", "bodies live in 2 to 5 dimensions, this one in " + std::to_string(dimension));
  }
  return static_cast<int>(dimension);
}

PointsFile open_file(const Node& node, const Limits& limits) {
  const std::string path = read_string(node);
  if (!limits.files) node.refuse("unsupported", "bodies that name a file are refused here (--no-files)");
  try {
    return PointsFile(path, limits.max_file_points());
  } catch (const Refusal& refusal) {
    node.refuse(refusal.code, refusal.message);
  }
}

std::size_t first_row_length(const Node& rows, std::string_view meaning) {
  require_array(rows, meaning);
  if (rows.size() == 0) rows.refuse("too_few_points", "must not be empty");
  require_array(rows.element(0), "an array of numbers");
  return rows.element(0).size();
}

void require_one_kind(const Node& body) {
  require_object(body);
  allow_only(body, {"points", "points_file", "halfspaces", "affine"});
  const int kinds = static_cast<int>(body.find("points").has_value()) +
                    static_cast<int>(body.find("points_file").has_value()) +
                    static_cast<int>(body.find("halfspaces").has_value());
  if (kinds == 0) body.refuse("missing_field", "a body needs \"points\", \"points_file\" or \"halfspaces\"");
  if (kinds > 1) body.refuse("bad_value", "a body is given once: \"points\", \"points_file\" or \"halfspaces\"");
}

void check_count(const Node& rows, const Limits& limits) {
  if (static_cast<std::int64_t>(rows.size()) > limits.max_vertices) {
    rows.refuse("limit_exceeded", "more than " + std::to_string(limits.max_vertices) + " rows (--max-vertices)");
  }
}

template <int D>
std::vector<dimension::Vector<D>> read_file(const Node& node, const Limits& limits) {
  PointsFile file = open_file(node, limits);
  std::vector<dimension::Vector<D>> points;
  std::vector<double> numbers;
  try {
    // Grown step by step, ten million points would take three times their own room for a while.
    points.reserve(static_cast<std::size_t>(std::min(file.rows(), kMostReserved)));
    while (file.next(numbers, kChunk)) {
      for (std::size_t i = 0; i < numbers.size(); i += D) {
        points.push_back(Eigen::Map<const Eigen::Matrix<double, D, 1>>(numbers.data() + i));
      }
    }
  } catch (const Refusal& refusal) {
    node.refuse(refusal.code, refusal.message);
  }
  return points;
}

}  // namespace

int read_dimension(const Node& body, const Limits& limits) {
  require_one_kind(body);
  if (const auto points = body.find("points")) {
    return checked_dimension(*points, first_row_length(*points, "an array of points"));
  }
  if (const auto file = body.find("points_file")) {
    return checked_dimension(*file, static_cast<std::size_t>(open_file(*file, limits).dimension()));
  }
  const Node halfspaces = body.at("halfspaces");
  const std::size_t length = first_row_length(halfspaces, "an array of halfspaces");
  return checked_dimension(halfspaces, length == 0 ? 0 : length - 1);
}

template <int D>
dimension::Vector<D> read_row(const Node& node) {
  const std::vector<double> numbers = read_numbers(node, D);
  return Eigen::Map<const Eigen::Matrix<double, D, 1>>(numbers.data());
}

template <int D>
dimension::AffineMap<D> read_affine_map(const Node& body) {
  dimension::AffineMap<D> map;
  const auto node = body.find("affine");
  if (!node) return map;
  require_object(*node);
  allow_only(*node, {"matrix", "translation"});
  if (const auto matrix = node->find("matrix")) {
    require_array(*matrix, "the rows of a matrix");
    if (matrix->size() != D) matrix->refuse("bad_value", "must have " + std::to_string(D) + " rows");
    for (int k = 0; k < D; ++k) {
      map.linear.row(k) = read_row<D>(matrix->element(static_cast<std::size_t>(k))).transpose();
    }
  }
  if (const auto translation = node->find("translation")) map.translation = read_row<D>(*translation);
  return map;
}

template <int D>
dimension::Body<D> read_dimension_body(const Node& body, const Limits& limits) {
  using dimension::Body;
  require_one_kind(body);
  const auto make = [&]() -> Expected<Body<D>> {
    if (const auto points = body.find("points")) {
      require_array(*points, "an array of points");
      check_count(*points, limits);
      std::vector<dimension::Vector<D>> rows;
      for (std::size_t i = 0; i < points->size(); ++i) rows.push_back(read_row<D>(points->element(i)));
      return Body<D>::from_points(std::move(rows));
    }
    if (const auto file = body.find("points_file")) return Body<D>::from_points(read_file<D>(*file, limits));
    const Node halfspaces = body.at("halfspaces");
    require_array(halfspaces, "an array of halfspaces");
    check_count(halfspaces, limits);
    std::vector<dimension::Halfspace<D>> rows;
    for (std::size_t i = 0; i < halfspaces.size(); ++i) {
      const std::vector<double> numbers = read_numbers(halfspaces.element(i), D + 1);
      rows.push_back({Eigen::Map<const Eigen::Matrix<double, D, 1>>(numbers.data()), numbers[D]});
    }
    return Body<D>::from_halfspaces(std::move(rows));
  };
  Expected<Body<D>> made = make();
  if (!made) body.refuse(made.error());
  if (!body.find("affine")) return *std::move(made);
  Expected<Body<D>> image = made->transformed(read_affine_map<D>(body));
  if (!image) body.refuse(image.error());
  return *std::move(image);
}

double read_epsilon(const Node& line) {
  const Node node = line.at("epsilon");
  const double epsilon = read_number(node);
  if (!(epsilon > 0 && epsilon < 1)) node.refuse("bad_value", "must lie in (0, 1)");
  return epsilon;
}

dimension::Backend read_backend(const Node& line, std::string_view key) {
  const auto node = line.find(key);
  if (!node) return dimension::Backend::kernel;
  const std::string word = read_string(*node);
  if (word == "kernel") return dimension::Backend::kernel;
  if (word == "exact") return dimension::Backend::exact;
  if (word == "macbeath") return dimension::Backend::macbeath;
  node->refuse("bad_value", "unknown backend; known: exact, kernel, macbeath");
}

dimension::Side read_side(const Node& line) {
  const auto node = line.find("side");
  if (!node) return dimension::Side::outer;
  const std::string word = read_string(*node);
  if (word != "inner" && word != "outer") node->refuse("bad_value", "unknown side; known: inner, outer");
  return word == "inner" ? dimension::Side::inner : dimension::Side::outer;
}

dimension::Representation read_representation(const Node& line) {
  const Node node = line.at("representation");
  const std::string word = read_string(node);
  if (word == "points") return dimension::Representation::points;
  if (word == "halfspaces") return dimension::Representation::halfspaces;
  node.refuse("bad_value", "unknown representation; known: points, halfspaces");
}

#define PD_INSTANTIATE(D)                                           \
  template dimension::Vector<D> read_row<D>(const Node&);           \
  template dimension::AffineMap<D> read_affine_map<D>(const Node&); \
  template dimension::Body<D> read_dimension_body<D>(const Node&, const Limits&);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::query
