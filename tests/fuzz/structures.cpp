/// @file
/// Files of strangers by their structure: bytes choose among the words, counts and names of glTF, SVG and .npy files,
/// so that nearly every input is well-formed text whose claims are wrong. Points come back or a refusal, within the
/// limits, and never those of a file beside the folder.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "drawing/polygon_file.hpp"
#include "files/points_file.hpp"
#include "fuzz/input.hpp"
#include "mesh/mesh_file.hpp"
#include "support/refusal.hpp"

namespace pd::fuzz {

namespace {

constexpr std::int64_t kMostVertices = 1000;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 20;
/// The coordinates of the file that no glTF may reach.
constexpr float kSecret = 12345.5F;

template <std::size_t N>
std::string pick(Input& input, const std::array<std::string_view, N>& words) {
  return std::string(words[input.byte() % N]);
}

/// A folder with a buffer, a pipe, a link out, and the secret beside it.
const std::filesystem::path& folder() {
  static const std::filesystem::path made = [] {
    const std::filesystem::path top = "/tmp/pd_fuzz_structures_" + std::to_string(::getpid());
    std::filesystem::create_directories(top / "scene");
    const std::array<float, 32> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::array<float, 32> secret{};
    secret.fill(kSecret);
    const auto write = [](const std::filesystem::path& file, const std::array<float, 32>& values) {
      std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(values.data()), sizeof(values));
    };
    write(top / "scene" / "part.bin", numbers);
    write(top / "secret.bin", secret);
    std::filesystem::create_symlink(top / "secret.bin", top / "scene" / "link.bin");
    (void)::mkfifo((top / "scene" / "pipe").c_str(), 0600);
    return top / "scene";
  }();
  return made;
}

std::string write(const std::string& name, const std::string& text) {
  const std::string file = folder() / name;
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string whole(Input& input) {
  constexpr std::array<std::string_view, 10> kHard = {
      "-1", "4294967295", "4294967296", "1099511627776", "9223372036854775807", "1e300", "0.5", "null", "\"x\"", "[]"};
  const int kind = input.choice(8);
  if (kind < 5) return std::to_string(input.choice(8));
  if (kind < 7) return std::to_string(input.byte());
  return pick(input, kHard);
}

/// {"key":value,...} of some of the keys.
std::string object(Input& input, std::initializer_list<std::pair<std::string_view, std::string>> members) {
  std::string text = "{";
  for (const auto& [key, value] : members) {
    if (input.choice(16) == 15) continue;
    text += (text.size() > 1 ? "," : "") + ("\"" + std::string(key) + "\":" + value);
  }
  return text + "}";
}

template <class Make>
std::string list(Input& input, const Make& make) {
  std::string text = "[";
  for (int i = input.choice(6); i > 0; --i) text += (text.size() > 1 ? "," : "") + make();
  return text + "]";
}

std::string gltf(Input& input) {
  constexpr std::array<std::string_view, 12> kNames = {"\"part.bin\"",
                                                       "\"part.bin\"",
                                                       "\"part.bin\"",
                                                       "\"../secret.bin\"",
                                                       "\"link.bin\"",
                                                       "\"pipe\"",
                                                       "\"/dev/zero\"",
                                                       "\"..%2Fsecret.bin\"",
                                                       "\"./../secret.bin\"",
                                                       "\"data:;base64,AAAAAAAAAAAAAIA/\"",
                                                       "\"\"",
                                                       "7"};
  constexpr std::array<std::string_view, 8> kTypes = {"5126", "5126", "5126", "5120", "5121", "5123", "5125", "5124"};
  constexpr std::array<std::string_view, 4> kShapes = {"\"VEC3\"", "\"VEC3\"", "\"SCALAR\"", "\"MAT4\""};
  const auto node = [&] {
    return object(input, {{"mesh", whole(input)},
                          {"children", list(input, [&] { return whole(input); })},
                          {"translation", "[1,2,3]"},
                          {"scale", "[" + whole(input) + ",1,-1]"}});
  };
  const auto part = [&](std::string_view type) {
    return object(input,
                  {{"bufferView", whole(input)}, {"byteOffset", whole(input)}, {"componentType", std::string(type)}});
  };
  const auto accessor = [&] {
    std::string text = object(input, {{"bufferView", whole(input)},
                                      {"byteOffset", whole(input)},
                                      {"componentType", pick(input, kTypes)},
                                      {"count", whole(input)},
                                      {"type", pick(input, kShapes)}});
    if (input.choice(4) == 3 && text.size() > 2) {
      text.back() = ',';
      text +=
          "\"sparse\":" +
          object(input, {{"count", whole(input)}, {"indices", part(pick(input, kTypes))}, {"values", part("5126")}}) +
          "}";
    }
    return text;
  };
  const auto primitive = [&] {
    const bool indexed = input.choice(2) == 1;
    return object(input, {{"attributes", "{\"POSITION\":" + whole(input) + "}"},
                          {indexed ? "indices" : "material", whole(input)},
                          {"mode", whole(input)}});
  };
  const auto view = [&] {
    return object(input, {{"buffer", "0"}, {"byteOffset", whole(input)}, {"byteLength", whole(input)}});
  };
  const auto buffer = [&] { return object(input, {{"uri", pick(input, kNames)}, {"byteLength", whole(input)}}); };
  const auto mesh = [&] { return "{\"primitives\":" + list(input, primitive) + "}"; };
  // One statement a list: the order in which the operands of + take their bytes is the compiler's choice.
  std::string text = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":)";
  text += list(input, [&] { return whole(input); });
  text += "}],\"nodes\":" + list(input, node);
  text += ",\"meshes\":" + list(input, mesh);
  text += ",\"accessors\":" + list(input, accessor);
  text += ",\"bufferViews\":" + list(input, view);
  text += ",\"buffers\":" + list(input, buffer);
  return text + "}";
}

std::string glb(Input& input, const std::string& json) {
  const auto word = [&](std::size_t honest) {
    const auto n = static_cast<std::uint32_t>(input.choice(8) == 7 ? 0xFFFFFFFF - input.byte() : honest);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &n, 4);
    return bytes;
  };
  const std::string chunk(static_cast<std::size_t>(input.byte()), '\0');
  std::string bytes = "glTF" + word(2);
  bytes += word(28 + json.size() + chunk.size());
  bytes += word(json.size()) + "JSON" + json;
  return bytes + word(chunk.size()) + std::string("BIN\0", 4) + chunk;
}

void judge_mesh(const std::string& file) {
  try {
    const auto mesh = query::read_mesh_points(file, kMostVertices, kMostBytes);
    PD_LAW(static_cast<std::int64_t>(mesh.points.size()) <= kMostVertices);
    PD_LAW(mesh.faces.offsets.back() == static_cast<std::int32_t>(mesh.faces.corners.size()));
    for (const std::int32_t corner : mesh.faces.corners) {
      PD_LAW(corner >= 0 && static_cast<std::size_t>(corner) < mesh.points.size());
    }
    for (const Vec3& p : mesh.points) PD_LAW(!(p.array() == double{kSecret}).any());
  } catch (const query::Refusal&) {
  }
}

std::string svg(Input& input) {
  constexpr std::array<std::string_view, 16> kParts = {"<g>",
                                                       "</g>",
                                                       "<g transform='scale(2)'>",
                                                       "<g transform='matrix(1 0 0 1e308 0 0)'>",
                                                       "<a>",
                                                       "</a>",
                                                       "<rect width='3' height='2'/>",
                                                       "<circle r='1e-320'/>",
                                                       "<path d='M0 0L4 0 4 4z'/>",
                                                       "<path d='M0 0a1 2 3 0 1 9 9z'/>",
                                                       "<polygon points='0 0 1 0 1 1'/>",
                                                       "<ellipse rx='1e308' ry='1'/>",
                                                       "<!--",
                                                       "<style>a{}</style>",
                                                       "<defs>",
                                                       "<use/>"};
  std::string text = "<svg xmlns='http://www.w3.org/2000/svg'>";
  int open = 0;
  while (!input.empty()) {
    const std::string part = pick(input, kParts);
    const int times = input.choice(8) == 7 ? 1 << input.choice(14) : 1;
    for (int i = 0; i < times; ++i) text += part;
    if (part.starts_with("<g")) open += times;
  }
  if (open % 2 == 0) {
    for (int i = 0; i < open; ++i) text += "</g>";
  }
  return text + "</svg>";
}

std::string npy(Input& input) {
  constexpr std::array<std::string_view, 4> kTypes = {"'<f8'", "'<f4'", "'>f8'", "'<i4'"};
  constexpr std::array<std::string_view, 4> kEnds = {")", ",)", ", 2)", ""};
  std::string header = "{'descr': " + pick(input, kTypes);
  header += ", 'fortran_order': False, 'shape': (" + whole(input);
  header += ", " + whole(input);
  header += pick(input, kEnds) + ", }\n";
  const std::size_t length = input.choice(8) == 7 ? input.byte() : header.size();
  std::string bytes = "\x93NUMPY" + std::string(input.choice(4) == 3 ? "\2\0" : "\1\0", 2);
  bytes += static_cast<char>(length % 256);
  bytes += static_cast<char>(length / 256);
  return bytes + header + std::string(8 * static_cast<std::size_t>(input.byte()), '\1');
}

void judge_points(const std::string& file) {
  try {
    query::PointsFile points(file, kMostVertices);
    std::vector<double> numbers;
    std::int64_t rows = 0;
    while (points.next(numbers, 64)) rows += static_cast<std::int64_t>(numbers.size()) / points.dimension();
    PD_LAW(rows <= kMostVertices);
  } catch (const query::Refusal&) {
  }
}

}  // namespace

}  // namespace pd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pd::fuzz;
  Input input({data, size});
  switch (input.choice(4)) {
    case 0:
      judge_mesh(write("a.gltf", gltf(input)));
      break;
    case 1: {
      const std::string json = gltf(input);
      judge_mesh(write("a.glb", glb(input, json)));
      break;
    }
    case 2:
      try {
        pd::query::Limits limits;
        limits.max_vertices = kMostVertices;
        (void)pd::drawing::read_polygon_file(write("a.svg", svg(input)), {}, "", limits);
      } catch (const pd::query::Refusal&) {
      }
      break;
    default:
      judge_points(write("a.npy", npy(input)));
  }
  return 0;
}
