// Files written by the window: screenshots with embedded settings, and camera paths (no GL).
#pragma once

#include "base/image.hpp"
#include "scene/key_frames.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace lucerna::demo {

/// PNG with a text chunk of keyword "Comment" [PNG, ISO 15948, 11.3.4.3], in Latin-1. Written atomically.
void writePngWithNote(const std::filesystem::path& file, const Bitmap& bitmap, const std::string& note);
/// Radiance HDR with the note as header lines that begin with '#' [Ward, RADIANCE picture format]. Written atomically.
void writeHdrWithNote(const std::filesystem::path& file, const Image& image, const std::string& note);

/// FOLDER/NAME_0001, with the first number that is free for all of the extensions.
std::filesystem::path freeName(const std::filesystem::path& folder, const std::string& name,
                               const std::vector<std::string>& extensions = {".png", ".hdr"});

/// The text of a key frame file (scene/key_frames.hpp), readable by readKeyFrames().
std::string textOfKeyFrames(const std::vector<KeyFrame>& keys, const std::string& comment);
/// A key frame as one line of such a file.
std::string textOf(const KeyFrame& key);

}  // namespace lucerna::demo
