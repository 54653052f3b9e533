#include "mesh/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "files/regular_file.hpp"
#include "support/refusal.hpp"

namespace pd::query {

namespace {

/// No buffer is longer, and sums and products of a few such numbers fit in 64 bits.
constexpr std::int64_t kMostBytes = std::int64_t{1} << 40;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

/// Bytes of a component; 0: no such type.
std::int64_t component_bytes(std::int64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

int read_component_type(const Node& object) {
  const Node node = object.at("componentType");
  const std::int64_t type = read_integer(node, 0, kMostBytes);
  if (component_bytes(type) == 0) node.refuse("bad_value", "must be 5120, 5121, 5122, 5123, 5125 or 5126");
  return static_cast<int>(type);
}

double read_component(const char* bytes, int type, bool normalized) {
  std::uint32_t word = 0;
  for (auto i = static_cast<std::size_t>(component_bytes(type)); i-- > 0;) {
    word = word << 8 | static_cast<unsigned char>(bytes[i]);
  }
  // [GLTF] 3.6.2.2: c / 127 and the like, never below -1.
  const auto fraction = [&](double value, double most) { return normalized ? std::max(value / most, -1.0) : value; };
  switch (type) {
    case kByte:
      return fraction(static_cast<std::int8_t>(word), 127);
    case kUnsignedByte:
      return fraction(word, 255);
    case kShort:
      return fraction(static_cast<std::int16_t>(word), 32767);
    case kUnsignedShort:
      return fraction(word, 65535);
    case kUnsignedInt:
      return word;
    default:
      return double{std::bit_cast<float>(word)};
  }
}

std::string decode_base64(const Node& uri, std::string_view text) {
  static const std::array<std::int8_t, 256> kDigits = [] {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::int8_t, 256> digits{};
    digits.fill(-1);
    for (std::size_t i = 0; i < kLetters.size(); ++i) {
      digits[static_cast<unsigned char>(kLetters[i])] = static_cast<std::int8_t>(i);
    }
    return digits;
  }();
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    const int digit = kDigits[static_cast<unsigned char>(c)];
    if (digit < 0) uri.refuse("bad_value", "a data URI holds a character that is no base64");
    word = word << 6 | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits);
  }
  return bytes;
}

/// "my%20part.bin" as the file's name.
std::string percent_decoded(const Node& uri, std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char small = static_cast<char>(c | 0x20);
    return small >= 'a' && small <= 'f' ? small - 'a' + 10 : -1;
  };
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      name += text[i];
      continue;
    }
    const bool whole = i + 2 < text.size();
    const int high = whole ? digit(text[i + 1]) : -1, low = whole ? digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) uri.refuse("bad_value", "% must be followed by two hexadecimal digits");
    name += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return name;
}

std::string load(const Node& uri, const std::string& path, std::int64_t bytes) {
  const std::string& text = uri.json().get_ref<const std::string&>();
  if (text.starts_with("data:")) {
    constexpr std::string_view kMark = ";base64,";
    const std::size_t mark = text.find(kMark);
    if (mark == std::string::npos) uri.refuse("unsupported", "a data URI must be base64");
    return decode_base64(uri, std::string_view(text).substr(mark + kMark.size()));
  }
  // A colon in front of any slash ends a scheme: http:, file:, or a drive's letter.
  if (const std::size_t colon = text.find(':'); colon < std::min(text.find('/'), text.size())) {
    uri.refuse("bad_value", "only data: URIs and files in the glTF's own folder are read");
  }
  try {
    return RegularFile::open_beside(path, percent_decoded(uri, text), static_cast<std::uintmax_t>(kMostBytes))
        .read(static_cast<std::uintmax_t>(bytes));
  } catch (const Refusal& refusal) {
    if (!refusal.where.empty()) throw;
    uri.refuse(refusal.code, refusal.message);
  }
}

}  // namespace

Node gltf_element(const std::optional<Node>& list, std::string_view name, std::int64_t index) {
  if (!list) refuse("bad_value", "an index names an element of \"" + std::string(name) + "\", which is missing", "");
  require_array(*list, "an array");
  if (index < 0 || index >= static_cast<std::int64_t>(list->size())) {
    list->refuse("bad_value",
                 "holds " + std::to_string(list->size()) + " elements; there is no number " + std::to_string(index));
  }
  return list->element(static_cast<std::size_t>(index));
}

std::int64_t gltf_integer(const Node& object, std::string_view key, std::int64_t otherwise) {
  require_object(object);
  const auto node = object.find(key);
  return node ? read_integer(*node, 0, kMostBytes) : otherwise;
}

GltfBuffers::GltfBuffers(const Node& root, Source source)
    : accessors_(root.find("accessors")),
      views_(root.find("bufferViews")),
      buffers_(root.find("buffers")),
      source_(std::move(source)),
      loaded_(buffers_ ? buffers_->size() : 0) {}

