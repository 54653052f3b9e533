#include "line_input.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <thread>

#include "commands.hpp"
#include "support/complain.hpp"
#include "usage.hpp"

namespace pd::cli {

void add_limit_options(CLI::App& command, query::Limits& limits) {
  command.add_flag_callback(
      "--no-files", [&limits] { limits.files = false; }, "Refuse shapes that name a file");
  command.add_option("--max-line", limits.max_line, "Longest line in bytes")
      ->check(number_above_zero())
      ->capture_default_str();
  command.add_option("--max-vertices", limits.max_vertices, "Most vertices of one shape")
      ->check(number_between(std::int64_t{1}, std::int64_t{50'000'000}))
      ->capture_default_str();
}

void add_threads_option(CLI::App& command, int& threads, const std::string& purpose) {
  command.add_option("--threads", threads, "Threads that " + purpose + "; 0 = one for each processor")
      ->check(number_between(0, 256))
      ->capture_default_str();
}

int number_of_threads(int option) {
  return option > 0 ? option : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

InputFile::InputFile(const std::string& path)
    : descriptor_(path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}

InputFile::~InputFile() {
  if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
}

namespace {

bool same_regular_file(int read, const struct stat& written) {
  struct stat status {};
  return ::fstat(read, &status) == 0 && S_ISREG(status.st_mode) && status.st_dev == written.st_dev &&
         status.st_ino == written.st_ino;
}

}  // namespace

bool InputFile::is_also(int output) const {
  struct stat status {};
  return ::fstat(output, &status) == 0 && same_regular_file(descriptor_, status);
}

bool InputFile::is_also(const std::string& output) const {
  struct stat status {};
  return ::stat(output.c_str(), &status) == 0 && same_regular_file(descriptor_, status);
}

int cannot_read(const std::string& path, int reason) {
  complain("{}: {}", path, reason == ENOENT ? "there is no such file" : std::strerror(reason));  // as files of meshes
  return kBadUsage;
}

}  // namespace pd::cli
