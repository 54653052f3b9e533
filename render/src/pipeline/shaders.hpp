/// @file
/// The pipeline's shaders, as text.
///
/// Shading is linear; each surface shader ends in the tone curve and the sRGB curve, so that the multisample resolve
/// and all blending average display values, which keeps bright-against-dark edges smooth.
#pragma once

#include <string>

namespace pd::render::detail {

/// Depth from the light.
extern const char* const kShadowVertex;
extern const char* const kShadowFragment;
extern const char* const kOpaqueShadowFragment;

/// Half-size surface: view-space normal and distance along the line of sight.
extern const char* const kSurfaceVertex;
extern const char* const kSurfaceFragment;
extern const char* const kGroundSurfaceFragment;

/// Ambient occlusion and the key light's soft shadow from the half-size surface; then its smoothing.
extern const char* const kFullScreenVertex;
extern const char* const kOcclusionFragment;
extern const char* const kSmoothFragment;

/// The picture: backdrop, ground, bodies, translucent surfaces, ink, overlays.
extern const char* const kGroundVertex;
extern const char* const kBodyVertex;
extern const char* const kEdgeVertex;
extern const char* const kEdgeFragment;
extern const char* const kOverlayVertex;
extern const char* const kOverlayFragment;
std::string backdrop_fragment();
std::string ground_fragment();
std::string body_fragment();
std::string translucent_fragment();

}  // namespace pd::render::detail
