// Lets a layer above see or replace OpenGL's entry points as they are loaded.
#pragma once

namespace lucerna {

using GlProc = void (*)();
/// Returns what is called instead of the driver's function of that name, or that function.
using GlProcWrapper = GlProc (*)(const char* name, GlProc driver);

/// For contexts created from now on; null: none. A wrapper costs nothing where it returns the driver's function.
void wrapGlProcs(GlProcWrapper wrapper);

}  // namespace lucerna
