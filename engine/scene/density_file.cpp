#include "scene/density_file.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <sstream>
#include <string>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

using Bytes = std::span<const std::uint8_t>;

/// Little endian on every machine.
std::uint64_t unsignedAt(Bytes bytes, std::size_t offset, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{bytes[offset + i]} << (8 * i);
  return value;
}

/// Value format and position in the file.
struct Layout {
  glm::ivec3 size{0};
  std::size_t bytesPerValue = 0;  ///< 1: uint8, 2: uint16, 4: float
  std::size_t offset = 0;  ///< of the first value
};

void checkSize(const fs::path& file, const std::array<std::int64_t, 3>& size) {
  std::uint64_t cells = 1;
  for (const std::int64_t s : size) {
    if (s < 1 || s > 65536)
      throwBadInput("{}: a density grid of {}x{}x{} cells, expected 1 or more each way", file.string(), size[0],
                    size[1], size[2]);
    cells *= static_cast<std::uint64_t>(s);
  }
  if (cells > kMaxDensityCells)
    throwBadInput("{}: a density grid of {}x{}x{} cells, at most {} in all are supported", file.string(), size[0],
                  size[1], size[2], kMaxDensityCells);
}

glm::ivec3 toGlm(const std::array<std::int64_t, 3>& size) {
  return {static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2])};
}

