#include "pipeline/shaders.hpp"

namespace pd::render::detail {
namespace {

// Colour curves. The sRGB pair is a fit by square roots (error below 0.004), several times cheaper than powers on a
// software rasteriser; the tone curve is Narkowicz's fit of the ACES filmic curve.
constexpr const char* kColourCurves = R"(
vec3 to_display(vec3 linear) {
  vec3 a = sqrt(clamp(linear, 0, 1));
  vec3 b = sqrt(a);
  return clamp(0.585122381 * a + 0.783140355 * b - 0.368262736 * sqrt(b), 0, 1);
}
vec3 to_linear(vec3 display) { return display * (display * (display * 0.305306011 + 0.682171111) + 0.012522878); }
float filmic(float x) { return (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14); }
// On the brightest component, so that a hue stays itself on its way to white.
vec3 filmic(vec3 colour) {
  float peak = max(max(colour.r, colour.g), max(colour.b, 1e-4));
  return colour * (filmic(peak) / peak);
}
)";

// Half-size occlusion brought to full size: bilinear, weighted by likeness of distance; along silhouettes, where none
// of the four texels belongs to this surface, the ring of twelve round them is asked too. The smoothing pass averages a
// window that is off by half a texel, which the missing shift takes back.
constexpr const char* kOcclusionLookup = R"(
uniform sampler2D occlusion;
const ivec2 kNear[16] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(0, 1), ivec2(1, 1),
  ivec2(-1, 0), ivec2(-1, 1), ivec2(2, 0), ivec2(2, 1), ivec2(0, -1), ivec2(1, -1), ivec2(0, 2), ivec2(1, 2),
  ivec2(-1, -1), ivec2(2, -1), ivec2(-1, 2), ivec2(2, 2));
vec2 visibility(float along) {
  vec2 at = gl_FragCoord.xy * 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 part = at - vec2(base);
  ivec2 last = textureSize(occlusion, 0) - 1;
  vec2 sum = vec2(0);
  float weights = 0;
  bool found = false;
  for (int k = 0; k < 4 || (k < 16 && !found); ++k) {
    vec3 tap = texelFetch(occlusion, clamp(base + kNear[k], ivec2(0), last), 0).xyz;
    vec2 near = max(vec2(0), 1 - abs(vec2(kNear[k]) - part));
    float apart = abs(tap.z - along) / along;
    found = found || apart < 0.02;
    float weight = (near.x * near.y + 1e-3) / (1e-3 + apart * (1 + 400 * apart));
    sum += weight * tap.xy;
    weights += weight;
  }
  return sum / weights;
}
)";

constexpr const char* kBackdrop = R"(
uniform vec3 backdrop_top;
uniform vec3 backdrop_bottom;
uniform vec2 picture;
vec3 backdrop() {
  vec2 at = gl_FragCoord.xy / picture;
  vec2 off = (at - vec2(0.5, 0.52)) * vec2(1.0, 0.9);
  float vignette = 1 - 0.11 * smoothstep(0.1, 0.75, dot(off, off) * 1.9);
  return mix(backdrop_top, backdrop_bottom, smoothstep(0.0, 0.95, at.y)) * vignette;
}
)";

}  // namespace

std::string backdrop_fragment() {
  return std::string("#version 330 core\n") + kBackdrop +
         "out vec4 pixel;\nvoid main() { pixel = vec4(backdrop(), 1); }\n";
}

const char* const kGroundVertex = R"(#version 330 core
uniform mat4 projection;
uniform vec3 centre;
uniform vec3 axis_x;
uniform vec3 axis_y;
uniform vec3 eye;
uniform mat3 axes;
uniform float reach;
out vec2 ground;        // from the centre, drawing units
out float distance_along;
void main() {
  ground = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2 * reach - reach;
  vec3 place = centre + ground.x * axis_x + ground.y * axis_y;
  distance_along = dot(transpose(axes)[2], place - eye);
  gl_Position = projection * vec4(place, 1);
}
)";