std::string_view GltfBuffers::buffer(std::int64_t index) {
  const Node node = gltf_element(buffers_, "buffers", index);
  const std::int64_t length = read_integer(node.at("byteLength"), 1, kMostBytes);
  const auto uri = node.find("uri");
  if (!uri) {
    if (index != 0 || !source_.chunk) node.refuse("missing_field", "a buffer outside of a GLB needs a \"uri\"");
    if (length > static_cast<std::int64_t>(source_.chunk->size())) {
      node.refuse("bad_value", "claims " + std::to_string(length) + " bytes; the GLB's chunk has " +
                                   std::to_string(source_.chunk->size()));
    }
    return source_.chunk->substr(0, static_cast<std::size_t>(length));
  }
  auto& bytes = loaded_[static_cast<std::size_t>(index)];
  if (!bytes) {
    (void)read_string(*uri);
    if (static_cast<std::uintmax_t>(length) > source_.max_bytes) {
      node.refuse("limit_exceeded", "the buffers hold too many bytes in all");
    }
    source_.max_bytes -= static_cast<std::uintmax_t>(length);
    bytes = load(*uri, source_.path, length);
    if (static_cast<std::int64_t>(bytes->size()) < length) {
      node.refuse("bad_value",
                  "claims " + std::to_string(length) + " bytes; its URI has " + std::to_string(bytes->size()));
    }
  }
  return std::string_view(*bytes).substr(0, static_cast<std::size_t>(length));
}

std::string_view GltfBuffers::view_bytes(const Node& user, const Wanted& wanted, std::int64_t& stride) {
  const Node view = gltf_element(views_, "bufferViews", gltf_integer(user, "bufferView", -1));
  require_object(view);
  if (const auto extensions = view.find("extensions")) {
    require_object(*extensions);
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      if (extensions->find(name))
        extensions->refuse("unsupported", std::string(name) + ": store the mesh uncompressed");
    }
  }
  const std::int64_t offset = gltf_integer(view, "byteOffset", 0);
  const std::int64_t length = read_integer(view.at("byteLength"), 0, kMostBytes);
  stride = gltf_integer(view, "byteStride", wanted.element_bytes);
  if (stride < wanted.element_bytes || stride > 252) {
    view.refuse("bad_value", "byteStride must be an element's bytes at least, and 252 at most");
  }
  const std::string_view bytes = buffer(read_integer(view.at("buffer"), 0, kMostBytes));
  if (offset + length > static_cast<std::int64_t>(bytes.size())) {
    view.refuse("bad_value", "ends behind its buffer, which has " + std::to_string(bytes.size()) + " bytes");
  }
  const std::int64_t first = gltf_integer(user, "byteOffset", 0);
  if (wanted.count > 0 && first + wanted.element_bytes + (wanted.count - 1) * stride > length) {
    user.refuse("bad_value", std::to_string(wanted.count) + " elements end behind their bufferView");
  }
  return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length))
      .substr(static_cast<std::size_t>(std::min(first, length)));
}

void GltfBuffers::read_sparse(const Node& sparse, GltfValues& values) {
  const std::int64_t count = read_integer(sparse.at("count"), 0, values.count_);
  source_.max_replaced -= count;
  if (source_.max_replaced < 0) sparse.refuse("limit_exceeded", "more sparse values than --max-vertices allows");
  const Node indices = sparse.at("indices"), replacements = sparse.at("values");
  const int type = read_component_type(indices);
  std::int64_t stride = 0;
  const std::string_view bytes = view_bytes(indices, {count, component_bytes(type)}, stride);
  const std::int64_t element = values.components_ * component_bytes(values.component_type_);
  std::int64_t packed = 0;
  values.replacements_ = view_bytes(replacements, {count, element}, packed);
  if (packed != element)
    replacements.refuse("bad_value", "the values of a sparse accessor are stored without a stride");
  for (std::int64_t i = 0; i < count; ++i) {
    const double index = read_component(bytes.data() + i * stride, type, false);
    const bool increasing = values.replaced_.empty() || index > static_cast<double>(values.replaced_.back());
    if (!(index >= 0 && index < static_cast<double>(values.count_)) || !increasing) {
      indices.refuse("bad_value", "must increase, and name elements of the accessor");
    }
    values.replaced_.push_back(static_cast<std::int64_t>(index));
  }
}

GltfValues GltfBuffers::values(std::int64_t accessor, std::string_view type) {
  const Node node = gltf_element(accessors_, "accessors", accessor);
  require_object(node);
  GltfValues values;
  values.component_type_ = read_component_type(node);
  values.count_ = read_integer(node.at("count"), 0, kMostBytes);
  if (read_string(node.at("type")) != type) node.at("type").refuse("bad_value", "must be " + std::string(type));
  values.components_ = type == "VEC3" ? 3 : 1;
  if (const auto normalized = node.find("normalized")) values.normalized_ = normalized->json() == Json(true);
  const Wanted wanted{values.count_, values.components_ * component_bytes(values.component_type_)};
  if (node.find("bufferView")) values.bytes_ = view_bytes(node, wanted, values.stride_);
  if (const auto sparse = node.find("sparse")) {
    require_object(*sparse);
    read_sparse(*sparse, values);
  } else if (values.bytes_.empty() && values.count_ > 0) {
    node.refuse("unsupported", "an accessor needs a \"bufferView\": compressed meshes are not read");
  }
  return values;
}

double GltfValues::at(std::int64_t i, int k) const {
  const std::int64_t size = component_bytes(component_type_);
  const auto replaced = std::lower_bound(replaced_.begin(), replaced_.end(), i);
  if (replaced != replaced_.end() && *replaced == i) {
    const std::int64_t element = (replaced - replaced_.begin()) * components_ + k;
    return read_component(replacements_.data() + element * size, component_type_, normalized_);
  }
  if (bytes_.empty()) return 0;
  return read_component(bytes_.data() + i * stride_ + k * size, component_type_, normalized_);
}

}  // namespace pd::query
