#include "files/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "support/refusal.hpp"

namespace pd::query {

namespace {

/// Without O_NONBLOCK the opening of a pipe would wait for somebody who writes to it.
constexpr int kOpenFlags = O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;

[[noreturn]] void refuse_by_errno(int reason) {
  refuse("unreadable_file", reason == ENOENT ? "there is no such file" : std::generic_category().message(reason), "");
}

void refuse_outside(std::string_view name) {
  const auto refuse_name = [&](const char* why) {
    refuse("bad_value", "\"" + std::string(name.substr(0, 100)) + "\" " + why, "");
  };
  if (name.empty()) refuse_name("names no file");
  if (name.starts_with('/')) refuse_name("is an absolute path; only files in the folder of this one are read");
  if (name.find('\0') != std::string_view::npos) refuse_name("holds a zero byte");
  if (name.find('\\') != std::string_view::npos) refuse_name("holds a backslash; folders are separated by /");
}

}  // namespace

RegularFile::Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

RegularFile::RegularFile(std::shared_ptr<const Descriptor> descriptor, std::uintmax_t max_bytes)
    : descriptor_(std::move(descriptor)) {
  struct stat status {};
  if (::fstat(descriptor_->number(), &status) != 0) refuse_by_errno(errno);
  if (!S_ISREG(status.st_mode)) refuse("unreadable_file", "not a regular file", "");
  size_ = static_cast<std::uintmax_t>(std::max<std::intmax_t>(status.st_size, 0));
  if (size_ > max_bytes) refuse("limit_exceeded", "more than " + std::to_string(max_bytes) + " bytes", "");
}

RegularFile RegularFile::open(const std::string& path, std::uintmax_t max_bytes) {
  if (path.find('\0') != std::string::npos) refuse("bad_value", "a file's name holds no zero byte", "");
  const int number = ::open(path.c_str(), kOpenFlags);
  if (number < 0) refuse_by_errno(errno);
  return {std::make_shared<Descriptor>(number), max_bytes};
}

RegularFile RegularFile::open_beside(const std::string& sibling, std::string_view name, std::uintmax_t max_bytes) {
  refuse_outside(name);
  const std::size_t slash = sibling.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : sibling.substr(0, slash + 1);
  auto at = std::make_shared<Descriptor>(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (at->number() < 0) refuse_by_errno(errno);
  for (std::string_view rest = name;;) {
    const std::size_t end = rest.find('/');
    const std::string part(rest.substr(0, end));
    if (part == "..") {
      refuse("bad_value", "\"" + std::string(name.substr(0, 100)) + "\" leaves the folder of this file by ..", "");
    }
    const bool last = end == std::string_view::npos;
    if (!part.empty() && part != ".") {
      const int number = ::openat(at->number(), part.c_str(), kOpenFlags | O_NOFOLLOW | (last ? 0 : O_DIRECTORY));
      const int reason = errno;
      struct stat status {};
      if (number < 0 && ::fstatat(at->number(), part.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
          S_ISLNK(status.st_mode)) {
        refuse("bad_value", "\"" + part + "\" is a symbolic link, which is not followed here", "");
      }
      if (number < 0) refuse_by_errno(reason);
      at = std::make_shared<Descriptor>(number);
    }
    if (last) return {std::move(at), max_bytes};
    rest.remove_prefix(end + 1);
  }
}

std::size_t RegularFile::read_at(std::uintmax_t offset, char* out, std::size_t count) const {
  if (offset >= size_) return 0;
  count = static_cast<std::size_t>(std::min<std::uintmax_t>(count, size_ - offset));
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got =
        ::pread(descriptor_->number(), out + done, count - done, static_cast<off_t>(offset + std::uintmax_t{done}));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse_by_errno(errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::string RegularFile::read(std::uintmax_t count) const {
  if (count > size_) {
    refuse("unreadable_file",
           "holds " + std::to_string(size_) + " bytes where " + std::to_string(count) + " are needed", "");
  }
  std::string bytes(static_cast<std::size_t>(count), '\0');
  if (read_at(0, bytes.data(), bytes.size()) != bytes.size()) {
    refuse("unreadable_file", "the file became shorter while it was read", "");
  }
  return bytes;
}

}  // namespace pd::query
