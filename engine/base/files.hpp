// Reads and writes whole files (no GL).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Throws the error for a file that could not be opened for reading, by errno: too few descriptors or too little memory
/// is a missing capability, everything else (missing, no permission) is bad input.
[[noreturn]] void throwCannotOpen(const std::filesystem::path& file, int reason);

/// The bytes of a file. Throws Error(badInput) naming the file when it is missing, a folder or unreadable.
std::vector<std::uint8_t> readFileBytes(const std::filesystem::path& file);

/// The same as text.
std::string readFileText(const std::filesystem::path& file);

/// A text as UTF-8, whatever its byte order mark says: UTF-8 or UTF-16; without one as it is. Throws Error(badInput)
/// naming the file if it holds bytes 0 then: it is no text.
std::string textOf(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Writes a file completely or not at all: into a temporary file in the same folder, which is then renamed. Temporary
/// files left by killed processes in that folder are removed first. On failure (no such folder, no permission, disk
/// full) nothing new is left behind, an older file of that name is unchanged, and Error(badInput) names the file and
/// the reason.
void writeFileAtomically(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void writeFileAtomically(const std::filesystem::path& file, std::string_view text);

/// The same for checkpoints: on return both content and name are on disk (fsync), not only in the page cache.
void writeFileDurably(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Throws the error that writing the file would throw now (no such folder, a folder of that name, no permission),
/// without writing anything: lets commands fail before hours of work.
void checkWritable(const std::filesystem::path& file);

/// The extension in lower case with its dot, such as ".png"; empty if there is none.
std::string lowerExtension(const std::filesystem::path& file);

}  // namespace lucerna
