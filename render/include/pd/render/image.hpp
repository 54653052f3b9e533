/// @file
/// A picture in memory, and PNG in and out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/render/palette.hpp"

namespace pd::render {

struct Size {
  int width = 1280;
  int height = 720;
  friend bool operator==(const Size&, const Size&) = default;
};

/// 8-bit RGBA, sRGB, rows from the top, no padding between rows. Pictures that the library makes are opaque.
class Image {
 public:
  Image() = default;
  /// Filled with one opaque colour. Requires both sides >= 1.
  explicit Image(Size size, Colour fill = {1, 1, 1});

  [[nodiscard]] Size size() const { return size_; }
  [[nodiscard]] int width() const { return size_.width; }
  [[nodiscard]] int height() const { return size_.height; }
  [[nodiscard]] std::span<std::uint8_t> bytes() { return bytes_; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }
  /// The four bytes of a pixel, x to the right, y down.
  [[nodiscard]] std::uint8_t* pixel(int x, int y) { return bytes_.data() + offset(x, y); }
  [[nodiscard]] const std::uint8_t* pixel(int x, int y) const { return bytes_.data() + offset(x, y); }

  /// Copies `source` so that its top left pixel lands on (x, y); what falls outside is dropped.
  void paste(const Image& source, int x, int y);

 private:
  [[nodiscard]] std::size_t offset(int x, int y) const {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x));
  }

  Size size_{0, 0};
  std::vector<std::uint8_t> bytes_;
};

/// Smaller (or larger) copy: every target pixel is the area average of the source (box filter, in display values).
[[nodiscard]] Image resized(const Image& source, Size size);

/// Writes a PNG (folders are made). @return the path, or ErrorCode::bad_value where it cannot be written.
Expected<std::filesystem::path> write_png(const Image& image, const std::filesystem::path& path);

/// Reads any PNG as 8-bit RGBA. @return ErrorCode::bad_value where it cannot be read or is no PNG.
Expected<Image> read_png(const std::filesystem::path& path);

/// Mean and largest absolute difference of two pictures of one size over the colour channels, in 0..255.
struct ImageDifference {
  double mean = 0;
  int largest = 0;
};
[[nodiscard]] ImageDifference difference(const Image& a, const Image& b);

}  // namespace pd::render
