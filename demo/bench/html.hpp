// A report as one self-contained HTML page: text, tables, pictures and plots, all inside the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna::demo::bench {

std::string escapeHtml(std::string_view text);

class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}

  /// A section, listed in the index at the top.
  void section(const std::string& title);
  void heading(const std::string& title);
  void paragraph(const std::string& text);
  /// Cells are text; a row whose `marked` is true stands out.
  struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::vector<bool> marked;
  };
  void table(const Table& table);
  /// A PNG of the folder, with a caption; pictures in one group stand side by side.
  struct Picture {
    std::filesystem::path png;
    std::string caption;
  };
  void pictures(const std::vector<Picture>& pictures);
  void svg(const std::filesystem::path& file);
  void preformatted(const std::string& text);
  /// What another page holds, without its title and index.
  void append(const HtmlPage& other);

  std::string text() const;

 private:
  std::string title_, body_;
  std::vector<std::pair<std::string, std::string>> index_;  // anchor, title
  int anchors_ = 0;
};

}  // namespace lucerna::demo::bench
