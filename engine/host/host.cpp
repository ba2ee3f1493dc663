#include "host/host.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "host/api.hpp"
#include "host/host_backends.hpp"

#include <cstdlib>

namespace lucerna {

namespace {

// glewInit returns 3 or 4 without GLX although the pointers are valid, so the pointers decide.
void loadPointers(HostKind kind) {
  glewExperimental = GL_TRUE;
  glewInit();
  for (int i = 0; glGetError() != GL_NO_ERROR && i < 16; ++i) {}  // a lost context has errors forever
  const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor < 43)
    throwMissingCapability("host {}: OpenGL 4.3 is required, the driver provides {}", nameOf(kind),
                           version ? version : "nothing");
  if (!glDispatchCompute || !glTexStorage3D || !glObjectLabel)
    throwMissingCapability("host {}: the driver says OpenGL {} but lacks entry points of 4.3", nameOf(kind), version);
}

}  // namespace

bool displayAvailable() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value && *value;
  };
  return set("DISPLAY") || set("WAYLAND_DISPLAY");
}

bool Host::isSoftwareRenderer(std::string_view renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
    if (renderer.find(name) != std::string_view::npos) return true;
  return false;
}

std::unique_ptr<Host> Host::create(HostKind kind, const HostOptions& options) {
  // Works around two bugs of Mesa's zink, seen in 25.0 over a software Vulkan (docs/drivers.md); values already set in
  // the environment are kept. It compiles uniforms that branches depend on into the shader and runs a dispatch with
  // another's value (GlPasses.AUniformThatBranchesDependOnIsThatOfItsDispatch). And with descriptor buffers the first
  // light propagation volume of a process reads wrong data (LpvBounces.AgainstTheReference).
  ::setenv("ZINK_INLINE_UNIFORMS", "0", 0);
  ::setenv("ZINK_DESCRIPTORS", "lazy", 0);
  std::unique_ptr<Host> host;
  switch (kind) {
    case HostKind::window: host = detail::createWindowHost(options); break;
    case HostKind::egl: host = detail::createEglHost(options); break;
    case HostKind::osmesa: host = detail::createOsmesaHost(options); break;
  }
  loadPointers(kind);
  return host;
}

std::unique_ptr<Host> Host::createDefault(bool wantsWindow, const HostOptions& options) {
  if (wantsWindow && displayAvailable()) {
    try {
      return create(HostKind::window, options);
    } catch (const Error& error) { logWarning("{}; continuing without a window", error.what()); }
  }
  if (detail::chosenEglDevice()) return create(HostKind::egl, options);
  std::unique_ptr<Host> egl;
  std::string reason;
  try {
    egl = create(HostKind::egl, options);
  } catch (const Error& error) {
    reason = error.what();
    logVerbose("{}", reason);
  }
  if (egl && !isSoftwareRenderer(reinterpret_cast<const char*>(glGetString(GL_RENDERER)))) return egl;
  if (egl && !osmesaAvailable()) return egl;
  egl.reset();  // one host at a time
  try {
    return create(HostKind::osmesa, options);
  } catch (const Error& error) {
    throwMissingCapability("no OpenGL without a window: {}; {}", reason.empty() ? "host egl: software alone" : reason,
                           error.what());
  }
}

}  // namespace lucerna
