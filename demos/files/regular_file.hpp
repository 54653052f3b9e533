/// @file
/// The one way in which files that strangers name are opened. Such a name may stand for a pipe that nobody writes to,
/// for a device without an end, or for a link to somebody's secrets.
///
/// A file is opened without waiting, is then asked for its kind through the descriptor (a check by name could be
/// answered by another file), and is read no further than the length that it had at that moment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace pd::query {

/// An open regular file. Refusals carry no path: the caller knows it.
class RegularFile {
 public:
  /// @throws Refusal unreadable_file (missing, forbidden, not a regular file), or limit_exceeded for more than
  /// `max_bytes`.
  [[nodiscard]] static RegularFile open(const std::string& path, std::uintmax_t max_bytes);

  /// Opens a file by a relative name below the folder of `sibling`. No part of `name` may be "..", absolute or a
  /// symbolic link, so that nothing outside of the folder can be reached; the parts are opened one by one, each without
  /// following links.
  /// @throws Refusal as `open`, and bad_value for such a name.
  [[nodiscard]] static RegularFile open_beside(const std::string& sibling, std::string_view name,
                                               std::uintmax_t max_bytes);

  [[nodiscard]] std::uintmax_t size() const { return size_; }
  /// The first bytes of the file. @throws Refusal unreadable_file where the file holds fewer than `count`.
  [[nodiscard]] std::string read(std::uintmax_t count) const;
  [[nodiscard]] std::string read_all() const { return read(size_); }

  /// Bytes from `offset`, at most up to the length at opening; how many were read, less than `count` only at the end.
  std::size_t read_at(std::uintmax_t offset, char* out, std::size_t count) const;

 private:
  class Descriptor {
   public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int number() const { return number_; }

   private:
    int number_;
  };

  RegularFile(std::shared_ptr<const Descriptor> descriptor, std::uintmax_t max_bytes);

  std::shared_ptr<const Descriptor> descriptor_;
  std::uintmax_t size_ = 0;
};

}  // namespace pd::query
