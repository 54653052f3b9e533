/// @file
/// Queries about one body of any dimension: directional widths, width, approximations, kernels.
#include <algorithm>
#include <optional>
#include <vector>

#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"
#include "pd/dimension/approximate_width.hpp"
#include "pd/dimension/epsilon_kernel.hpp"
#include "protocol/composed_body.hpp"
#include "protocol/dimension_body.hpp"
#include "protocol/handlers.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/streamed_kernel.hpp"

namespace pd::query {

namespace {

using dimension::Backend;
using dimension::Body;
using dimension::DirectionalWidth;
using dimension::EpsilonKernelStream;
using dimension::QueryCounters;
using dimension::Representation;
using dimension::Side;
using dimension::Vector;

void write_size(const dimension::StructureSize& size, JsonWriter& answer) {
  answer.key("points").integer(size.points).key("nodes").integer(size.nodes).key("links").integer(size.links);
  answer.key("max_out_degree").integer(size.max_out_degree).key("depth").integer(size.depth);
  answer.key("bytes").integer(size.bytes);
}

void write_counters(const QueryCounters& counters, JsonWriter& answer) {
  answer.key("queries").integer(counters.queries).key("nodes_visited").integer(counters.nodes);
  answer.key("dot_products").integer(counters.dot_products).key("deepest").integer(counters.deepest);
}

template <int D>
void write_end(const dimension::SupportPoint<D>& end, JsonWriter& answer) {
  if (end.index >= 0) {
    answer.integer(end.index);
  } else {
    write_row<D>(end.point, answer);
  }
}

/// A file whose points are read one chunk after the other: the kernel takes this share of epsilon, what follows the
/// rest. Affine images, other backends and the least epsilons hold all points.
constexpr double kStreamedShare = 0.7;
constexpr double kLeastStreamed = 1e-6;

std::optional<Node> streamed_file(const Node& body, double epsilon, Backend backend) {
  if (backend != Backend::kernel || epsilon < kLeastStreamed || body.find("affine")) return std::nullopt;
  return body.find("points_file");
}

/// The kernel's points as a body, and which points of the file they are.
template <int D>
struct Streamed {
  Body<D> body;
  std::vector<std::int64_t> indices;
};

template <int D>
Streamed<D> body_of_file(const Node& file, const Limits& limits, double epsilon) {
  EpsilonKernelStream<D> kernel = kernel_of_file<D>(file, limits, epsilon);
  Expected<Body<D>> body = Body<D>::from_points(kernel.kernel_points());
  if (!body) file.refuse(body.error());
  return {*std::move(body), kernel.finish().indices};
}

/// (1 + a) / (1 - share) = 1 + epsilon for the width of a kernel, which is the least of few points; the direction that
/// it finds is measured on all of them.
template <int D>
Expected<dimension::ApproximateWidth<D>> width_of_file(const Node& file, const Limits& limits, double epsilon) {
  const double share = epsilon * (1 - 1e-4);
  const Streamed<D> kernel = body_of_file<D>(file, limits, kStreamedShare * share / (1 + share));
  const auto found = dimension::approximate_width<D>(kernel.body, (1 - kStreamedShare) * share, Backend::kernel);
  if (!found) return found;
  dimension::ApproximateWidth<D> width = *found;
  constexpr double kRoom = 1e-10;  // what the sums of products may lose
  width.upper = std::max(width.upper, extent_of_file<D>(file, limits, width.direction) * (1 + kRoom));
  width.width = width.upper;
  return width;
}

/// Of what is composed: the polytope inside it takes this share, what follows the rest.
constexpr double kComposedShare = 0.7;

template <int D>
Expected<dimension::ApproximateSum<D>> approximate_composed(const Node& a, const Limits& limits, double epsilon,
                                                            Backend backend, Representation representation, Side side) {
  return with_fine_structures(epsilon, [&](double share) {
    return dimension::approximate_minkowski_sum<D>(read_composed<D>(a, limits, {share, backend}), epsilon,
                                                   representation, side);
  });
}

/// A polytope inside a composed body. Each of its widths is at least 1 - `epsilon` times that of the composed body.
template <int D>
struct InsideComposed {
  Body<D> body;
  double epsilon;  ///< kept by the body
  bool reached;    ///< false: a budget ended before the epsilon that was asked for
};
template <int D>
InsideComposed<D> body_of_composed(const Node& a, const Limits& limits, double epsilon, Backend backend) {
  const auto made = approximate_composed<D>(a, limits, epsilon, backend, Representation::points, Side::inner);
  if (!made) a.refuse(made.error());
  Expected<Body<D>> body = Body<D>::from_points(made->body.points);
  if (!body) a.refuse(body.error());
  return {*std::move(body), made->epsilon, made->bracket_reached};
}

template <int D>
Expected<dimension::ApproximateWidth<D>> width_of_composed(const Node& a, const Limits& limits, double epsilon,
                                                           Backend backend) {
  return with_fine_structures(0.69 * epsilon / (1 + epsilon), [&](double share) {
    return dimension::approximate_width<D>(read_composed<D>(a, limits, {share, backend}), epsilon);
  });
}

}  // namespace

void answer_approx_directional_width(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "directions", "method"});
  const Node a = line.at("a");
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line, "method");
  for_dimension(composed_dimension(a, session.limits), [&]<int D>() {
    const Node nodes = line.at("directions");
    require_array(nodes, "an array of directions");
    std::vector<Vector<D>> directions;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      directions.push_back(read_row<D>(nodes.element(i)));
      const double length = directions.back().stableNorm();
      if (length == 0) nodes.element(i).refuse("zero_direction", "a direction must not be zero");
      directions.back() /= length;
    }
    const Stopwatch watch;
    const bool composed = is_composed(a);
    const auto file = streamed_file(a, epsilon, backend);
    // (1 - share) (1 - rest) >= 1 - epsilon.
    std::optional<InsideComposed<D>> inside;
    if (composed) inside = body_of_composed<D>(a, session.limits, kComposedShare * epsilon, backend);
    const Streamed<D> input = composed ? Streamed<D>{inside->body, {}}
                              : file   ? body_of_file<D>(*file, session.limits, kStreamedShare * epsilon)
                                       : Streamed<D>{read_dimension_body<D>(a, session.limits), {}};
    const double rest = (composed ? 1 - kComposedShare : file ? 1 - kStreamedShare : 1) * epsilon;
    const auto structure = DirectionalWidth<D>::build(input.body, rest, backend);
    if (!structure) line.refuse(structure.error());
    const std::int64_t build = watch.nanoseconds();
    QueryCounters counters;
    std::vector<dimension::DirectionalWidthAnswer<D>> widths;
    for (const Vector<D>& v : directions) {
      widths.push_back(structure->width(v, counters));
      for (dimension::SupportPoint<D>* const end : {&widths.back().most, &widths.back().least}) {
        if (file && end->index >= 0) end->index = input.indices[static_cast<std::size_t>(end->index)];
        if (composed) end->index = -1;  // of no list that the asker gave: its coordinates are written
      }
    }
    const std::int64_t total = watch.nanoseconds();
    answer.key("widths").begin_array();
    for (const auto& w : widths) answer.number(w.width);
    answer.end_array().key("pairs").begin_array();
    for (const auto& w : widths) {
      answer.begin_array();
      write_end<D>(w.most, answer);
      write_end<D>(w.least, answer);
      answer.end_array();
    }
    answer.end_array();
    if (inside && !inside->reached) write_reached(1 - (1 - inside->epsilon) * (1 - rest), answer);
    answer.key("stats").begin_object();
    write_counters(counters, answer);
    write_size(structure->size(), answer);
    answer.key("build_nanoseconds").integer(build).key("nanoseconds").integer(total).end_object();
  });
}

