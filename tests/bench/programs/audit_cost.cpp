/// @file
/// `audit_cost`: what judging a contact costs over the depth query alone.
///
/// A record is cut into blocks. Each block is audited as `pdepth audit` does it, by one thread, and its pairs are asked
/// for their depth alone, from shapes and poses that lie in memory; who goes first changes from block to block. Times
/// are processor time of the thread, so that other work on the machine adds little; it adds to both alike.

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "audit/audit_stream.hpp"
#include "audit/exact_depth.hpp"
#include "bench/measure/processor_time.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace {

using pd::audit::Audit;
using pd::audit::RecordedContact;

/// A file without a name that holds a text.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& text) : descriptor_(memfd_create("record", MFD_CLOEXEC)) {
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t done = ::write(descriptor_, text.data() + at, text.size() - at);
      if (done <= 0) throw std::runtime_error("no room for a block in memory");
      at += static_cast<std::size_t>(done);
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] int from_the_start() const {
    ::lseek(descriptor_, 0, SEEK_SET);
    return descriptor_;
  }

 private:
  int descriptor_;
};

struct Cost {
  double audit = 0;
  double queries = 0;
  std::int64_t contacts = 0;
};

double audit_seconds(const MemoryFile& block) {
  const double start = pd::bench::processor_seconds();
  Audit audit;
  pd::audit::AuditSettings settings;
  settings.worst_kept = 5;
  pd::audit::audit_record(block.from_the_start(), settings, {}, audit);
  return pd::bench::processor_seconds() - start;
}

double query_seconds(const std::vector<RecordedContact>& contacts, double tolerance, pd::Scratch& scratch) {
  const double start = pd::bench::processor_seconds();
  for (const RecordedContact& contact : contacts) {
    if (!pd::audit::body_depth(contact, tolerance / 10, scratch)) throw std::runtime_error("a pair without an answer");
  }
  return pd::bench::processor_seconds() - start;
}

Cost measure(const std::string& text, bool queries_first, pd::Scratch& scratch) {
  const MemoryFile block(text);
  Audit kept;  // the shapes that the contacts refer to
  std::vector<RecordedContact> contacts;
  pd::audit::audit_record(
      block.from_the_start(), {},
      [&](const RecordedContact& contact, const pd::audit::Judgement&, std::int64_t) {
        if (contact.a->halfspace || contact.b->halfspace) return;  // no query has half-spaces
        contacts.push_back(contact);
      },
      kept);
  if (kept.summary.refused() > 0) throw std::runtime_error(kept.summary.refusals().front().refusal.message);
  Cost cost;
  cost.contacts = static_cast<std::int64_t>(contacts.size());
  if (queries_first) cost.queries = query_seconds(contacts, kept.tolerance, scratch);
  cost.audit = audit_seconds(block);
  if (!queries_first) cost.queries = query_seconds(contacts, kept.tolerance, scratch);
  return cost;
}

int run(std::istream& input, std::int64_t block_size) {
  std::string shapes;  // the first line and the shapes: every block begins with them
  std::string block;
  std::int64_t in_block = 0;
  Cost sum;
  std::vector<double> ratios;
  pd::Scratch scratch;
  const auto finish = [&] {
    const Cost cost = measure(shapes + block, ratios.size() % 2 == 1, scratch);
    ratios.push_back(cost.audit / cost.queries);
    sum.audit += cost.audit;
    sum.queries += cost.queries;
    sum.contacts += cost.contacts;
    block.clear();
    in_block = 0;
  };
  for (std::string line; std::getline(input, line);) {
    const bool contact = line.starts_with("{\"contact\"");
    (contact ? block : shapes) += line + '\n';
    if (contact && ++in_block == block_size) finish();
  }
  if (in_block > 0) finish();
  if (sum.contacts == 0) {
    std::fprintf(stderr, "the record holds no contact\n");
    return 2;
  }
  std::sort(ratios.begin(), ratios.end());
  const auto n = static_cast<double>(sum.contacts);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "%lld contacts: audit %.2f us, depth queries alone %.2f us, ratio %.2f (of blocks: median %.2f, %.2f to %.2f)\n",
      static_cast<long long>(sum.contacts), 1e6 * sum.audit / n, 1e6 * sum.queries / n, sum.audit / sum.queries,
      ratios[ratios.size() / 2], ratios.front(), ratios.back());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string record = "-";
  std::int64_t block = 20'000;
  CLI::App app{"Times the audit of a record of contacts beside the depth queries alone, in turns."};
  app.add_option("record", record, "JSON lines; - is standard input")->capture_default_str();
  app.add_option("--block", block, "contacts that are timed at once")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    if (record == "-") return run(std::cin, block);
    std::ifstream file(record);
    if (!file) throw std::runtime_error(record + " cannot be read");
    return run(file, block);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
