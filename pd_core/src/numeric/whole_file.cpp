#include "pd/numeric/whole_file.hpp"

#include <cerrno>
#include <cstdint>
#include <random>
#include <system_error>

namespace pd {

namespace {

constexpr std::filesystem::perms kMayWrite =
    std::filesystem::perms::owner_write | std::filesystem::perms::group_write | std::filesystem::perms::others_write;

/// Where the bytes of a file go: behind its links, as far as they lead to a regular file or to nothing yet.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  return error ? path : target;
}

/// A name that nobody has, so that two writers of one file do not meet.
std::filesystem::path name_beside(const std::filesystem::path& target) {
  std::random_device random;
  const std::uint64_t number = (std::uint64_t{random()} << 32) | random();
  return target.parent_path() / (".pdepth-" + std::to_string(number) + target.extension().string());
}

}  // namespace

WholeFile::WholeFile(const std::filesystem::path& path) : target_(path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool exists = std::filesystem::exists(status);
  if (exists && !std::filesystem::is_regular_file(status)) {
    stream_ = std::fopen(path.c_str(), "wb");
  } else {
    target_ = behind_links(path);
    part_ = name_beside(target_);
    // A file that nobody may write is not replaced either.
    if (!exists || (status.permissions() & kMayWrite) != std::filesystem::perms::none) {
      stream_ = std::fopen(part_.c_str(), "wbx");
    } else {
      errno = EACCES;
    }
    if (stream_ != nullptr && exists) std::filesystem::permissions(part_, status.permissions(), error);
  }
  good_ = stream_ != nullptr;
}

WholeFile::~WholeFile() {
  if (stream_ == nullptr) return;
  std::fclose(stream_);
  std::error_code ignored;
  if (!part_.empty()) std::filesystem::remove(part_, ignored);
}

void WholeFile::write(std::string_view text) {
  if (stream_ != nullptr) good_ = std::fwrite(text.data(), 1, text.size(), stream_) == text.size() && good_;
}

bool WholeFile::finish() {
  if (stream_ == nullptr) return false;
  good_ = std::ferror(stream_) == 0 && good_;
  good_ = std::fclose(stream_) == 0 && good_;
  stream_ = nullptr;
  if (part_.empty()) return good_;
  std::error_code error;
  if (good_) {
    std::filesystem::rename(part_, target_, error);
    good_ = !error;
  }
  if (!good_) std::filesystem::remove(part_, error);
  return good_;
}

bool write_whole_file(const std::filesystem::path& path, std::string_view text) {
  WholeFile file(path);
  file.write(text);
  return file.finish();
}

}  // namespace pd
