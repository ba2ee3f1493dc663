// OSMesa: off-screen rendering into client memory by Mesa's software rasteriser; needs no display, no device, no window
// system. The library is loaded on demand, so that the other hosts do not load it (it brings LLVM along).
#include "base/error.hpp"
#include "host/host_backends.hpp"

#ifdef LUCERNA_OSMESA

// glew.h undefines GLAPI, which osmesa.h needs: GLEW must not be included in this file.
#include <GL/osmesa.h>

#include <dlfcn.h>

#include <array>
#include <cstdint>

namespace lucerna {

namespace {
constexpr const char* kLibrary = "libOSMesa.so.8";
}

bool osmesaAvailable() { return dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL) != nullptr; }  // stays loaded: it is used next

namespace detail {

namespace {

struct OsmesaLibrary {
  void* handle = nullptr;
  decltype(&OSMesaCreateContextAttribs) createContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) destroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) getProcAddress = nullptr;
};

OsmesaLibrary& library() {
  static OsmesaLibrary osmesa = [] {
    OsmesaLibrary l;
    l.handle = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
    if (!l.handle) throwMissingCapability("host osmesa: {} (Debian package libosmesa6); try --host egl", dlerror());
    const auto load = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(l.handle, name));
      if (!function) throwMissingCapability("host osmesa: {} has no {}", kLibrary, name);
    };
    load(l.createContextAttribs, "OSMesaCreateContextAttribs");
    load(l.destroyContext, "OSMesaDestroyContext");
    load(l.makeCurrent, "OSMesaMakeCurrent");
    load(l.getProcAddress, "OSMesaGetProcAddress");
    return l;
  }();
  return osmesa;
}

class OsmesaHost final : public Host {
 public:
  OsmesaHost() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_STENCIL_BITS,
                              0,
                              OSMESA_ACCUM_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              4,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = library().createContextAttribs(attributes, nullptr);
    if (!context_) throwMissingCapability("host osmesa: no OpenGL 4.3 core context");
    if (!library().makeCurrent(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1)) {
      library().destroyContext(context_);
      throwMissingCapability("host osmesa: the context cannot be made current");
    }
    setGlLoader([](const char* name) { return reinterpret_cast<GlProc>(library().getProcAddress(name)); }, false);
  }
  ~OsmesaHost() override {
    setGlLoader(nullptr, false);
    library().makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
    library().destroyContext(context_);
  }
  HostKind kind() const override { return HostKind::osmesa; }
  void present(unsigned, glm::ivec2) override {}
  glm::ivec2 framebufferSize() const override { return {1, 1}; }

 private:
  OSMesaContext context_ = nullptr;
  std::array<std::uint32_t, 4> pixel_{};  // the client buffer that OSMesa requires; nothing is drawn into it
};

}  // namespace

std::unique_ptr<Host> createOsmesaHost(const HostOptions&) { return std::make_unique<OsmesaHost>(); }

}  // namespace detail
}  // namespace lucerna

#else

namespace lucerna {

bool osmesaAvailable() { return false; }

std::unique_ptr<Host> detail::createOsmesaHost(const HostOptions&) {
  throwMissingCapability(
      "host osmesa: this program was built without OSMesa (Debian package libosmesa6-dev); try --host egl");
}

}  // namespace lucerna

#endif
