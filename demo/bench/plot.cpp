#include "bench/plot.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/provenance.hpp"
#include "shared/shell.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lucerna::demo::bench {

namespace fs = std::filesystem;

namespace {

// Like a report's figure (assets/report/figure.js): colours that remain distinct for colour-blind readers [Okabe2008],
// marks and dashes that remain distinct in grey. A repeated colour gets another mark and other dashes.
constexpr std::size_t kRound = 8, kDashes = 3;
constexpr const char* kColours[kRound] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                          "#E69F00", "#56B4E9", "#333333", "#480060"};
// circle, square, triangles up and down, diamond, plus, cross, star
constexpr int kMarks[kRound] = {7, 5, 9, 11, 13, 1, 2, 3};

/// A double-quoted string for gnuplot. The script turns off enhanced mode, so the text is plain.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (char c : text) result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return result + "\"";
}

bool drawable(const Series::Point& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0.0 && p.y > 0.0; }

struct Range {
  double low = INFINITY, high = 0.0;
  void add(double v) { low = std::min(low, v), high = std::max(high, v); }
  /// Rounds to a 1-2-5 step, so that an axis ends on a labelled number.
  static double step(double value, bool up) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    double below = power;
    for (double s : {1.0, 2.0, 5.0, 10.0}) {
      if (up && value <= s * power * (1 + 1e-9)) return s * power;
      if (value >= s * power * (1 - 1e-9)) below = s * power;
    }
    return below;
  }
  /// Ticks at 1, 2 and 5 of every decade, for an axis of few decades; gnuplot's own for one of many.
  std::string tics(const char* axis) const {
    const double first = step(low / 1.15, false), last = step(high * 1.15, true);
    if (last / first > 1e4) return "";
    std::string list;
    for (double power = std::pow(10.0, std::floor(std::log10(first))); power <= last * 1.001; power *= 10.0)
      for (double s : {1.0, 2.0, 5.0})
        if (s * power >= first * 0.999 && s * power <= last * 1.001)
          list += fmt::format("{}{:g}", list.empty() ? "" : ", ", s * power);
    return fmt::format("set {}tics ({})\n", axis, list);
  }
  std::string text() const { return fmt::format("[{:g}:{:g}]", step(low / 1.15, false), step(high * 1.15, true)); }
};

std::string script(const std::string& stem, const LogLogPlot& plot, int& leftOut) {
  std::string data, draw;
  Range x, y;
  int block = 0;
  const auto line = [&](const std::string& what) { draw += (draw.empty() ? "plot " : ", \\\n     ") + what; };
  for (const Series& series : plot.series) {
    std::string points;
    bool labelled = false;
    for (const Series::Point& p : series.points) {
      if (!drawable(p)) {
        ++leftOut;
        continue;
      }
      points += fmt::format("{:.9g} {:.9g} {}\n", p.x, p.y, quoted(p.label));
      labelled |= !p.label.empty();
      x.add(p.x), y.add(p.y);
    }
    if (points.empty()) continue;
    const std::string name = fmt::format("$data{}", ++block);
    data += name + " << EOD\n" + points + "EOD\n";
    if (series.isFront) {
      line(fmt::format("{} using 1:2 with lines lw 7 lc rgb '#F0E2A8' title {}", name, quoted(series.name)));
      if (labelled)
        line(fmt::format("{} using 1:2:3 with labels offset 0,1 font ',11' tc rgb '#6b5500' notitle", name));
      continue;
    }
    const std::size_t round = series.style / kRound;
    line(fmt::format("{} using 1:2 with {} lw 1.5 dt {} pt {} ps {} lc rgb '{}' title {}", name,
                     series.joined ? "linespoints" : "points", series.isBefore ? 3 : 1 + round % kDashes,
                     kMarks[(series.style + 3 * round) % kRound], series.isBefore ? 0.5 : 0.9,
                     kColours[series.style % kRound], quoted(series.name)));
  }
  if (block == 0) return "";
  constexpr const char* kGreys[] = {"#000000", "#777777", "#aaaaaa"};
  int level = 0;
  for (const auto& [height, label] : plot.levels) {
    if (!std::isfinite(height) || height <= 0.0) continue;
    y.add(height);
    line(fmt::format("{:.9g} with lines dt {} lw 1.5 lc rgb '{}' title {}", height, 2 + level % 4, kGreys[level % 3],
                     quoted(label)));
    ++level;
  }
  if (plot.guideSlope != 0.0) {
    const Series& last = plot.series.back();
    const auto first = std::find_if(last.points.begin(), last.points.end(), drawable);
    if (first != last.points.end())
      line(fmt::format("{:.9g} * (x / {:.9g}) ** ({:g}) with lines dt 3 lc rgb '#333333' title {}", first->y, first->x,
                       plot.guideSlope, quoted(fmt::format("slope {:g}", plot.guideSlope))));
  }
  const std::string common = fmt::format(
      "set encoding utf8\nset title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\nset logscale "
      "xy\nset xrange {}\nset yrange {}\n"
      "set mxtics 10\nset mytics 10\nset format x '%g'\nset format y '%g'\nset grid xtics ytics back lt 1 lw 1 lc rgb "
      "'#e0e0e0'\nset border 3\nset tics nomirror out\n"
      "set key outside right top vertical Left reverse samplen 2 noenhanced\nset samples 200\n",
      quoted(plot.title), quoted(plot.xLabel), quoted(plot.yLabel), x.text(), y.text());
  return data + common + x.tics("x") + y.tics("y") +
         fmt::format("set terminal svg size 1060,560 font 'sans-serif,13' background '#ffffff'\nset output {}\n{}\n",
                     quoted(stem + ".svg"), draw) +
         fmt::format(
             "set terminal pngcairo size 1060,560 font 'sans-serif,11' background '#ffffff'\nset output {}\n{}\nset "
             "output\n",
             quoted(stem + ".png"), draw);
}

}  // namespace

bool haveGnuplot() { return std::system("command -v gnuplot >/dev/null 2>&1") == 0; }

int writeLogLogPlot(const fs::path& folder, const std::string& stem, const LogLogPlot& plot) {
  int leftOut = 0;
  const std::string text = script(stem, plot, leftOut);
  if (text.empty()) throwBadInput("{}: nothing to plot: no figure is finite and above 0", stem);
  writeFileAtomically(folder / (stem + ".gp"), text);
  if (!haveGnuplot())
    throwMissingCapability("gnuplot is missing, which draws the plots (Debian package gnuplot-nox); the script is {}",
                           (folder / (stem + ".gp")).string());
  const std::string where = shellWord(fs::absolute(folder).string());
  const std::string command = fmt::format("cd {} && gnuplot {}.gp >{}.log 2>&1", where, stem, stem);
  const int status = std::system(command.c_str());
  if (status != 0)
    throwMissingCapability("gnuplot fails on {}: see {}", (folder / (stem + ".gp")).string(),
                           (folder / (stem + ".log")).string());
  std::error_code ignored;
  fs::remove(folder / (stem + ".log"), ignored);
  return leftOut;
}

}  // namespace lucerna::demo::bench
