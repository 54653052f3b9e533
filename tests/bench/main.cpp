/// @file
/// `pdepth-bench`: penetration depth measured beside the peers, every answer judged by the exact oracle.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <random>

#include "bench/agarwal/agarwal.hpp"
#include "bench/arya/arya.hpp"
#include "bench/dobkin/dobkin.hpp"
#include "bench/hash/answer_hash.hpp"
#include "bench/measure/compare.hpp"
#include "bench/pairs/apart.hpp"
#include "bench/pairs/coherent.hpp"
#include "bench/pairs/curved.hpp"
#include "bench/pairs/meshes.hpp"
#include "bench/pairs/pairs.hpp"
#include "bench/pairs/shuffled.hpp"
#include "bench/report/bench_report.hpp"
#ifdef PD_BENCH_WITH_CONTACT
#include "bench/contact/contact.hpp"
#endif
#ifdef PD_BENCH_WITH_ACCURACY
#include "bench/accuracy/accuracy.hpp"
#endif
#ifdef PD_BENCH_WITH_RENDER
#include "bench/plots/plots.hpp"
#endif

namespace {

using namespace pd::bench;

struct Options {
  std::vector<std::string> families;
  std::vector<int> vertices;
  std::vector<std::string> solvers;
  std::uint64_t seed = 0;
  bool quick = false;
  bool turned = false;
  bool from_files = false;
  int other_megabytes = 4;
  int pairs = 0;
  int frames = 200;
  std::string csv;
  std::string plots;
  std::string folder;
  CompareSettings compare;
  AgarwalSettings agarwal;
  AryaSettings arya;
  DobkinSettings dobkin;
  HashSettings hash;
  ReportTarget report;
};

void add_report(CLI::App& command, std::string& folder) {
  command.add_option("--report", folder, "writes report.html, a page for people, into this folder");
}

void add_common(CLI::App& command, Options& o) {
  command.add_option("--seed", o.seed, "repeats a run (default: drawn, and printed)");
  command.add_option("--solvers", o.solvers, "names of solvers (default: all)")->delimiter(',');
  command.add_option("--csv", o.csv, "writes the table to this file");
  command.add_flag("--quick", o.quick, "under a minute: fewer pairs, no dear cells");
  add_report(command, o.report.folder);
}

void add_family_options(CLI::App& command, Options& o) {
  command.add_option("--families", o.families, "names of families (default: all)")->delimiter(',');
  command.add_option("--vertices", o.vertices, "sizes (default: the family's own)")->delimiter(',');
}

void add_pair_options(CLI::App& command, Options& o) {
  command.add_option("--pairs", o.pairs, "pairs in each cell (default: 72, quick 12)");
  command.add_option("--plots", o.plots, "writes log-log pictures into this folder");
}

/// Drops the solvers that were not asked for. False when a name is unknown.
bool select(Solvers& solvers, const std::vector<std::string>& names) {
  if (names.empty()) return true;
  Solvers chosen;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(solvers.begin(), solvers.end(), [&](const auto& s) { return s != nullptr && s->name() == name; });
    if (found == solvers.end()) {
      fmt::print(stderr, "--solvers: no solver of this name: {}\n", name);
      return false;
    }
    chosen.push_back(std::move(*found));
  }
  solvers = std::move(chosen);
  return true;
}

int refuse(const pd::Error& error) {
  fmt::print(stderr, "{}: {}\n", error.where, error.message);
  return 2;
}

void print_preamble(const Options& o) {
  for (const std::string& note : peer_notes()) fmt::print("{}\n", note);
  fmt::print("seed {}\n\n", o.seed);
}

int pairs_of(const Options& o) { return o.pairs > 0 ? o.pairs : o.quick ? 12 : 72; }

/// The summary and the files that were asked for. 1 where one of ours was wrong or a file could not be written.
int finish(const std::vector<Row>& rows, const std::string& what, const Options& o,
           const std::vector<Contest>& contests) {
  print_summary(rows);
  for (const Contest& contest : contests) print_contest(rows, contest);
  bool good = o.csv.empty() || write_text(o.csv, to_csv(rows));
  good = write_report(o.report, report_of_pairs(rows, what)) && good;
  if (!o.plots.empty()) {
#ifdef PD_BENCH_WITH_RENDER
    good = write_plots(rows, o.plots) && good;
#else
    fmt::print(stderr, "--plots: this was built without render\n");
    good = false;
#endif
  }
  for (const Row& r : rows) good = good && (r.wrong == 0 || !r.solver.starts_with("pdepth"));
  return good ? 0 : 1;
}

