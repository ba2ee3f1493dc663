#include "walk/shots.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

// [PNG, ISO 15948, annex D]
std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1u ? 0xedb88320u ^ crc >> 1 : crc >> 1;
  }
  return ~crc;
}

void append(std::vector<std::uint8_t>& bytes, std::uint32_t bigEndian) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(bigEndian >> shift));
}

/// Writes a file next to its final place by `write`, edits its bytes by `change`, then moves it there.
template <class Write, class Change>
void writeChanged(const fs::path& file, Write write, Change change) {
  fs::path draft = file;
  draft.replace_filename(".draft_" + file.filename().string());
  write(draft);
  std::vector<std::uint8_t> bytes = readFileBytes(draft);
  fs::remove(draft);
  change(bytes);
  writeFileAtomically(file, bytes);
}

}  // namespace

void writePngWithNote(const fs::path& file, const Bitmap& bitmap, const std::string& note) {
  writeChanged(
      file, [&](const fs::path& draft) { writePng(draft, bitmap); },
      [&](std::vector<std::uint8_t>& bytes) {
        constexpr std::size_t kHeaderEnd = 8 + 25;  // signature and IHDR, which must come first
        std::vector<std::uint8_t> body{'t', 'E', 'X', 't'}, chunk;
        const std::string text = std::string("Comment") + '\0' + note;
        body.insert(body.end(), text.begin(), text.end());
        append(chunk, static_cast<std::uint32_t>(text.size()));
        chunk.insert(chunk.end(), body.begin(), body.end());
        append(chunk, crc32(body));
        bytes.insert(bytes.begin() + kHeaderEnd, chunk.begin(), chunk.end());
      });
}

void writeHdrWithNote(const fs::path& file, const Image& image, const std::string& note) {
  writeChanged(
      file, [&](const fs::path& draft) { writeImage(draft, image); },
      [&](std::vector<std::uint8_t>& bytes) {
        const auto firstLine = std::find(bytes.begin(), bytes.end(), '\n');
        CHECK(firstLine != bytes.end(), "{} bytes without a line", bytes.size());
        std::string lines = "# ";
        for (const char c : note) lines += c == '\n' ? std::string("\n# ") : std::string(1, c);
        lines += '\n';
        bytes.insert(firstLine + 1, lines.begin(), lines.end());
      });
}

fs::path freeName(const fs::path& folder, const std::string& name, const std::vector<std::string>& extensions) {
  for (int number = 1;; ++number) {
    const fs::path stem = folder / fmt::format("{}_{:04}", name, number);
    if (std::ranges::none_of(extensions, [&](const std::string& e) { return fs::exists(stem.string() + e); }))
      return stem;
  }
}

std::string textOf(const KeyFrame& key) {
  const auto vector = [](char word, const glm::dvec3& v) {
    return fmt::format("{} {:.7g} {:.7g} {:.7g}", word, v.x, v.y, v.z);
  };
  std::string line = vector('p', key.position) + "  " + vector('d', key.direction) + "  " + vector('u', key.up);
  if (key.verticalFov) line += fmt::format("  f {:.6g}", glm::degrees(*key.verticalFov));
  return line;
}

std::string textOfKeyFrames(const std::vector<KeyFrame>& keys, const std::string& comment) {
  std::string text = fmt::format(
      "# {}\n# p position, d viewing direction, u up, f vertical field of view in degrees. The format: "
      "engine/scene/key_frames.hpp.\n\n",
      comment);
  for (const KeyFrame& key : keys) text += textOf(key) + "\n";
  return text;
}

}  // namespace lucerna::demo
