// The three hosts' factories and their shared loader. Private to engine/host.
#pragma once

#include "host/gl_procs.hpp"
#include "host/host.hpp"

namespace lucerna::detail {

using GlProcLoader = GlProc (*)(const char* name);

/// Sets the current host's loader, to which the GL 1.x entry points and glXGetProcAddressARB forward. `inWindow`:
/// whether names that begin with glX may be resolved.
void setGlLoader(GlProcLoader loader, bool inWindow);

/// LUCERNA_EGL_DEVICE, if set and not empty.
std::optional<std::string> chosenEglDevice();

std::unique_ptr<Host> createWindowHost(const HostOptions& options);
std::unique_ptr<Host> createEglHost(const HostOptions& options);
std::unique_ptr<Host> createOsmesaHost(const HostOptions& options);

}  // namespace lucerna::detail