int pairs_command(const Options& o) {
  const auto cells = choose_cells(o.families, o.vertices, o.quick);
  if (!cells) return refuse(cells.error());
  Solvers solvers;
  add_ours(solvers, true, false);
  add_peers(solvers);
  if (!select(solvers, o.solvers)) return 2;
  print_preamble(o);
  PairsSettings settings;
  settings.cells = *cells;
  for (Cell& cell : settings.cells) {
    cell.turned = o.turned;
    cell.from_files = o.from_files;
  }
  settings.seed = o.seed;
  settings.pairs = pairs_of(o);
  return finish(run_pairs(settings, solvers), "Cold single pairs", o, {{std::string(kOurs), {}}});
}

int meshes_command(const Options& o) {
  const auto meshes = read_meshes(o.folder);
  if (!meshes) return refuse(meshes.error());
  Solvers solvers;
  add_ours(solvers, true, false);
  add_peers(solvers);
  if (!select(solvers, o.solvers)) return 2;
  print_preamble(o);
  return finish(run_meshes(*meshes, pairs_of(o), o.seed, solvers), "Hulls of your meshes", o,
                {{std::string(kOurs), {}}});
}

/// Without options of its own: the quick cells, ours beside Bullet's EPA.
int compare_command(Options o) {
  fmt::print("seed {}\n", o.seed);
  if (o.compare.arguments.empty()) o.compare.arguments = {"--quick", "--solvers", "pdepth-auto,bullet-epa"};
  o.compare.arguments.insert(o.compare.arguments.end(), {"--seed", std::to_string(o.seed)});
  std::vector<Comparison> comparisons;
  if (const int code = run_compare(o.compare, comparisons); code != 0) return code;
  const std::string words = fmt::format("Before: {}. After: {}.", o.compare.before.string(), o.compare.after.string());
  return write_report(o.report, report_of_comparison(comparisons, words)) ? 0 : 1;
}

int coherent_command(const Options& o) {
  const auto sequences = choose_sequences(o.families, o.vertices, o.quick);
  if (!sequences) return refuse(sequences.error());
  Solvers solvers;
  add_ours(solvers, false, true);
  add_peers(solvers);
  if (!select(solvers,
              o.solvers.empty() ? std::vector<std::string>{"pdepth-auto", "pdepth-cold", "bullet-epa"} : o.solvers)) {
    return 2;
  }
  print_preamble(o);
  const std::vector<CoherentRow> rows = run_coherent({*sequences, o.frames, o.seed}, solvers);
  bool good = o.csv.empty() || write_text(o.csv, to_csv(rows));
  good = write_report(o.report, report_of_coherent(rows)) && good;
  for (const CoherentRow& r : rows) good = good && (r.wrong == 0 || !r.solver.starts_with("pdepth"));
  return good ? 0 : 1;
}

int apart_command(const Options& o) {
  const auto cells = choose_apart(o.families, o.vertices, o.quick);
  if (!cells) return refuse(cells.error());
  Solvers solvers;
  add_ours_apart(solvers);
  add_peers_apart(solvers);
  if (!select(solvers, o.solvers)) return 2;
  print_preamble(o);
  const int pairs = o.pairs > 0 ? o.pairs : o.quick ? 4 : 24;
  const std::vector<std::string> cold = {std::string(kBulletGjk), "fcl-libccd", "fcl-own-gjk", "jolt-gjk",
                                         "mujoco-distance",       "box3d-gjk"};
  const std::vector<std::string> beyond = {"bullet-beyond", "jolt-beyond", "mujoco-beyond"};
  const auto with = [](std::vector<std::string> names, std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
    return names;
  };
  return finish(run_apart({*cells, pairs, o.seed}, solvers), "Bodies apart (ratios to Bullet's pair detector)", o,
                {{"pdepth-distance", cold},
                 {"pdepth-distance-warm", with(cold, {"jolt-gjk-warm", "box3d-gjk-warm"})},
                 {"pdepth-beyond", beyond},
                 {"pdepth-beyond-warm", with(beyond, {"jolt-beyond-warm"})}});
}

