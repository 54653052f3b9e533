#include "bench/measure/table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "bench/measure/stopwatch.hpp"
#include "bench/peers/solver.hpp"

namespace pd::bench {

namespace {

constexpr std::string_view kColumns =
    "family,vertices,depth,solver,pairs,p50_ns,p99_ns,ratio_to_bullet,wrong,allocations";

std::string time_text(double ns) {
  if (!std::isfinite(ns)) return "-";
  if (ns < 9999.5) return fmt::format("{:.0f} ns", ns);
  return ns < 9999500 ? fmt::format("{:.1f} us", ns * 1e-3) : fmt::format("{:.1f} ms", ns * 1e-6);
}

std::string number_text(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

}  // namespace

void set_ratios(std::vector<Row>& cell, std::string_view baseline) {
  double bullet = kUnknown;
  for (const Row& row : cell) {
    if (row.solver == baseline) bullet = row.p50_ns;
  }
  for (Row& row : cell) row.ratio_to_bullet = row.p50_ns / bullet;
}

void print_header() {
  fmt::print("{:<19} {:>8} {:<8} {:<20} {:>5} {:>10} {:>10} {:>10} {:>9} {:>6} {:>9} {:>9} {:>7}\n", "family",
             "vertices", "depth", "solver", "pairs", "p50", "p99", "max", "x bullet", "wrong", "error/L", "supports",
             "allocs");
}

void print_rows(const std::vector<Row>& cell) {
  for (const Row& r : cell) {
    fmt::print("{:<19} {:>8} {:<8} {:<20} {:>5} {:>10} {:>10} {:>10} {:>9} {:>6} {:>9.1e} {:>9} {:>7}{}\n", r.family,
               r.vertices, r.depth, r.solver, r.pairs, time_text(r.p50_ns), time_text(r.p99_ns), time_text(r.max_ns),
               number_text(r.ratio_to_bullet, 3), r.wrong, r.worst_error, number_text(r.supports, 1),
               number_text(r.allocations, 1), r.wrong > 0 ? "  WRONG" : "");
  }
  std::fflush(stdout);
}

void print_summary(const std::vector<Row>& rows) {
  std::vector<std::string> solvers;
  for (const Row& r : rows) {
    if (std::find(solvers.begin(), solvers.end(), r.solver) == solvers.end()) solvers.push_back(r.solver);
  }
  fmt::print("\nAll cells: geometric mean of the ratios, wrong answers, allocations\n");
  for (const std::string& name : solvers) {
    std::vector<double> ratios;
    std::int64_t pairs = 0;
    std::int64_t wrong = 0;
    double allocations = 0;
    for (const Row& r : rows) {
      if (r.solver != name) continue;
      ratios.push_back(r.ratio_to_bullet);
      pairs += r.pairs;
      wrong += r.wrong;
      allocations += r.allocations * r.pairs;
    }
    fmt::print("  {:<20} {:>7}   {:>6} of {} wrong ({:.2f} %)   {:.1f} allocations a call\n", name,
               number_text(geometric_mean(ratios), 3), wrong, pairs,
               100.0 * static_cast<double>(wrong) / static_cast<double>(std::max<std::int64_t>(pairs, 1)),
               allocations / static_cast<double>(std::max<std::int64_t>(pairs, 1)));
  }
}

std::vector<BestPeer> best_peers(const std::vector<Row>& rows, const Contest& contest) {
  std::vector<BestPeer> best;
  for (const Row& ours : rows) {
    if (ours.solver != contest.ours) continue;
    BestPeer cell{&ours, nullptr};
    for (const Row& r : rows) {
      const bool same = r.family == ours.family && r.vertices == ours.vertices && r.depth == ours.depth;
      const bool named = std::find(contest.peers.begin(), contest.peers.end(), r.solver) != contest.peers.end();
      const bool peer = contest.peers.empty() ? !r.solver.starts_with("pdepth") : named;
      if (!same || !peer || r.wrong > 0 || r.pairs < ours.pairs) continue;
      if (cell.peer == nullptr || r.p50_ns < cell.peer->p50_ns) cell.peer = &r;
    }
    best.push_back(cell);
  }
  return best;
}

void print_contest(const std::vector<Row>& rows, const Contest& contest) {
  const std::vector<BestPeer> cells = best_peers(rows, contest);
  if (cells.empty()) return;
  fmt::print("\n{} beside the fastest peer with no wrong answer: x Bullet, x Bullet, ours over the peer's\n",
             contest.ours);
  std::size_t lost = 0;
  for (const BestPeer& cell : cells) {
    const Row& ours = *cell.ours;
    if (cell.peer == nullptr) {
      fmt::print("  {:<19} {:>8} {:<8} {:>7} {:>7}  no peer\n", ours.family, ours.vertices, ours.depth,
                 number_text(ours.ratio_to_bullet, 3), "-");
      continue;
    }
    lost += cell.lost() ? 1 : 0;
    fmt::print("  {:<19} {:>8} {:<8} {:>7} {:>7} {:>6.2f}  {}{}\n", ours.family, ours.vertices, ours.depth,
               number_text(ours.ratio_to_bullet, 3), number_text(cell.peer->ratio_to_bullet, 3),
               ours.p50_ns / cell.peer->p50_ns, cell.peer->solver, cell.lost() ? "  LOST" : "");
  }
  fmt::print("  {} of {} cells lost\n", lost, cells.size());
}

std::string to_csv(const std::vector<Row>& rows) {
  std::string text = std::string(kColumns) + "\n";
  for (const Row& r : rows) {
    const std::string ratio = std::isfinite(r.ratio_to_bullet) ? fmt::format("{:.4f}", r.ratio_to_bullet) : "";
    text += fmt::format("{},{},{},{},{},{:.1f},{:.1f},{},{},{:g}\n", r.family, r.vertices, r.depth, r.solver, r.pairs,
                        r.p50_ns, r.p99_ns, ratio, r.wrong, r.allocations);
  }
  return text;
}

Expected<std::vector<Row>> from_csv(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  const auto refuse = [&](int number) {
    return Error{ErrorCode::bad_value, fmt::format("line {} is not a row of a pairs table", number), "csv"};
  };
  if (!std::getline(lines, line) || line != kColumns) return refuse(1);
  std::vector<Row> rows;
  for (int number = 2; std::getline(lines, line); ++number) {
    std::vector<std::string> fields;
    std::istringstream split(line);
    for (std::string field; std::getline(split, field, ',');) fields.push_back(field);
    if (fields.size() != 10) return refuse(number);
    try {
      Row r;
      r.family = fields[0];
      r.vertices = std::stoi(fields[1]);
      r.depth = fields[2];
      r.solver = fields[3];
      r.pairs = std::stoi(fields[4]);
      r.p50_ns = std::stod(fields[5]);
      r.p99_ns = std::stod(fields[6]);
      if (!fields[7].empty()) r.ratio_to_bullet = std::stod(fields[7]);
      r.wrong = std::stoi(fields[8]);
      r.allocations = std::stod(fields[9]);
      rows.push_back(r);
    } catch (const std::exception&) {
      return refuse(number);
    }
  }
  return rows;
}

bool write_text(const std::filesystem::path& path, const std::string& text) {
  std::error_code ignored;  // the stream below reports what matters
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out) fmt::print(stderr, "{}: cannot be written\n", path.string());
  return static_cast<bool>(out);
}

}  // namespace pd::bench