void answer_approx_width(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "backend"});
  const Node a = line.at("a");
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line);
  for_dimension(composed_dimension(a, session.limits), [&]<int D>() {
    const Stopwatch watch;
    const auto file = streamed_file(a, epsilon, backend);
    const auto width =
        is_composed(a) ? width_of_composed<D>(a, session.limits, epsilon, backend)
        : file         ? width_of_file<D>(*file, session.limits, epsilon)
                       : dimension::approximate_width<D>(read_dimension_body<D>(a, session.limits), epsilon, backend);
    if (!width) line.refuse(width.error());
    const std::int64_t nanoseconds = watch.nanoseconds();
    answer.key("width").number(width->width).key("lower").number(width->lower).key("upper").number(width->upper);
    answer.key("direction");
    write_row<D>(width->direction, answer);
    if (!width->bracket_reached) answer.bracket_unreached();
    answer.key("stats").begin_object();
    answer.key("facets").integer(width->facets).key("vertices").integer(width->vertices);
    write_counters(width->queries, answer);
    write_size(width->structure, answer);
    answer.key("nanoseconds").integer(nanoseconds).end_object();
  });
}

void answer_approximate(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "representation", "side", "backend"});
  const Node a = line.at("a");
  const double epsilon = read_epsilon(line);
  const Representation representation = read_representation(line);
  const Side side = read_side(line);
  const Backend backend = read_backend(line);
  const bool composed = is_composed(a);
  if (backend != Backend::kernel && !composed) {
    line.at("backend").refuse("unsupported", "approximations are made from kernels; \"kernel\" answers");
  }
  for_dimension(composed_dimension(a, session.limits), [&]<int D>() {
    const Stopwatch watch;
    const auto found = [&]() -> Expected<dimension::ApproximateSum<D>> {
      if (composed) return approximate_composed<D>(a, session.limits, epsilon, backend, representation, side);
      auto made =
          dimension::approximate_body<D>(read_dimension_body<D>(a, session.limits), epsilon, representation, side);
      if (!made) return made.error();
      dimension::ApproximateSum<D> whole;
      whole.body = *std::move(made);
      return whole;
    }();
    if (!found) line.refuse(found.error());
    const dimension::ApproximateBody<D>* const small = &found->body;
    const std::int64_t nanoseconds = watch.nanoseconds();
    answer.key(representation == Representation::points ? "points" : "halfspaces").begin_array();
    for (const Vector<D>& p : small->points) write_row<D>(p, answer);
    for (const dimension::Halfspace<D>& h : small->halfspaces) write_halfspace<D>(h, answer);
    answer.end_array();
    answer.key("side").string(side == Side::outer ? "outer" : "inner");
    if (!found->bracket_reached) write_reached(found->epsilon, answer);
    answer.key("stats").begin_object().key("nanoseconds").integer(nanoseconds).end_object();
  });
}

