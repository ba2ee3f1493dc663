#include "shared/contact_sheet.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>
#include <string_view>

namespace lucerna::demo::bench {

namespace {

constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kAdvance = 6, kLine = 10;

/// Rows from the top, five bits each, leftmost bit highest.
struct Glyph {
  char character;
  std::array<std::uint8_t, kGlyphHeight> rows;
};

constexpr Glyph kGlyphs[] = {
    {'A', {0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11}}, {'B', {0x1e, 0x11, 0x11, 0x1e, 0x11, 0x11, 0x1e}},
    {'C', {0x0e, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0e}}, {'D', {0x1e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1e}},
    {'E', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f}}, {'F', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10}},
    {'G', {0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f}}, {'H', {0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11}},
    {'I', {0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e}}, {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11}}, {'L', {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f}},
    {'M', {0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11}}, {'N', {0x11, 0x19, 0x15, 0x15, 0x13, 0x11, 0x11}},
    {'O', {0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'P', {0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10}},
    {'Q', {0x0e, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0d}}, {'R', {0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11}},
    {'S', {0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e}}, {'T', {0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04}},
    {'U', {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'V', {0x11, 0x11, 0x11, 0x11, 0x11, 0x0a, 0x04}},
    {'W', {0x11, 0x11, 0x11, 0x15, 0x15, 0x1b, 0x11}}, {'X', {0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11}},
    {'Y', {0x11, 0x11, 0x0a, 0x04, 0x04, 0x04, 0x04}}, {'Z', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f}},
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}, {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f}}, {'3', {0x0e, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}, {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}}, {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}, {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}}, {',', {0x00, 0x00, 0x00, 0x00, 0x0c, 0x04, 0x08}},
    {':', {0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x0c, 0x00}}, {';', {0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x04, 0x08}},
    {'^', {0x04, 0x0a, 0x11, 0x00, 0x00, 0x00, 0x00}}, {'(', {0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02}},
    {')', {0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08}}, {'-', {0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00}},
    {'+', {0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00}}, {'=', {0x00, 0x00, 0x1f, 0x00, 0x1f, 0x00, 0x00}},
    {'/', {0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10}}, {'_', {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1f}},
    {'%', {0x19, 0x19, 0x02, 0x04, 0x08, 0x13, 0x13}}, {' ', {}},
};
constexpr Glyph kUnknown{'?', {0x0e, 0x11, 0x01, 0x06, 0x04, 0x00, 0x04}};

const Glyph& glyphOf(char character) {
  const char capital = static_cast<char>(std::toupper(static_cast<unsigned char>(character)));
  const auto* found =
      std::find_if(std::begin(kGlyphs), std::end(kGlyphs), [&](const Glyph& g) { return g.character == capital; });
  return found == std::end(kGlyphs) ? kUnknown : *found;
}

/// Breaks text between words into lines of at most `columns` characters; cuts longer words.
std::vector<std::string> wrap(std::string_view text, int columns) {
  const auto most = static_cast<std::size_t>(std::max(columns, 1));
  std::vector<std::string> lines;
  while (!text.empty()) {
    std::size_t length = std::min(most, text.size());
    if (length < text.size()) {
      const std::size_t space = text.substr(0, length + 1).rfind(' ');
      if (space != std::string_view::npos && space > 0) length = space;
    }
    lines.emplace_back(text.substr(0, length));
    text.remove_prefix(length);
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  }
  return lines;
}

void fill(Bitmap& target, int left, int top, int width, int height, std::array<std::uint8_t, 3> color) {
  for (int y = std::max(top, 0); y < std::min(top + height, target.height); ++y)
    for (int x = std::max(left, 0); x < std::min(left + width, target.width); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        target.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(target.width) +
                         static_cast<std::size_t>(x)) +
                    c] = color[c];
}

void write(Bitmap& target, int left, int top, int scale, const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const Glyph& glyph = glyphOf(text[i]);
    for (int y = 0; y < kGlyphHeight; ++y)
      for (int x = 0; x < kGlyphWidth; ++x)
        if (glyph.rows[static_cast<std::size_t>(y)] >> (kGlyphWidth - 1 - x) & 1)
          fill(target, left + (static_cast<int>(i) * kAdvance + x) * scale, top + y * scale, scale, scale,
               {236, 236, 232});
  }
}

void copy(Bitmap& target, int left, int top, const Bitmap& source) {
  for (int y = 0; y < source.height; ++y)
    std::copy_n(source.rgba.begin() + 4 * static_cast<std::ptrdiff_t>(y) * source.width, 4 * source.width,
                target.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(top + y) * target.width + left));
}

}  // namespace

