/// @file
/// Crossed roofs, deep: ours beside Bullet's EPA in one run, every answer judged.
#include <fmt/format.h>

#include "bench/agarwal/agarwal.hpp"
#include "bench/pairs/pairs.hpp"

namespace pd::bench {

namespace {

const Claim kRoofs{"Roofs against Bullet's EPA",
                   "exact depth of deep roofs (n = 512) in at most 3 times the time of Bullet's EPA"};

/// The engines that are compared; the others of the bench are left out.
bool takes_part(std::string_view solver) {
  return solver == kOurs || solver == kBulletEpa || solver == "pdepth-overlay" || solver == "pdepth-decomposition";
}

}  // namespace

void measure_roofs(const AgarwalSettings& settings, ClaimTable& table) {
  Solvers all, solvers;
  add_ours(all, true, false);
  add_peers(all);
  for (auto& solver : all) {
    if (takes_part(solver->name())) solvers.push_back(std::move(solver));
  }
  PairsSettings pairs;
  pairs.seed = settings.seed;
  pairs.pairs = settings.quick ? 4 : 24;
  for (const int n : {32, 128, 512}) pairs.cells.push_back({scenes::PairFamily::roofs, n, scenes::DepthClass::deep});
  const std::vector<Row> rows = run_pairs(pairs, solvers);
  for (const Row& row : rows) {
    if (row.solver == kBulletEpa) {
      table.add_value(kRoofs, row.solver, "answers off by more than 1e-3", fmt::format("n = {}", row.vertices),
                      row.wrong);
      table.add_value(kRoofs, row.solver, "greatest error over the size", fmt::format("n = {}", row.vertices),
                      row.worst_error);
      table.add_value(kRoofs, row.solver, "time, ns", fmt::format("n = {}", row.vertices), row.p50_ns);
      continue;
    }
    const bool judged = row.solver == kOurs && row.vertices == 512;
    table.add_value(kRoofs, row.solver, "time over Bullet's EPA", fmt::format("n = {}", row.vertices),
                    row.ratio_to_bullet, judged ? std::optional<double>(3) : std::nullopt);
    table.add_value(kRoofs, row.solver, std::string(kWrongAnswers),
                    fmt::format("n = {}, {} pairs", row.vertices, row.pairs), row.wrong, 0);
  }
}

}  // namespace pd::bench