void answer_epsilon_kernel(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "backend"});
  const Node a = line.at("a");
  const double epsilon = read_epsilon(line);
  if (read_backend(line) != Backend::kernel) {
    line.at("backend").refuse("unsupported", "a kernel is what the backend \"kernel\" builds");
  }
  if (is_composed(a)) {
    a.refuse(
        "unsupported",
        "a kernel is some of the points given, and a composed body has none; \"approximate\" with \"side\":\"inner\" "
        "answers points of it with every width at least 1 - epsilon times its own");
  }
  for_dimension(read_dimension(a, session.limits), [&]<int D>() {
    const Stopwatch watch;
    const auto write = [&](const dimension::EpsilonKernel<D>& kernel) {
      const std::int64_t nanoseconds = watch.nanoseconds();
      answer.key("indices").begin_array();
      for (const std::int64_t i : kernel.indices) answer.integer(i);
      answer.end_array().key("stats").begin_object();
      answer.key("facets").integer(kernel.facets).key("cones_visited").integer(kernel.cones_visited);
      answer.key("nanoseconds").integer(nanoseconds).end_object();
    };
    // Kernels are those of the affine image, too: streaming needs no map.
    if (const auto file = a.find("points_file"); file && !a.find("affine")) {
      return write(kernel_of_file<D>(*file, session.limits, epsilon).finish());
    }
    const auto kernel = dimension::epsilon_kernel<D>(read_dimension_body<D>(a, session.limits), epsilon);
    if (!kernel) line.refuse(kernel.error());
    write(*kernel);
  });
}

}  // namespace pd::query