std::size_t cellsOf(const glm::ivec3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

DensityGrid readValues(const fs::path& file, Bytes bytes, const Layout& layout) {
  const std::size_t cells = cellsOf(layout.size);
  const std::size_t wanted = cells * layout.bytesPerValue;
  if (bytes.size() - layout.offset < wanted)
    throwBadInput("{}: {} bytes of density, {}x{}x{} cells of {} bytes need {}; is the file truncated?", file.string(),
                  bytes.size() - layout.offset, layout.size.x, layout.size.y, layout.size.z, layout.bytesPerValue,
                  wanted);
  DensityGrid grid;
  grid.size = layout.size;
  grid.density.resize(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    const std::uint64_t bits = unsignedAt(bytes, layout.offset + i * layout.bytesPerValue, layout.bytesPerValue);
    float value = 0.0f;
    if (layout.bytesPerValue == 4) {
      const auto word = static_cast<std::uint32_t>(bits);
      std::memcpy(&value, &word, sizeof value);
    } else {
      value = static_cast<float>(bits) / (layout.bytesPerValue == 1 ? 255.0f : 65535.0f);
    }
    if (!(value >= 0.0f) || !std::isfinite(value))
      throwBadInput("{}: density {} in cell {}, expected finite values, 0 or more", file.string(), value, i);
    grid.density[i] = value;
  }
  return grid;
}

Layout nrrdLayout(const fs::path& file, Bytes bytes) {
  Layout layout;
  std::size_t at = 0;
  const auto nextLine = [&](std::string& line) {
    line.clear();
    for (; at < bytes.size() && bytes[at] != '\n' && line.size() < 4096; ++at)
      line.push_back(static_cast<char>(bytes[at]));
    if (at >= bytes.size() || bytes[at] != '\n') return false;
    ++at;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  };
  std::string line;
  if (!nextLine(line) || line.rfind("NRRD000", 0) != 0)
    throwBadInput("{}: not a NRRD file: its first line is not NRRD000x", file.string());
  bool hasSizes = false, hasEnd = false;
  std::string type, encoding, endian, dimension;
  while (nextLine(line)) {
    if (line.empty()) {
      hasEnd = true;
      break;
    }
    const std::size_t colon = line.find(": ");
    if (line[0] == '#' || colon == std::string::npos) continue;  // a comment, or a user-defined key:=value
    const std::string field = line.substr(0, colon), value = line.substr(colon + 2);
    if (field == "type") type = value;
    if (field == "encoding") encoding = value;
    if (field == "endian") endian = value;
    if (field == "dimension") dimension = value;
    if (field == "data file" || field == "datafile")
      throwBadInput("{}: its data are in another file ({}), expected header and data in one", file.string(), value);
    if (field == "sizes") {
      std::istringstream stream(value);
      std::array<std::int64_t, 3> size{};
      std::string more;
      if (!(stream >> size[0] >> size[1] >> size[2]) || stream >> more)
        throwBadInput("{}: \"sizes: {}\", expected three whole numbers", file.string(), value);
      checkSize(file, size);
      layout.size = toGlm(size);
      hasSizes = true;
    }
  }
  if (!hasEnd) throwBadInput("{}: the NRRD header has no end (an empty line); is the file truncated?", file.string());
  if (dimension != "3" || !hasSizes)
    throwBadInput("{}: expected \"dimension: 3\" and \"sizes\" of three numbers", file.string());
  if (encoding != "raw") throwBadInput("{}: \"encoding: {}\", expected raw", file.string(), encoding);
  if (type == "uint8" || type == "unsigned char" || type == "uchar" || type == "uint8_t") layout.bytesPerValue = 1;
  else if (type == "uint16" || type == "unsigned short" || type == "ushort" || type == "uint16_t")
    layout.bytesPerValue = 2;
  else if (type == "float") layout.bytesPerValue = 4;
  else throwBadInput("{}: \"type: {}\", expected uint8, uint16 or float", file.string(), type);
  if (layout.bytesPerValue > 1 && endian != "little")
    throwBadInput("{}: \"endian: {}\", expected little", file.string(), endian);
  layout.offset = at;
  return layout;
}

/// [KTX2]: 12 bytes of identifier, nine 32-bit words of header, index; the first level's offset and length stand at 80.
Layout ktx2Layout(const fs::path& file, Bytes bytes) {
  constexpr std::uint8_t kIdentifier[12] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
  constexpr std::size_t kHeader = 104;
  if (bytes.size() < kHeader || std::memcmp(bytes.data(), kIdentifier, sizeof kIdentifier) != 0)
    throwBadInput("{}: not a KTX 2 file", file.string());
  const auto word = [&](std::size_t index) { return unsignedAt(bytes, 12 + 4 * index, 4); };
  Layout layout;
  switch (word(0)) {  // VkFormat
    case 9: layout.bytesPerValue = 1; break;
    case 70: layout.bytesPerValue = 2; break;
    case 100: layout.bytesPerValue = 4; break;
    default:
      throwBadInput("{}: vkFormat {}, expected R8_UNORM (9), R16_UNORM (70) or R32_SFLOAT (100)", file.string(),
                    word(0));
  }
  const std::array<std::int64_t, 3> size = {static_cast<std::int64_t>(word(2)), static_cast<std::int64_t>(word(3)),
                                            static_cast<std::int64_t>(word(4))};
  if (word(5) > 1 || word(6) != 1 || word(7) != 1 || word(8) != 0)
    throwBadInput("{}: {} layers, {} faces, {} levels, supercompression {}; expected a single uncompressed 3D picture",
                  file.string(), word(5), word(6), word(7), word(8));
  checkSize(file, size);
  layout.size = toGlm(size);
  const std::uint64_t offset = unsignedAt(bytes, 80, 8);
  if (offset > bytes.size())
    throwBadInput("{}: its data should begin at byte {} of {}; is the file truncated?", file.string(), offset,
                  bytes.size());
  layout.offset = static_cast<std::size_t>(offset);
  return layout;
}

Layout rawLayout(const fs::path& file, Bytes bytes, const std::optional<glm::ivec3>& size) {
  if (!size) throwBadInput("{}: a .raw density grid has no size; give \"size\" in the scene", file.string());
  checkSize(file, {size->x, size->y, size->z});
  Layout layout;
  layout.size = *size;
  const std::size_t cells = cellsOf(*size);
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
    if (bytes.size() == count * cells) layout.bytesPerValue = count;
  if (layout.bytesPerValue == 0)
    throwBadInput("{}: {} bytes, {}x{}x{} cells need {}, {} or {} (1, 2 or 4 bytes a value)", file.string(),
                  bytes.size(), size->x, size->y, size->z, cells, 2 * cells, 4 * cells);
  return layout;
}

}  // namespace

DensityGrid readDensityGrid(const fs::path& file, std::optional<glm::ivec3> size) {
  const std::string extension = lowerExtension(file);
  if (extension != ".nrrd" && extension != ".ktx2" && extension != ".raw")
    throwBadInput("{}: a density grid must be .nrrd, .ktx2 or .raw", file.string());
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  const Layout layout = extension == ".nrrd"   ? nrrdLayout(file, bytes)
                        : extension == ".ktx2" ? ktx2Layout(file, bytes)
                                               : rawLayout(file, bytes, size);
  if (size && *size != layout.size)
    throwBadInput("{}: {}x{}x{} cells, the scene says {}x{}x{}", file.string(), layout.size.x, layout.size.y,
                  layout.size.z, size->x, size->y, size->z);
  return readValues(file, bytes, layout);
}

}  // namespace lucerna
