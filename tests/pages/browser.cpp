#include "pages/browser.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace pd::test {

namespace {

constexpr int kSecondsOfPatience = 240;

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) break;
    bits = bits << 6U | static_cast<unsigned>(digit);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes += static_cast<char>(bits >> held & 0xffU);
    }
  }
  return bytes;
}

/// In the child: the pipes become the descriptors 3 and 4, and the browser takes over.
[[noreturn]] void become_browser(int commands, int answers, const std::string& program, const std::string& profile) {
  const int in = ::fcntl(commands, F_DUPFD, 10);
  const int out = ::fcntl(answers, F_DUPFD, 10);
  ::dup2(in, 3);
  ::dup2(out, 4);
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (int standard = 0; standard < 3; ++standard) ::dup2(nowhere, standard);
  ::setpgid(0, 0);
  const std::string user_data = "--user-data-dir=" + profile;
  ::execl(program.c_str(), program.c_str(), "--headless", "--no-sandbox", "--disable-dev-shm-usage",
          "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe", "--hide-scrollbars",
          "--no-first-run", "--disable-background-networking", "--force-prefers-reduced-motion", user_data.c_str(),
          "about:blank", static_cast<char*>(nullptr));
  ::_exit(127);
}

}  // namespace

std::string Browser::program() {
  std::istringstream folders(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string path = folder + "/chromium";
    if (::access(path.c_str(), X_OK) == 0) return path;
  }
  return {};
}

Browser::Browser(const std::filesystem::path& profile) {
  std::array<int, 2> commands{};
  std::array<int, 2> answers{};
  if (::pipe2(commands.data(), O_CLOEXEC) != 0 || ::pipe2(answers.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  child_ = ::fork();
  if (child_ == 0) become_browser(commands[0], answers[1], program(), profile.string());
  ::close(commands[0]);
  ::close(answers[1]);
  to_ = commands[1];
  from_ = answers[0];
  ::signal(SIGPIPE, SIG_IGN);
  const auto target = call("Target.createTarget", {{"url", "about:blank"}}).at("targetId");
  session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}}).at("sessionId");
  for (const char* domain : {"Page.enable", "Runtime.enable", "Log.enable", "Network.enable"}) call(domain);
}

Browser::~Browser() {
  ::close(to_);
  ::close(from_);
  ::kill(-child_, SIGKILL);
  ::waitpid(child_, nullptr, 0);
}

nlohmann::json Browser::receive() {
  for (;;) {
    const std::size_t end = unread_.find('\0');
    if (end != std::string::npos) {
      const auto message = nlohmann::json::parse(unread_.substr(0, end));
      unread_.erase(0, end + 1);
      return message;
    }
    pollfd ready{from_, POLLIN, 0};
    if (::poll(&ready, 1, 1000 * kSecondsOfPatience) <= 0) throw std::runtime_error("the browser is silent");
    std::array<char, 65536> bytes{};
    const ssize_t got = ::read(from_, bytes.data(), bytes.size());
    if (got <= 0) throw std::runtime_error("the browser is gone");
    unread_.append(bytes.data(), static_cast<std::size_t>(got));
  }
}

void Browser::note(const nlohmann::json& event) {
  const std::string method = event.value("method", "");
  const nlohmann::json& what = event.contains("params") ? event.at("params") : event;
  if (method == "Page.loadEventFired") loaded_ = true;
  if (method == "Network.requestWillBeSent") requests_.push_back(what.at("request").at("url"));
  const bool logged = method == "Log.entryAdded" && what.at("entry").at("level") == "error";
  const bool printed =
      method == "Runtime.consoleAPICalled" && (what.at("type") == "error" || what.at("type") == "warning");
  if (logged || printed || method == "Runtime.exceptionThrown" || method == "Network.loadingFailed") {
    complaints_.push_back(what.dump());
  }
}

nlohmann::json Browser::call(const std::string& method, nlohmann::json parameters) {
  nlohmann::json message{{"id", ++calls_}, {"method", method}, {"params", std::move(parameters)}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t wrote = ::write(to_, text.data() + sent, text.size() - sent);
    if (wrote <= 0) throw std::runtime_error("the browser does not listen");
    sent += static_cast<std::size_t>(wrote);
  }
  for (;;) {
    const nlohmann::json answer = receive();
    if (answer.value("id", 0) != calls_) {
      note(answer);
      continue;
    }
    if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.at("error").dump());
    return answer.at("result");
  }
}

void Browser::look(int width, int height, const std::string& scheme) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", width < 600}});
  call("Emulation.setEmulatedMedia", {{"features", {{{"name", "prefers-color-scheme"}, {"value", scheme}}}}});
}

void Browser::open(const std::filesystem::path& page) {
  complaints_.clear();
  requests_.clear();
  loaded_ = false;
  call("Page.navigate", {{"url", "file://" + page.string()}});
  while (!loaded_) note(receive());
}

nlohmann::json Browser::evaluate(const std::string& expression) {
  const auto result =
      call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (result.contains("exceptionDetails")) throw std::runtime_error(expression + ": " + result.dump());
  return result.at("result").value("value", nlohmann::json());
}

void Browser::press(const std::string& key) {
  const bool letter = key.size() == 1;
  const nlohmann::json codes{{"PageUp", 33},     {"PageDown", 34},  {"ArrowLeft", 37}, {"ArrowUp", 38},
                             {"ArrowRight", 39}, {"ArrowDown", 40}, {"Tab", 9},        {"Home", 36},
                             {"End", 35},        {"Enter", 13}};
  nlohmann::json parameters{{"key", key}, {"code", key == " " ? "Space" : key}};
  parameters["windowsVirtualKeyCode"] = letter ? static_cast<int>(key[0]) : codes.at(key).get<int>();
  if (letter) parameters["text"] = key;
  if (key == "Enter") parameters["text"] = "\r";
  parameters["type"] = "keyDown";
  call("Input.dispatchKeyEvent", parameters);
  parameters.erase("text");
  parameters["type"] = "keyUp";
  call("Input.dispatchKeyEvent", parameters);
}

void Browser::drag(double from_x, double from_y, double to_x, double to_y) {
  const auto mouse = [&](const char* type, double x, double y, int buttons) {
    call("Input.dispatchMouseEvent",
         {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"buttons", buttons}, {"clickCount", 1}});
  };
  mouse("mousePressed", from_x, from_y, 1);
  for (int i = 1; i <= 5; ++i)
    mouse("mouseMoved", from_x + i * (to_x - from_x) / 5, from_y + i * (to_y - from_y) / 5, 1);
  mouse("mouseReleased", to_x, to_y, 0);
}

void Browser::picture(const std::filesystem::path& file) {
  const auto shot = call("Page.captureScreenshot", {{"format", "png"}, {"captureBeyondViewport", true}});
  std::ofstream(file, std::ios::binary) << from_base64(shot.at("data"));
}

}  // namespace pd::test
