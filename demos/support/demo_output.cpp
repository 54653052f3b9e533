#include "support/demo_output.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <system_error>

#include "support/complain.hpp"

namespace pd::demo {

namespace {

volatile std::sig_atomic_t interrupt_noted = 0;

void on_interrupt(int signal) {
  interrupt_noted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

int open_output_folder(const DemoOptions& options, std::string_view demo, std::filesystem::path& folder) {
  folder = options.out.empty() ? std::filesystem::path("pdepth_out") / std::string(demo) : options.out;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    complain("--out: {} cannot be made: {}", folder.string(), failure.message());
    return kDemoFailed;
  }
  const bool empty = std::filesystem::is_empty(folder, failure);
  if (failure) {
    complain("--out: {} cannot be read: {}", folder.string(), failure.message());
    return kDemoFailed;
  }
  if (!empty && !options.force) {
    complain("--out: {} holds files already: name another folder, or replace them with --force", folder.string());
    return kDemoBadUsage;
  }
  return kDemoDone;
}

void note_interrupts() {
  interrupt_noted = 0;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() { return interrupt_noted != 0; }

Progress::Progress(std::string label, int total)
    : label_(std::move(label)),
      total_(std::max(total, 1)),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (terminal_ && last_shown_ >= 0) {
    fmt::print(stderr, "\n");
  }
}

void Progress::show(int done) {
  const int parts = terminal_ ? 100 : 10;
  const int part = parts * done / total_;
  if (part == last_shown_) {
    return;
  }
  last_shown_ = part;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (terminal_) {
    constexpr int kWidth = 30;
    const int filled = kWidth * done / total_;
    fmt::print(stderr, "\r{:<28} [{:=<{}}{:<{}}] {:3d} %  {:.0f} s ", label_, "", filled, "", kWidth - filled,
               100 * done / total_, seconds);
  } else {
    fmt::print(stderr, "{}: {} of {}, {:.1f} s\n", label_, done, total_, seconds);
  }
  std::fflush(stderr);
}

CsvFile::CsvFile(const std::filesystem::path& path, std::string_view header) : file_(path) {
  file_.write(header);
  file_.write("\n");
}

void CsvFile::row(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ",") + fmt::format("{}", number);
  file_.write(text + "\n");
}

namespace {

struct Unit {
  double size;
  const char* name;
};

/// Three digits of a value in a unit.
std::string three_digits(double value, const Unit& unit) {
  const double scaled = value / unit.size;
  const int digits = std::abs(scaled) >= 100 ? 0 : std::abs(scaled) >= 10 ? 1 : std::abs(scaled) >= 1 ? 2 : 3;
  return fmt::format("{:.{}f} {}", scaled, digits, unit.name);
}

}  // namespace

std::string length_text(double metres) {
  const double magnitude = std::abs(metres);
  if (magnitude < 5e-10) return "0 mm";
  if (magnitude < 1e-5) return three_digits(metres, {1e-6, "µm"});
  if (magnitude < 0.1) return three_digits(metres, {1e-3, "mm"});
  if (magnitude < 1) return three_digits(metres, {1e-2, "cm"});
  return three_digits(metres, {1, "m"});
}

std::string energy_text(double joules) {
  const double magnitude = std::abs(joules);
  if (magnitude < 5e-10) return "0 J";
  if (magnitude < 1e-3) return three_digits(joules, {1e-6, "µJ"});
  if (magnitude < 1) return three_digits(joules, {1e-3, "mJ"});
  if (magnitude < 1e3) return three_digits(joules, {1, "J"});
  return three_digits(joules, {1e3, "kJ"});
}

int report_failure(const Error& error) {
  complain("{}{}{}", error.where, error.where.empty() ? "" : ": ", error.message);
  return kDemoFailed;
}

}  // namespace pd::demo
