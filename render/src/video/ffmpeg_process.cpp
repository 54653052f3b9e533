#include "video/ffmpeg_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

extern char** environ;

namespace pd::render::detail {
namespace {

Error refusal(const std::string& message) { return Error{ErrorCode::unsupported, message, "video"}; }

}  // namespace

Expected<FfmpegProcess> FfmpegProcess::start(const std::vector<std::string>& arguments) {
  // A socket, not a pipe: writing to one whose reader has died can be told not to raise SIGPIPE. ffmpeg's messages go
  // to an unlinked file: a pipe that nobody reads would fill up and stop it.
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    return refusal(std::string("no socket for ffmpeg: ") + std::strerror(errno));
  }
  std::FILE* messages_file = std::tmpfile();
  const int messages = messages_file != nullptr ? fcntl(fileno(messages_file), F_DUPFD_CLOEXEC, 3) : -1;
  if (messages_file != nullptr) {
    std::fclose(messages_file);
  }
  if (messages < 0) {
    close(sockets[0]);
    close(sockets[1]);
    return refusal("no temporary file for ffmpeg's messages");
  }
  std::vector<std::string> words = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, sockets[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, "ffmpeg", &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(sockets[1]);
  if (failed != 0) {
    close(sockets[0]);
    close(messages);
    return refusal(failed == ENOENT ? "the program ffmpeg is not installed (Debian package ffmpeg); frames need none"
                                    : std::string("ffmpeg does not start: ") + std::strerror(failed));
  }
  return FfmpegProcess(process, sockets[0], messages);
}

FfmpegProcess::FfmpegProcess(FfmpegProcess&& other) noexcept
    : process_(std::exchange(other.process_, 0)),
      input_(std::exchange(other.input_, -1)),
      messages_(std::exchange(other.messages_, -1)) {}

FfmpegProcess::~FfmpegProcess() { finish(); }

bool FfmpegProcess::write(std::span<const std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t sent = send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

std::string FfmpegProcess::finish() {
  if (process_ <= 0) {
    return {};
  }
  close(std::exchange(input_, -1));
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  std::string words;
  std::array<char, 600> text{};
  const ssize_t read_count = pread(messages_, text.data(), text.size(), 0);
  if (read_count > 0) {
    words.assign(text.data(), static_cast<std::size_t>(read_count));
    while (!words.empty() && words.back() == '\n') {
      words.pop_back();
    }
  }
  close(std::exchange(messages_, -1));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    return {};
  }
  return words.empty() ? "ffmpeg ended without a reason" : words;
}

}  // namespace pd::render::detail