// The floor has the backdrop's own tone, pixel by pixel, so there is no horizon; shadow, occlusion and grid darken it.
std::string ground_fragment() {
  return std::string("#version 330 core\n") + kColourCurves + kOcclusionLookup + kBackdrop + R"(
in vec2 ground;
in float distance_along;
out vec4 pixel;
uniform float grid_step;
uniform vec2 grid_offset;
uniform float focus_radius;

float grid_lines(vec2 at, float width_pixels) {
  vec2 slope = fwidth(at);
  vec2 gap = abs(fract(at - 0.5) - 0.5) / slope;
  vec2 line = clamp(0.5 + 0.5 * width_pixels - gap, 0, 1);
  // Lines closer than a few pixels melt into the floor before they shimmer.
  line *= 1 - smoothstep(0.06, 0.3, slope);
  return max(line.x, line.y);
}

void main() {
  float away = length(ground);
  vec2 seen = mix(visibility(distance_along), vec2(1), smoothstep(3.5 * focus_radius, 7 * focus_radius, away));
  float fade = 1 - smoothstep(1.2 * focus_radius, 4.5 * focus_radius, away);
  vec3 floor_colour = to_linear(backdrop());
  // A pool of light round the bodies.
  floor_colour *= 1 + 0.07 * exp(-away * away / (2.6 * focus_radius * focus_radius));
  vec3 key = vec3(0.56, 0.535, 0.50);
  vec3 light = (1 - key) * seen.x + key * seen.y * mix(1.0, seen.x, 0.4);
  vec2 at = ground / grid_step + grid_offset;
  float ink = 0.10 * grid_lines(at, 1.0) + 0.13 * grid_lines(at / 10, 1.4);
  pixel = vec4(to_display(floor_colour * light * (1 - fade * ink)), 1);
}
)";
}

const char* const kBodyVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tint;
uniform mat4 model;
uniform mat4 projection;
uniform mat3 axes;
uniform vec3 eye;
uniform float normal_scale;
out vec3 world_normal;
out vec3 to_eye;
out float distance_along;
out vec4 surface_tint;
void main() {
  vec4 place = model * vec4(position, 1);
  world_normal = mat3(model) * normal * normal_scale;
  to_eye = eye - place.xyz;
  distance_along = dot(transpose(axes)[2], place.xyz - eye);
  surface_tint = tint;
  gl_Position = projection * place;
}
)";

std::string body_fragment() {
  return std::string("#version 330 core\n") + kColourCurves + kOcclusionLookup + R"(
in vec3 world_normal;
in vec3 to_eye;
in float distance_along;
in vec4 surface_tint;
out vec4 pixel;
uniform vec4 colour;  // display values, opacity
uniform vec3 up;
uniform vec3 to_light;
void main() {
  vec3 normal = normalize(world_normal);
  vec3 sight = normalize(to_eye);
  vec2 seen = visibility(distance_along);
  vec3 albedo = to_linear(mix(colour.rgb, surface_tint.rgb, surface_tint.a));
  float height = 0.5 + 0.5 * dot(normal, up);
  vec3 ambient = mix(vec3(0.40, 0.385, 0.37), vec3(0.74, 0.78, 0.84), height) * seen.x;
  vec3 key = vec3(1.36, 1.30, 1.20) * max(0, dot(normal, to_light)) * seen.y;
  float grazing = 1 - max(0, dot(normal, sight));
  float rim = grazing * grazing * grazing * grazing * (0.35 + 0.65 * height) * seen.x;
  vec3 light = albedo * (ambient + key) + vec3(0.16, 0.18, 0.21) * rim;
  pixel = vec4(to_display(filmic(0.64 * light)), colour.a);
}
)";
}

