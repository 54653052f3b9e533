#include "protocol/line/line_source.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pd::query {

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t wrote = ::write(descriptor, text.data(), text.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(wrote));
  }
  return true;
}

bool LineSource::refill() {
  ssize_t got = 0;
  do {
    got = ::read(descriptor_, buffer_.data(), buffer_.size());
  } while (got < 0 && errno == EINTR);
  failed_ = got < 0;
  begin_ = 0;
  end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  return got > 0;
}

LineSource::Next LineSource::next(std::string& line) {
  line.clear();
  bool anything = false;
  bool oversized = false;
  for (;;) {
    if (begin_ == end_ && !refill()) {
      if (failed_) return Next::failed;
      if (oversized) return Next::oversized;
      return anything ? Next::line : Next::end;
    }
    anything = true;
    const char* start = buffer_.data() + begin_;
    const auto* newline = static_cast<const char*>(std::memchr(start, '\n', end_ - begin_));
    const std::size_t length = newline != nullptr ? static_cast<std::size_t>(newline - start) : end_ - begin_;
    if (oversized || length > max_line_ - line.size()) {
      oversized = true;
      line.clear();
      line.shrink_to_fit();
    } else {
      line.append(start, length);
    }
    begin_ += length;
    if (newline != nullptr) {
      ++begin_;
      return oversized ? Next::oversized : Next::line;
    }
  }
}

}  // namespace pd::query
