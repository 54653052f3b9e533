#include "pipeline/shaders.hpp"

namespace pd::render::detail {

const char* const kShadowVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 model;
uniform mat4 shadow;
void main() {
  vec4 map = shadow * (model * vec4(position, 1));
  gl_Position = vec4(2 * map.xyz - 1, 1);
}
)";

// A translucent caster lets a share of the light through: it leaves out that share of the map's texels, in an ordered
// pattern that the soft shadow's many taps average.
const char* const kShadowFragment = R"(#version 330 core
uniform float density;
const float kOrder[16] = float[](0.5, 8.5, 2.5, 10.5, 12.5, 4.5, 14.5, 6.5, 3.5, 11.5, 1.5, 9.5, 15.5, 7.5, 13.5, 5.5);
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy) % 4;
  if (kOrder[cell.x + 4 * cell.y] > 16 * density) discard;
}
)";

const char* const kOpaqueShadowFragment = R"(#version 330 core
void main() {}
)";

const char* const kSurfaceVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 model;
uniform mat4 projection;
uniform mat3 axes;
uniform vec3 eye;
uniform float normal_scale;
out vec3 view_normal;
out float distance_along;
void main() {
  vec4 place = model * vec4(position, 1);
  view_normal = axes * (mat3(model) * normal) * normal_scale;
  distance_along = dot(transpose(axes)[2], place.xyz - eye);
  gl_Position = projection * place;
}
)";

const char* const kSurfaceFragment = R"(#version 330 core
in vec3 view_normal;
in float distance_along;
out vec4 surface;
void main() { surface = vec4(normalize(view_normal), distance_along); }
)";

const char* const kGroundSurfaceFragment = R"(#version 330 core
in float distance_along;
out vec4 surface;
uniform vec3 view_normal;
void main() { surface = vec4(view_normal, distance_along); }
)";

const char* const kFullScreenVertex = R"(#version 330 core
out vec2 unit;  // 0..1, y down
void main() {
  unit = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2 * unit - 1, 0.999999, 1);
}
)";

// Ambient occlusion after McGuire et al., "The Alchemy Screen-Space Ambient Obscurance Algorithm" (2011). Soft shadows
// after Fernando, "Percentage-Closer Soft Shadows" (2005): the mean distance of the blockers sets the width of the
// filter. Both turn their samples by one of 16 angles, tiled 4 x 4, which the smoothing pass averages away.
const char* const kOcclusionFragment = R"(#version 330 core
in vec2 unit;
out vec4 result;
uniform sampler2D surface;
uniform sampler2D shadow_map;
uniform vec2 tangents;
uniform vec2 texel;            // of the surface
uniform mat4 shadow_from_view;
uniform vec3 light_in_view;
uniform float shadow_texel;
uniform float shadow_width;    // drawing units
uniform float radius;
uniform float light_tangent;   // of half the light's angle

const int kShadowTaps = 16;
const int kSearchTaps = 8;
const int kAmbientTaps = 10;
const vec2 kDisc[16] = vec2[](
  vec2(0.176777, 0.000000), vec2(-0.225772, 0.206831), vec2(0.034506, -0.393775), vec2(0.284579, 0.371171),
  vec2(-0.522223, -0.092395), vec2(0.494692, -0.314682), vec2(-0.165483, 0.615520), vec2(-0.315377, -0.607568),
  vec2(0.684642, 0.250005), vec2(-0.712252, 0.293758), vec2(0.343387, -0.733598), vec2(0.253418, 0.808942),
  vec2(-0.764746, -0.443172), vec2(0.897253, -0.197037), vec2(-0.547722, 0.778772), vec2(-0.126091, -0.976090));

vec3 place_at(vec2 at, float along) { return vec3((2 * at.x - 1) * tangents.x, (1 - 2 * at.y) * tangents.y, 1) * along; }

