// A report as one self-contained HTML page: text, tables, pictures and plots, all inside the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna::demo::bench {

std::string escapeHtml(std::string_view text);
std::string base64(std::span<const std::uint8_t> bytes);
/// Maximum size of a page with figures, bytes; its pictures get three quarters.
inline constexpr std::size_t kPageLimit = 20'000'000, kPageBytes = 14'000'000;

class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}

  /// A section, listed in the index at the top.
  void section(const std::string& title);
  void heading(const std::string& title);
  void paragraph(const std::string& text);
  /// Cells are text; a row with `marked` set is highlighted.
  struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::vector<bool> marked;
  };
  void table(const Table& table);
  /// A PNG of the folder, with a caption; pictures of one group are placed side by side.
  struct Picture {
    std::filesystem::path png;
    std::string caption;
  };
  void pictures(const std::vector<Picture>& pictures);
  void svg(const std::filesystem::path& file);
  /// An SVG that a figure displays better, for browsers without scripts.
  void svgWithoutScripts(const std::filesystem::path& file);
  /// An interactive figure (figure.hpp); its script and style are included in the page once.
  void figure(const std::string& html);
  void preformatted(const std::string& text);
  /// The content of another page, without its title and index.
  void append(const HtmlPage& other);

  std::string text() const;

 private:
  std::string title_, body_;
  std::vector<std::pair<std::string, std::string>> index_;  // anchor, title
  int anchors_ = 0;
  bool hasFigure_ = false;
};

}  // namespace lucerna::demo::bench