std::string translucent_fragment() {
  return std::string("#version 330 core\n") + kColourCurves + R"(
in vec3 world_normal;
in vec3 to_eye;
in vec4 surface_tint;
out vec4 pixel;
uniform vec4 colour;
uniform vec3 up;
uniform vec3 to_light;
void main() {
  vec3 normal = normalize(world_normal);
  vec3 sight = normalize(to_eye);
  float facing = dot(normal, sight);
  normal = facing < 0 ? -normal : normal;
  facing = abs(facing);
  vec3 albedo = to_linear(mix(colour.rgb, surface_tint.rgb, surface_tint.a));
  float height = 0.5 + 0.5 * dot(normal, up);
  vec3 light = albedo * (mix(vec3(0.55), vec3(0.85), height) + vec3(0.95, 0.92, 0.86) * max(0, dot(normal, to_light)));
  // Glass is denser where it is seen along its face.
  float density = mix(1.25, 0.85, facing);
  pixel = vec4(to_display(filmic(0.72 * light)), clamp(colour.a * (colour.a > 0.99 ? 1.0 : density), 0, 1));
}
)";
}

// A line of constant width on the screen: four corners an edge.
const char* const kEdgeVertex = R"(#version 330 core
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec3 normal_left;
layout(location = 3) in vec3 normal_right;
uniform mat4 model;
uniform mat4 projection;
uniform vec3 eye;
uniform vec2 picture;
uniform float width;        // pixels
uniform float towards_eye;  // share of the way that the line is pulled in front of its surface
uniform float back_share;   // opacity where both sides face away
out float across;
out float strength;
vec3 pulled(vec3 p) { return (model * vec4(p, 1)).xyz * (1 - towards_eye) + towards_eye * eye; }
void main() {
  vec3 a = pulled(from);
  vec3 b = pulled(to);
  vec4 clip_a = projection * vec4(a, 1);
  vec4 clip_b = projection * vec4(b, 1);
  const float near = 0.01;
  if (clip_a.w < near && clip_b.w >= near) clip_a = mix(clip_b, clip_a, (clip_b.w - near) / (clip_b.w - clip_a.w));
  if (clip_b.w < near && clip_a.w >= near) clip_b = mix(clip_a, clip_b, (clip_a.w - near) / (clip_a.w - clip_b.w));
  vec2 screen_a = clip_a.xy / clip_a.w * picture * 0.5;
  vec2 screen_b = clip_b.xy / clip_b.w * picture * 0.5;
  vec2 along = screen_b - screen_a;
  float span = length(along);
  along = span > 1e-4 ? along / span : vec2(1, 0);
  vec2 side = vec2(-along.y, along.x);
  float reach = 0.5 * width + 0.5;
  int corner = gl_VertexID % 4;
  bool far_end = corner >= 2;
  across = (corner & 1) == 1 ? reach : -reach;
  vec4 clip = far_end ? clip_b : clip_a;
  vec2 shift = side * across + along * (far_end ? 0.4 : -0.4) * width;
  clip.xy += shift * 2 / picture * clip.w;
  bool front = dot(mat3(model) * normal_left, eye - a) > 0 || dot(mat3(model) * normal_right, eye - a) > 0;
  strength = front ? 1.0 : back_share;
  gl_Position = clip.w < near || strength == 0 ? vec4(2, 2, 2, 1) : clip;
}
)";

const char* const kEdgeFragment = R"(#version 330 core
in float across;
in float strength;
out vec4 pixel;
uniform vec4 colour;
uniform float width;
void main() { pixel = vec4(colour.rgb, colour.a * strength * clamp(0.5 * width + 0.5 - abs(across), 0, 1)); }
)";

const char* const kOverlayVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tint;
uniform mat4 projection;
out vec3 world_normal;
out vec4 surface_tint;
void main() {
  world_normal = normal;
  surface_tint = tint;
  gl_Position = projection * vec4(position, 1);
}
)";

const char* const kOverlayFragment = R"(#version 330 core
in vec3 world_normal;
in vec4 surface_tint;
out vec4 pixel;
uniform vec3 to_light;
uniform float opacity;
uniform float flatness;  // 1: no shading
void main() {
  float light = mix(0.80 + 0.24 * dot(normalize(world_normal), to_light), 1, flatness);
  pixel = vec4(min(surface_tint.rgb * light, 1), surface_tint.a * opacity);
}
)";

}  // namespace pd::render::detail