float key_visibility(vec3 place, vec3 normal, mat2 turn) {
  float facing = dot(normal, light_in_view);
  // Off the surface by about a texel, more where the light grazes.
  float push = 1.5 * shadow_texel * shadow_width * (1 + 2 * sqrt(max(0, 1 - facing * facing)));
  vec3 map = (shadow_from_view * vec4(place + push * normal, 1)).xyz;
  bool mapped = facing > 0 && map.x > 0 && map.x < 1 && map.y > 0 && map.y < 1;
  // A software rasteriser skips no branch, but it leaves a loop when no pixel is left in it: counts, not conditions.
  int searches = mapped ? kSearchTaps : 0;
  float search = clamp(0.32 * light_tangent, 3 * shadow_texel, 0.06);
  // The map ends with its casters: receivers behind its far plane are compared just in front of it.
  float compared = min(map.z, 0.9999);
  float blockers = 0;
  float depths = 0;
  for (int i = 0; i < searches; ++i) {
    float depth = texture(shadow_map, map.xy + turn * kDisc[2 * i + 1] * search).r;
    float blocks = step(depth, compared);
    blockers += blocks;
    depths += blocks * depth;
  }
  float gap = map.z - depths / max(blockers, 1);
  float width = clamp(gap * light_tangent, 1.6 * shadow_texel, 0.06);
  int taps = blockers > 0 ? kShadowTaps : 0;
  float lit = 0;
  for (int i = 0; i < taps; ++i) {
    lit += step(compared, texture(shadow_map, map.xy + turn * kDisc[i] * width).r);
  }
  return facing <= 0 ? 0.0 : taps == 0 ? 1.0 : lit / kShadowTaps;
}

void main() {
  vec4 here = texture(surface, unit);
  if (here.w <= 0) {
    result = vec4(1, 1, 0, 0);
    return;
  }
  vec3 place = place_at(unit, here.w);
  int cell = int(gl_FragCoord.x) % 4 + 4 * (int(gl_FragCoord.y) % 4);
  // An order of the 16 angles in which neighbours differ much.
  float angle = float((cell * 7 + 3 * (cell / 4)) % 16) * (6.2831853 / 16.0);
  mat2 turn = mat2(cos(angle), sin(angle), -sin(angle), cos(angle));

  float reach = clamp(radius / (here.w * tangents.y * 2), 3 * texel.y, 0.12);  // in picture heights
  vec2 stride = vec2(reach * tangents.y / tangents.x, reach);
  float sum = 0;
  float radius_squared = radius * radius;
  for (int i = 0; i < kAmbientTaps; ++i) {
    vec2 at = unit + turn * kDisc[i + 3] * stride;
    float along = texture(surface, at).w;
    vec3 gap = place_at(at, along) - place;
    float squared = dot(gap, gap);
    float above = dot(gap, here.xyz) - 0.0015 * here.w;
    float near = along > 0 ? max(0, 1 - squared / radius_squared) : 0;
    sum += max(0, above) * near * inversesqrt(squared + 1e-9);
  }
  float ambient = clamp(1 - 2.1 * sum / kAmbientTaps, 0, 1);
  result = vec4(ambient, key_visibility(place, here.xyz, turn), here.w, 0);
}
)";

const char* const kSmoothFragment = R"(#version 330 core
out vec4 result;
uniform sampler2D raw;
uniform int stride;  // of the 4 x 4 taps, -2..1 times this
uniform int shift;
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(raw, 0) - 1;
  float along = texelFetch(raw, here, 0).z;
  vec2 sum = vec2(0);
  float weights = 0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      vec3 tap = texelFetch(raw, clamp(here + ivec2(x, y) * stride + shift, ivec2(0), last), 0).xyz;
      float weight = max(1e-4, 1 - abs(tap.z - along) * 40 / (along + 1e-6));
      sum += weight * tap.xy;
      weights += weight;
    }
  }
  result = vec4(sum / weights, along, 0);
}
)";

}  // namespace pd::render::detail