int curved_command(const Options& o) {
  const auto cells = choose_curved(o.families);
  if (!cells) return refuse(cells.error());
  Solvers solvers;
  add_ours_curved(solvers);
  add_peers_curved(solvers);
  if (!select(solvers, o.solvers)) return 2;
  print_preamble(o);
  const int pairs = o.pairs > 0 ? o.pairs : o.quick ? 8 : 40;
  return finish(run_curved({*cells, pairs, o.seed}, solvers), "Curved bodies in each other", o,
                {{std::string(kOurs), {}}, {"pdepth-warm", {}}});
}

int shuffled_command(const Options& o) {
  Solvers solvers;
  add_ours(solvers, false, false);
  add_peers_curved(solvers);
  if (!select(solvers, o.solvers)) return 2;
  print_preamble(o);
  const int pairs = o.pairs > 0 ? o.pairs : o.quick ? 2'000 : 20'000;
  const std::vector<ShuffledRow> rows = run_shuffled({pairs, o.other_megabytes, o.seed}, solvers);
  return o.csv.empty() || write_text(o.csv, to_csv(rows)) ? 0 : 1;
}

int hash_command(const Options& o) {
  HashOutcome outcome;
  const int code = run_hash(o.hash, &outcome);
  if (outcome.rows == 0) return code;
  return write_report(o.report, report_of_hash(outcome)) ? code : 1;
}

#ifdef PD_BENCH_WITH_CONTACT
void add_contact_options(CLI::App& command, ContactOptions& o) {
  command.add_option("--scene,--scenes", o.scenes, "names of scenes (default: all)")->delimiter(',');
  command.add_option("--runs", o.runs, "names of runs (default: all)")->delimiter(',');
  command.add_option("--rates", o.rates, "steps a second (default: those of each scene; quick the first)")
      ->delimiter(',');
  command.add_option("--settings", o.settings, "of the constraint solver")
      ->delimiter(',')
      ->check(CLI::IsMember({"default", "recommended", "stack"}))
      ->capture_default_str();
  command.add_option("--iterations", o.iterations, "of the constraint solver (default: the settings' own)")
      ->check(CLI::PositiveNumber);
  command.add_option("--starts", o.starts, "perturbed starts of each scene (default: 10, quick 1)");
  command.add_option("--seconds", o.seconds, "simulated time of each run (default: the scene's own)");
  command.add_flag("--quick", o.quick, "a few minutes: short runs from one start");
  command.add_option("--csv", o.csv, "writes the table to this file");
  command.add_option("--plots", o.plots, "writes pictures into this folder");
  add_report(command, o.report.folder);
}
#endif

#ifdef PD_BENCH_WITH_ACCURACY
CLI::App* add_accuracy(CLI::App& app, AccuracyOptions& o) {
  CLI::App* command = app.add_subcommand("accuracy", "who fails what: engines over families, judged by the oracle");
  command->add_option("--families", o.families, "names of families (default: all)")->delimiter(',');
  command->add_option("--engines", o.engines, "names of engines (default: all)")->delimiter(',');
  command->add_option("--pairs", o.settings.pairs, "of a family at each of four depths")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--vertices", o.settings.vertices)->check(CLI::Range(4, 100'000))->capture_default_str();
  command->add_option("--seed", o.settings.seed)->capture_default_str();
  command->add_option("--cases", o.cases, "also the pairs of this contact record")->check(CLI::ExistingFile);
  command->add_option("--csv", o.csv, "writes the table to this file");
  command->add_option("--report", o.report, "writes report.html into this folder");
  return command;
}
#endif

CLI::App* add_pairs(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("pairs", "cold single pairs: families x vertices x depth");
  add_common(*command, o);
  add_family_options(*command, o);
  add_pair_options(*command, o);
  command->add_flag("--turned", o.turned, "turns cubes, grids and roofs at random as well, both bodies together");
  command->add_flag("--from-files", o.from_files,
                    "gives each body a random frame and single-precision points, as in a mesh file");
  return command;
}

