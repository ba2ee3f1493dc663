// The three hosts' factories and their shared loader. Private to engine/host.
#pragma once

#include "host/host.hpp"

namespace lucerna::detail {

using GlProc = void (*)();
using GlProcLoader = GlProc (*)(const char* name);

/// The current host's loader; the GL 1.x entry points and glXGetProcAddressARB forward to it. `inWindow`: whether names
/// that begin with glX may be answered.
void setGlLoader(GlProcLoader loader, bool inWindow);

/// LUCERNA_EGL_DEVICE, where it is set and not empty.
std::optional<std::string> chosenEglDevice();

std::unique_ptr<Host> createWindowHost(const HostOptions& options);
std::unique_ptr<Host> createEglHost(const HostOptions& options);
std::unique_ptr<Host> createOsmesaHost(const HostOptions& options);

}  // namespace lucerna::detail
