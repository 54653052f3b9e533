/// @file
/// Headless Chromium, driven through a pipe in its DevTools protocol: pages opened, keys pressed, what scripts complain
/// of kept.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pd::test {

/// One browser with one tab. Errors of the protocol are thrown (std::runtime_error).
class Browser {
 public:
  /// Empty where none is installed.
  static std::string program();

  /// @param profile  a folder for what it writes
  explicit Browser(const std::filesystem::path& profile);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Sizes in CSS pixels; "light" or "dark".
  void look(int width, int height, const std::string& scheme = "light");
  /// Opens a file and waits until it has loaded.
  void open(const std::filesystem::path& page);
  /// The value of an expression of JavaScript.
  nlohmann::json evaluate(const std::string& expression);
  /// Presses and releases a key ("ArrowRight", "Tab", " ").
  void press(const std::string& key);
  /// Presses, drags and releases the mouse.
  void drag(double from_x, double from_y, double to_x, double to_y);
  /// A PNG of the whole page.
  void picture(const std::filesystem::path& file);

  /// Errors of scripts, of the console and of loading since the page was opened.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }
  /// Addresses that the page asked for.
  [[nodiscard]] const std::vector<std::string>& requests() const { return requests_; }

 private:
  nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object());
  nlohmann::json receive();
  void note(const nlohmann::json& event);

  pid_t child_ = -1;
  int to_ = -1;
  int from_ = -1;
  int calls_ = 0;
  std::string session_;
  std::string unread_;
  bool loaded_ = false;
  std::vector<std::string> complaints_;
  std::vector<std::string> requests_;
};

}  // namespace pd::test