Bitmap contactSheet(const std::string& title, const std::vector<Tile>& tiles, int columns) {
  CHECK(!tiles.empty() && columns > 0, "{} tiles, {} columns", tiles.size(), columns);
  const int width = tiles[0].picture.width, height = tiles[0].picture.height;
  const int scale = width >= 400 ? 2 : 1, margin = 6 * scale;
  const int across = columns * (width + margin) + margin;
  const auto linesOf = [&](const std::string& text, int pixels) {
    return wrap(text, (pixels + scale) / (kAdvance * scale));
  };
  const auto rows = (tiles.size() + static_cast<std::size_t>(columns) - 1) / static_cast<std::size_t>(columns);
  const std::vector<std::string> titleLines = linesOf(title, across - 2 * margin);
  std::vector<int> labelHeights(rows, 0);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    CHECK(tiles[i].picture.width == width && tiles[i].picture.height == height, "tile {} is {}x{}", i,
          tiles[i].picture.width, tiles[i].picture.height);
    int& most = labelHeights[i / static_cast<std::size_t>(columns)];
    most = std::max(most, static_cast<int>(linesOf(tiles[i].label, width).size()) * kLine * scale);
  }
  Bitmap sheet;
  sheet.width = across;
  sheet.height = margin + static_cast<int>(titleLines.size()) * kLine * scale;
  for (int labelHeight : labelHeights) sheet.height += margin + labelHeight + height;
  sheet.height += margin;
  sheet.rgba.assign(4 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 255);
  fill(sheet, 0, 0, sheet.width, sheet.height, {28, 28, 30});

  int top = margin;
  for (const std::string& line : titleLines) {
    write(sheet, margin, top, scale, line);
    top += kLine * scale;
  }
  for (std::size_t row = 0; row < rows; ++row) {
    top += margin;
    for (int column = 0; column < columns; ++column) {
      const std::size_t i = row * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
      if (i >= tiles.size()) break;
      const int left = margin + column * (width + margin);
      int textTop = top;
      for (const std::string& line : linesOf(tiles[i].label, width)) {
        write(sheet, left, textTop, scale, line);
        textTop += kLine * scale;
      }
      copy(sheet, left, top + labelHeights[row], tiles[i].picture);
    }
    top += labelHeights[row] + height;
  }
  return sheet;
}

Bitmap barChart(glm::ivec2 size, const std::vector<std::string>& parts, const std::vector<Bar>& bars,
                const std::string& unit) {
  CHECK(!bars.empty() && !parts.empty(), "{} bars of {} parts", bars.size(), parts.size());
  constexpr std::array<std::array<std::uint8_t, 3>, 3> kColors{{{96, 150, 210}, {222, 150, 70}, {120, 180, 110}}};
  Bitmap chart;
  chart.width = size.x, chart.height = size.y;
  chart.rgba.assign(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 255);
  fill(chart, 0, 0, size.x, size.y, {28, 28, 30});
  const int scale = size.x >= 400 ? 2 : 1, line = kLine * scale;
  const auto widthOf = [&](const std::string& text) { return kAdvance * scale * static_cast<int>(text.size()); };
  int left = line;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    fill(chart, left, line / 2, line - 2 * scale, line - 2 * scale, kColors[i % kColors.size()]);
    write(chart, left + line, line / 2, scale, parts[i]);
    left += 2 * line + widthOf(parts[i]);
  }
  double most = 0.0;
  const auto sumOf = [](const Bar& bar) { return std::accumulate(bar.parts.begin(), bar.parts.end(), 0.0); };
  for (const Bar& bar : bars) most = std::max(most, sumOf(bar));
  const int top = 2 * line, step = (size.y - top) / static_cast<int>(bars.size()),
            room = std::max(size.x - 2 * line - widthOf("0000.00 " + unit), 1);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const int y = top + static_cast<int>(i) * step;
    write(chart, line, y, scale, bars[i].label);
    double sum = 0.0;
    int from = 0;
    for (std::size_t k = 0; k < bars[i].parts.size(); ++k) {
      sum += bars[i].parts[k];
      const int to = most > 0.0 ? static_cast<int>(std::lround(sum / most * room)) : 0;
      fill(chart, line + from, y + line, to - from, std::max(step - line - 3 * scale, 1), kColors[k % kColors.size()]);
      from = to;
    }
    write(chart, line + from + 4 * scale, y + line, scale, fmt::format("{:.4g} {}", sum, unit));
  }
  return chart;
}

}  // namespace lucerna::demo::bench
