/// @file
/// `answer_hash`: `pdepth-bench hash` as a program of its own, which needs none of the peers.

#include "bench/hash/answer_hash.hpp"

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  pd::bench::HashSettings settings;
  CLI::App app{"Hashes the bits of answers over generated pairs, in rows by kind of question."};
  app.add_option("--pairs", settings.pairs, "generated pairs")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seed", settings.seed)->capture_default_str();
  app.add_option("--out", settings.out, "writes the rows to this file");
  app.add_option("--check", settings.check, "compares them with this file");
  CLI11_PARSE(app, argc, argv);
  return pd::bench::run_hash(settings);
}