CLI::App* add_shuffled(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("shuffled", "pairs of mixed kinds, each asked once, with cold caches");
  command->add_option("--seed", o.seed, "repeats a run (default: drawn, and printed)");
  command->add_option("--solvers", o.solvers, "names of solvers (default: all)")->delimiter(',');
  command->add_option("--pairs", o.pairs, "default: 20,000, quick 2,000")->check(CLI::Range(1, 1'000'000));
  command->add_option("--other-megabytes", o.other_megabytes, "of other data, read between two queries")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--quick", o.quick, "a few seconds");
  command->add_option("--csv", o.csv, "writes the table to this file");
  return command;
}

CLI::App* add_apart(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("apart", "bodies apart: how far, and by more than half of the gap?");
  add_common(*command, o);
  add_family_options(*command, o);
  command->add_option("--pairs", o.pairs, "pairs in each cell, of three frames (default: 24, quick 4)");
  return command;
}

CLI::App* add_curved(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("curved", "curved bodies in each other, cold and with the memory of the pair");
  add_common(*command, o);
  command->add_option("--families", o.families, "names of families (default: all)")->delimiter(',');
  command->add_option("--pairs", o.pairs, "pairs in each cell, of three frames (default: 40, quick 8)");
  return command;
}

CLI::App* add_coherent(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("coherent", "sequences of frames, with the memory of the pair");
  add_common(*command, o);
  command->add_option("--frames", o.frames, "frames of a sequence")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  add_family_options(*command, o);
  return command;
}

CLI::App* add_meshes(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("meshes", "cold single pairs over the hulls of your own meshes");
  command->add_option("folder", o.folder, "searched for OBJ, STL, PLY, OFF and glTF files")->required();
  add_common(*command, o);
  add_pair_options(*command, o);
  return command;
}

CLI::App* add_compare(CLI::App& app, Options& o) {
  CLI::App* command = app.add_subcommand("compare", "two builds of pdepth-bench, run in turns on the same pairs");
  command->add_option("before", o.compare.before, "the older program")->required()->check(CLI::ExistingFile);
  command->add_option("after", o.compare.after, "the newer program")->required()->check(CLI::ExistingFile);
  command->add_option("--rounds", o.compare.rounds)->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--seed", o.seed, "repeats a run (default: drawn, and printed)");
  add_report(*command, o.report.folder);
  command->add_option("pairs", o.compare.arguments, "options of `pairs` for both, after --");
  return command;
}

CLI::App* add_agarwal(CLI::App& app, AgarwalSettings& o) {
  CLI::App* command = app.add_subcommand("agarwal", "the bounds of Agarwal et al. 2000, claim by claim");
  command->add_option("--seed", o.seed, "seed of the families and pairs")->capture_default_str();
  command->add_option("--chapters", o.chapters, agarwal_chapters())->delimiter(',');
  command->add_option("--out", o.out, "folder for the table (CSV, Markdown), the points and the plots");
  command->add_option("--pairs", o.pairs, "of the exactness chapter (default: 100000, quick 2000)");
  command->add_flag("--quick", o.quick, "under a minute: smaller sizes, fewer pairs");
  add_report(*command, o.report.folder);
  return command;
}

CLI::App* add_arya(CLI::App& app, AryaSettings& o) {
  CLI::App* command = app.add_subcommand("arya", "the bounds of Arya, da Fonseca and Mount 2018, claim by claim");
  command->add_option("--seed", o.seed, "seed of the clouds")->capture_default_str();
  command->add_option("--pairs", o.pairs, "bodies or pairs a promise is tried on, d <= 3; 0: by --full")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--chapters", o.chapters, arya_chapters())->delimiter(',');
  using pd::dimension::Backend;
  const std::map<std::string, Backend> backends = {
      {"exact", Backend::exact}, {"kernel", Backend::kernel}, {"macbeath", Backend::macbeath}};
  command->add_option("--backend", o.backend, "of the promises: exact (d <= 3), kernel or macbeath")
      ->transform(CLI::CheckedTransformer(backends));
  command->add_option("--out", o.out, "folder for the table (CSV, Markdown), the points and the plots");
  command->add_flag("--full", o.full, "up to 1e7 points; otherwise under a minute");
  add_report(*command, o.report.folder);
  return command;
}

