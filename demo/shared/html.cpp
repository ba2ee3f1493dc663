#include "shared/html.hpp"

#include "base/data.hpp"
#include "base/files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna::demo::bench {

namespace {

constexpr std::string_view kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1e; background: #fff; max-width: 1900px; margin: 2em auto;
  padding: 0 1.5em; }
h1 { font-size: 1.7em; margin-bottom: .2em; } h2 { margin-top: 2.2em; border-bottom: 2px solid #ddd;
  padding-bottom: .2em; } h3 { margin-top: 1.6em; }
nav { background: #f5f5f7; padding: .6em 1.2em; border-radius: 6px; } nav a { margin-right: 1.4em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 11.5px; font-variant-numeric: tabular-nums; margin: .8em 0; }
th, td { padding: .22em .4em; border-bottom: 1px solid #e4e4e8; text-align: right; white-space: nowrap; }
th { background: #f5f5f7; position: sticky; top: 0; } th:first-child, td:first-child { text-align: left; }
td.text, th.text { text-align: left; } tr.marked { background: #fff6d6; font-weight: 600; }
figure { display: inline-block; margin: .4em .8em .8em 0; vertical-align: top; } figcaption { font-size: 12px;
  color: #555; max-width: 340px; }
figure img { width: 340px; image-rendering: pixelated; border: 1px solid #ccc; }
pre { background: #f5f5f7; padding: .8em; overflow-x: auto; font-size: 12px; } .plot svg { max-width: 100%;
  height: auto; }
)";

bool isNumber(const std::string& text) {
  return !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '-' || text[0] == '+' ||
                           text[0] == '<' || text[0] == '>');
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

std::string escapeHtml(std::string_view text) {
  std::string result;
  for (char c : text) switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  return result;
}

void HtmlPage::section(const std::string& title) {
  const std::string anchor = fmt::format("s{}", ++anchors_);
  index_.emplace_back(anchor, title);
  body_ += fmt::format("<h2 id=\"{}\">{}</h2>\n", anchor, escapeHtml(title));
}

void HtmlPage::heading(const std::string& title) { body_ += fmt::format("<h3>{}</h3>\n", escapeHtml(title)); }
void HtmlPage::paragraph(const std::string& text) { body_ += fmt::format("<p>{}</p>\n", escapeHtml(text)); }
void HtmlPage::preformatted(const std::string& text) {
  body_ += fmt::format("<pre tabindex=\"0\">{}</pre>\n", escapeHtml(text));
}

void HtmlPage::table(const Table& table) {
  // Columns of numbers are right-aligned; a column with words is left-aligned, whatever its cells begin with.
  std::vector<bool> words(table.columns.size(), false);
  for (const auto& row : table.rows)
    for (std::size_t c = 0; c < row.size() && c < words.size(); ++c)
      words[c] = words[c] || (!row[c].empty() && !isNumber(row[c]));
  const auto cell = [&](const char* tag, std::size_t column, const std::string& text) {
    body_ += fmt::format("<{0}{1}>{2}</{0}>", tag, column < words.size() && words[column] ? " class=\"text\"" : "",
                         escapeHtml(text));
  };
  // Keyboard users scroll the element with the focus.
  body_ += "<div class=\"scroll\" tabindex=\"0\"><table><tr>";
  for (std::size_t c = 0; c < table.columns.size(); ++c) cell("th", c, table.columns[c]);
  body_ += "</tr>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    body_ += r < table.marked.size() && table.marked[r] ? "<tr class=\"marked\">" : "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) cell("td", c, table.rows[r][c]);
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void HtmlPage::pictures(const std::vector<Picture>& pictures) {
  body_ += "<div>\n";
  for (const Picture& picture : pictures)
    body_ += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
        escapeHtml(picture.caption), base64(readFileBytes(picture.png)));
  body_ += "</div>\n";
}

void HtmlPage::svg(const std::filesystem::path& file) {
  std::string text = readFileText(file);
  if (const auto start = text.find("<svg"); start != std::string::npos)
    text.erase(0, start);  // no XML header inside HTML
  body_ += "<div class=\"plot\">\n" + text + "</div>\n";
}

void HtmlPage::svgWithoutScripts(const std::filesystem::path& file) {
  body_ += "<noscript>\n";
  svg(file);
  body_ += "</noscript>\n";
}

void HtmlPage::figure(const std::string& html) {
  body_ += html;
  hasFigure_ = true;
}

void HtmlPage::append(const HtmlPage& other) {
  hasFigure_ = hasFigure_ || other.hasFigure_;
  // Prefix the other page's anchors to keep them unique.
  std::string body = other.body_;
  const std::string prefix = fmt::format("p{}-", ++anchors_);
  for (const auto& [anchor, title] : other.index_) {
    const std::string from = "id=\"" + anchor + "\"";
    if (const auto at = body.find(from); at != std::string::npos)
      body.replace(at, from.size(), "id=\"" + prefix + anchor + "\"");
    index_.emplace_back(prefix + anchor, title);
  }
  body_ += body;
}

std::string HtmlPage::text() const {
  std::string index;
  if (index_.size() > 1) {
    index = "<nav>";
    for (const auto& [anchor, title] : index_)
      index += fmt::format("<a href=\"#{}\">{}</a>", anchor, escapeHtml(title));
    index += "</nav>\n";
  }
  std::string style(kStyle), script;
  if (hasFigure_) {
    style += readFileText(dataFolder() / "assets/report/figure.css");
    script = "<script>\n" + readFileText(dataFolder() / "assets/report/figure.js") + "</script>\n";
  }
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>";
  for (const std::string& part :
       {escapeHtml(title_), std::string("</title><style>"), style, std::string("</style></head>\n<body><h1>"),
        escapeHtml(title_), std::string("</h1>\n"), index, body_, script, std::string("</body></html>\n")})
    page += part;
  return page;
}

}  // namespace lucerna::demo::bench
