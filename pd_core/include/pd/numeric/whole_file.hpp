/// @file
/// A file that is there whole or not at all, whatever happens while it is written: a full disk, a killed process, two
/// writers.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "pd/numeric/language.hpp"

namespace pd {

/// The text goes into another file of the same folder, which gets the name once it is complete. A reader never sees a
/// part of it, and a file that stood there before stays until then. A killed process leaves such a part behind, named
/// ".pdepth-*".
///
/// A link is followed to the file that it names. A device, a pipe and whatever else is no regular file is written as it
/// comes.
class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);
  /// Drops what was not finished.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// False where the file could not be opened or written.
  [[nodiscard]] bool good() const { return good_; }
  /// For writers of their own, which need not look for errors: `finish` does. Requires that the file is open.
  [[nodiscard]] std::FILE* stream() const { return stream_; }
  void write(std::string_view text);
  /// A path where another program may write the text instead, over the empty file that stands there.
  [[nodiscard]] const std::filesystem::path& written_path() const { return part_.empty() ? target_ : part_; }
  /// Closes the file and gives it its name. False where anything failed since it was opened; then nothing has changed.
  [[nodiscard]] bool finish();

 private:
  std::filesystem::path target_;
  std::filesystem::path part_;  ///< empty: the target itself is written
  std::FILE* stream_ = nullptr;
  bool good_ = false;
};

/// @return false where the file cannot be written, with errno; then nothing has changed.
[[nodiscard]] bool write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace pd
