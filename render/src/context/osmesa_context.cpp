/// @file
/// OSMesa: Mesa's software rasteriser without any window system.
#include <GL/osmesa.h>

#include <array>

#include "context/contexts.hpp"
#include "context/shared_library.hpp"

namespace pd::render::detail {
namespace {

struct OsmesaFunctions {
  decltype(OSMesaCreateContextAttribs)* create = nullptr;
  decltype(OSMesaDestroyContext)* destroy = nullptr;
  decltype(OSMesaMakeCurrent)* make_current = nullptr;
  decltype(OSMesaGetProcAddress)* function = nullptr;
};

class OsmesaContext final : public OffscreenContext {
 public:
  OsmesaContext(SharedLibrary library, const OsmesaFunctions& functions, OSMesaContext context)
      : library_(std::move(library)), functions_(functions), context_(context) {}
  ~OsmesaContext() override { functions_.destroy(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  bool make_current() override {
    return functions_.make_current(context_, buffer_.data(), GL_UNSIGNED_BYTE, kSide, kSide) == GL_TRUE;
  }
  Function function(const char* name) const override { return functions_.function(name); }

 private:
  // OSMesa wants a colour buffer; nothing is ever drawn into it, because it has no samples.
  static constexpr int kSide = 4;

  SharedLibrary library_;
  OsmesaFunctions functions_;
  OSMesaContext context_;
  std::array<unsigned char, 4 * kSide * kSide> buffer_{};
};

}  // namespace

Expected<std::unique_ptr<OffscreenContext>> create_osmesa_context() {
  SharedLibrary library{"libOSMesa.so.8", "libOSMesa.so"};
  if (!library.opened()) {
    return Error{ErrorCode::unsupported, "libOSMesa.so.8 is not installed (Debian package libosmesa6)", "renderer"};
  }
  OsmesaFunctions functions;
  if (!library.find("OSMesaCreateContextAttribs", functions.create) ||
      !library.find("OSMesaDestroyContext", functions.destroy) ||
      !library.find("OSMesaMakeCurrent", functions.make_current) ||
      !library.find("OSMesaGetProcAddress", functions.function)) {
    return Error{ErrorCode::unsupported, "libOSMesa is older than 11.2: it cannot make a core profile", "renderer"};
  }
  constexpr std::array<int, 13> kAttributes = {OSMESA_FORMAT,
                                               OSMESA_RGBA,
                                               OSMESA_DEPTH_BITS,
                                               24,
                                               OSMESA_PROFILE,
                                               OSMESA_CORE_PROFILE,
                                               OSMESA_CONTEXT_MAJOR_VERSION,
                                               3,
                                               OSMESA_CONTEXT_MINOR_VERSION,
                                               3,
                                               0,
                                               0,
                                               0};
  OSMesaContext context = functions.create(kAttributes.data(), nullptr);
  if (context == nullptr) {
    return Error{ErrorCode::unsupported, "OSMesa refuses an OpenGL 3.3 core context", "renderer"};
  }
  return std::unique_ptr<OffscreenContext>(std::make_unique<OsmesaContext>(std::move(library), functions, context));
}

}  // namespace pd::render::detail