CLI::App* add_dobkin(CLI::App& app, DobkinSettings& o) {
  CLI::App* command =
      app.add_subcommand("dobkin", "the bounds of Dobkin, Hershberger, Kirkpatrick and Suri 1993, claim by claim");
  command->add_option("--seed", o.seed, "seed of bodies and directions")->capture_default_str();
  command->add_option("--chapters", o.chapters, dobkin_chapters())->delimiter(',');
  command->add_option("--families", o.families, "of the chapter hierarchy")
      ->delimiter(',')
      ->check(CLI::IsMember(hierarchy_families()));
  command->add_option("--out", o.out, "folder for the table (CSV, Markdown) and the points");
  command->add_flag("--full", o.full, "up to 2^20 vertices; otherwise under a minute");
  add_report(*command, o.report.folder);
  return command;
}

CLI::App* add_hash(CLI::App& app, HashSettings& o, std::string& report) {
  CLI::App* command = app.add_subcommand("hash", "the bits of answers, hashed: equal on every compiler and machine");
  command->add_option("--pairs", o.pairs, "generated pairs, each asked in about ten ways")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", o.seed)->capture_default_str();
  command->add_option("--out", o.out, "writes the rows to this file");
  command->add_option("--check", o.check, "compares them with this file");
  add_report(*command, report);
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Exact penetration depth beside the peers; every answer is judged by an exact oracle."};
  app.require_subcommand(1);
  add_pairs(app, options);
  CLI::App* apart = add_apart(app, options);
  CLI::App* curved = add_curved(app, options);
  CLI::App* coherent = add_coherent(app, options);
  CLI::App* meshes = add_meshes(app, options);
  CLI::App* shuffled = add_shuffled(app, options);
  CLI::App* compare = add_compare(app, options);
  CLI::App* agarwal = add_agarwal(app, options.agarwal);
  CLI::App* arya = add_arya(app, options.arya);
  CLI::App* dobkin = add_dobkin(app, options.dobkin);
  CLI::App* hash = add_hash(app, options.hash, options.report.folder);
#ifdef PD_BENCH_WITH_CONTACT
  ContactOptions contact_options;
  CLI::App* contact = app.add_subcommand("contact", "worlds: Bullet's ways to find contacts beside ours");
  add_contact_options(*contact, contact_options);
#endif
#ifdef PD_BENCH_WITH_ACCURACY
  AccuracyOptions accuracy_options;
  CLI::App* accuracy = add_accuracy(app, accuracy_options);
#endif
  CLI11_PARSE(app, argc, argv);
#ifdef PD_BENCH_WITH_ACCURACY
  if (*accuracy) return run_accuracy_by_oracle(accuracy_options);
#endif
  // What a page says of how it was made. Seeds of claims and of hashes have defaults, others are drawn.
  const auto told = [&](const std::string& folder, const std::string& seed) {
    return ReportTarget{folder, command_line(argc, argv, seed), seed};
  };
#ifdef PD_BENCH_WITH_CONTACT
  if (*contact) {
    contact_options.report = told(contact_options.report.folder, "");
    return run_contact(contact_options);
  }
#endif
  if (*hash) {
    options.report = told(options.report.folder, std::to_string(options.hash.seed));
    return hash_command(options);
  }
  const auto run_claims = [&](auto& settings, auto run) {
    settings.report = told(settings.report.folder, std::to_string(settings.seed));
    return run(settings);
  };
  if (*agarwal) return run_claims(options.agarwal, run_agarwal);
  if (*arya) return run_claims(options.arya, run_arya);
  if (*dobkin) return run_claims(options.dobkin, run_dobkin);
  if (app.get_subcommands().front()->count("--seed") == 0) options.seed = std::random_device{}();
  options.report = told(options.report.folder, std::to_string(options.seed));
  if (*apart) return apart_command(options);
  if (*curved) return curved_command(options);
  if (*coherent) return coherent_command(options);
  if (*meshes) return meshes_command(options);
  if (*shuffled) return shuffled_command(options);
  if (*compare) return compare_command(options);
  return pairs_command(options);
}
