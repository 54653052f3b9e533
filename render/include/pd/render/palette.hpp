/// @file
/// Every colour of every picture: muted for what stands by, saturated for what the picture is about.
///
/// The categorical set is Okabe and Ito's ("Color Universal Design", 2008), which stays distinct under the common kinds
/// of colour blindness, pulled towards grey so that highlights stand out. Components are sRGB display values in [0, 1].
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pd::render {

struct Colour {
  float r;
  float g;
  float b;
  friend bool operator==(const Colour&, const Colour&) = default;
};

namespace palette {

/// From 0xRRGGBB.
constexpr Colour hex(std::uint32_t rgb) {
  return {static_cast<float>((rgb >> 16) & 255u) / 255.0f, static_cast<float>((rgb >> 8) & 255u) / 255.0f,
          static_cast<float>(rgb & 255u) / 255.0f};
}

/// (1 - t) a + t b.
constexpr Colour mix(Colour a, Colour b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

/// Bodies, by class.
inline constexpr std::array<Colour, 7> kCategorical = {hex(0x7FA6C4), hex(0xD9B36C), hex(0x86B5A0), hex(0xC99AB4),
                                                       hex(0x9DC3D8), hex(0xCF9576), hex(0xA9A9A4)};
constexpr Colour categorical(std::size_t i) { return kCategorical[i % kCategorical.size()]; }

/// A slight, repeatable lightness variation of a class colour, so that neighbours of one class read as separate bodies.
constexpr Colour varied(Colour colour, std::uint32_t id) {
  std::uint32_t h = id * 2654435761u;
  h ^= h >> 15;
  const float t = static_cast<float>(h % 1000u) / 999.0f - 0.5f;
  return t < 0 ? mix(colour, hex(0x3A3F47), -t * 0.16f) : mix(colour, hex(0xFFFFFF), t * 0.22f);
}

/// The subject of a picture.
inline constexpr Colour kBodyA = hex(0x4C8DBF);
inline constexpr Colour kBodyB = hex(0xE0A93B);
inline constexpr Colour kDepth = hex(0xD1420F);    ///< the depth arrow: vermilion
inline constexpr Colour kOverlap = hex(0xEE7A33);  ///< A and B's common solid
inline constexpr Colour kContact = hex(0x1B1E24);  ///< contact points and normals
inline constexpr Colour kTrouble = hex(0xC63B22);
inline constexpr Colour kGood = hex(0x2F8F6B);

/// Facets of the Minkowski difference, by kind.
inline constexpr Colour kFacetVertex = hex(0x5B9BC8);
inline constexpr Colour kVertexFacet = hex(0x7DB89C);
inline constexpr Colour kEdgeEdge = hex(0xD6BE7C);
inline constexpr Colour kNearestFacet = hex(0xE8601C);
inline constexpr Colour kDepthBall = hex(0xB05A8C);

/// Lines of charts, saturated enough for thin strokes.
inline constexpr std::array<Colour, 6> kSeries = {hex(0x2F76AC), hex(0xD1420F), hex(0x2F8F6B),
                                                  hex(0xC98A12), hex(0x9C5486), hex(0x5E6672)};
constexpr Colour series(std::size_t i) { return kSeries[i % kSeries.size()]; }

/// Text and paper.
inline constexpr Colour kInk = hex(0x23272E);
inline constexpr Colour kInkSoft = hex(0x5C636E);
inline constexpr Colour kInkFaint = hex(0x9AA0A8);
inline constexpr Colour kPaper = hex(0xF6F5F2);
inline constexpr Colour kRule = hex(0xD9DADB);

/// The studio's backdrop, top and bottom of the picture.
inline constexpr Colour kBackdropTop = hex(0xD3D9E0);
inline constexpr Colour kBackdropBottom = hex(0xEAE6DF);

}  // namespace palette
}  // namespace pd::render
