/// @file
/// Queries about one body of any dimension: directional widths, width, approximations, kernels.
#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/approximate_width.hpp"
#include "pd/dimension/epsilon_kernel.hpp"
#include "protocol/dimension_body.hpp"
#include "protocol/handlers.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/points_file.hpp"
#include "support/refusal.hpp"

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

/// The kernel of points in a file, which are never all in memory.
template <int D>
dimension::EpsilonKernel<D> kernel_of_file(const Node& node, double epsilon) {
  constexpr std::size_t kChunk = 65536;
  Expected<EpsilonKernelStream<D>> made = EpsilonKernelStream<D>::create(epsilon);
  if (!made) node.refuse(made.error());
  EpsilonKernelStream<D> kernel = *std::move(made);
  try {
    PointsFile file(read_string(node));
    std::vector<double> numbers;
    std::vector<Vector<D>> chunk;
    const auto next = [&] {
      chunk.clear();
      if (!file.next(numbers, kChunk)) return false;
      for (std::size_t i = 0; i < numbers.size(); i += D) {
        chunk.push_back(Eigen::Map<const Eigen::Matrix<double, D, 1>>(numbers.data() + i));
      }
      return true;
    };
    while (next()) {
      if (const auto error = kernel.survey(chunk)) node.refuse(*error);
    }
    if (const auto error = kernel.end_survey()) node.refuse(*error);
    file.rewind();
    while (next()) kernel.select(chunk);
  } catch (const Refusal& refusal) {
    if (!refusal.where.empty()) throw;
    node.refuse(refusal.code, refusal.message);
  }
  return kernel.finish();
}

}  // namespace

void answer_approx_directional_width(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "directions", "method"});
  const Node a = line.at("a");
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line, "method");
  for_dimension(read_dimension(a, session.limits), [&]<int D>() {
    const Node nodes = line.at("directions");
    require_array(nodes, "an array of directions");
    std::vector<Vector<D>> directions;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      directions.push_back(read_row<D>(nodes.element(i)));
      const double length = directions.back().stableNorm();
      if (length == 0) nodes.element(i).refuse("zero_direction", "a direction must not be zero");
      directions.back() /= length;
    }
    const Body<D> body = read_dimension_body<D>(a, session.limits);
    const Stopwatch watch;
    const auto structure = DirectionalWidth<D>::build(body, epsilon, backend);
    if (!structure) line.refuse(structure.error());
    const std::int64_t build = watch.nanoseconds();
    QueryCounters counters;
    std::vector<dimension::DirectionalWidthAnswer<D>> widths;
    for (const Vector<D>& v : directions) widths.push_back(structure->width(v, counters));
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
    answer.end_array().key("stats").begin_object();
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
  for_dimension(read_dimension(a, session.limits), [&]<int D>() {
    const Body<D> body = read_dimension_body<D>(a, session.limits);
    const Stopwatch watch;
    const auto width = dimension::approximate_width<D>(body, epsilon, backend);
    if (!width) line.refuse(width.error());
    const std::int64_t nanoseconds = watch.nanoseconds();
    answer.key("width").number(width->width).key("lower").number(width->lower).key("upper").number(width->upper);
    answer.key("direction");
    write_row<D>(width->direction, answer);
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
  Side side = Side::outer;
  if (const auto node = line.find("side")) {
    const std::string word = read_string(*node);
    if (word != "inner" && word != "outer") node->refuse("bad_value", "unknown side; known: inner, outer");
    if (word == "inner") side = Side::inner;
  }
  if (read_backend(line) != Backend::kernel) {
    line.at("backend").refuse("unsupported", "approximations are made from kernels; \"kernel\" answers");
  }
  for_dimension(read_dimension(a, session.limits), [&]<int D>() {
    const Body<D> body = read_dimension_body<D>(a, session.limits);
    const Stopwatch watch;
    const auto small = dimension::approximate_body<D>(body, epsilon, representation, side);
    if (!small) line.refuse(small.error());
    const std::int64_t nanoseconds = watch.nanoseconds();
    answer.key(representation == Representation::points ? "points" : "halfspaces").begin_array();
    for (const Vector<D>& p : small->points) write_row<D>(p, answer);
    for (const dimension::Halfspace<D>& h : small->halfspaces) write_halfspace<D>(h, answer);
    answer.end_array();
    answer.key("side").string(side == Side::outer ? "outer" : "inner");
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
      return write(kernel_of_file<D>(*file, epsilon));
    }
    const auto kernel = dimension::epsilon_kernel<D>(read_dimension_body<D>(a, session.limits), epsilon);
    if (!kernel) line.refuse(kernel.error());
    write(*kernel);
  });
}

}  // namespace pd::query
