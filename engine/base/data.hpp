// Finds the program's own data: shaders, scenes and camera paths (no GL).
#pragma once

#include <filesystem>
#include <optional>

namespace lucerna {

/// The folder with shaders/, assets/ and keyFrames/, symbolic links resolved; empty if there is none. Searched in this
/// order:
/// 1. LUCERNA_DATA in the environment. Throws Error(badInput) if that folder lacks one of the three.
/// 2. Relative to the executable: share/lucerna beside it (a build tree, which links to the source tree there), then
///    ../share/lucerna (an installed prefix, wherever it was moved). Symbolic links to the executable are followed.
/// 3. lucerna in the folders of XDG_DATA_DIRS, by default /usr/local/share and /usr/share: programs that use the
/// library of an
///    installed package from elsewhere [XDG Base Directory Specification 0.8].
std::optional<std::filesystem::path> findDataFolder();

/// The same; throws Error(missingCapability) listing every place searched.
std::filesystem::path dataFolder();

}  // namespace lucerna
