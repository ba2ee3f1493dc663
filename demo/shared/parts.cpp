#include "shared/parts.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kDescription = "part.json";

struct PartOf {
  std::size_t part = 0, parts = 1;
};

PartOf parsePart(const std::string& text) {
  constexpr std::size_t kMostParts = 1000000;
  const auto slash = text.find('/');
  const auto number = [&](const std::string& digits) {
    const bool isNumber =
        !digits.empty() && digits.size() <= 7 && digits.find_first_not_of("0123456789") == std::string::npos;
    return isNumber ? static_cast<std::size_t>(std::stoul(digits)) : kMostParts + 1;
  };
  const std::size_t part = number(text.substr(0, slash)),
                    parts = slash == std::string::npos ? 0 : number(text.substr(slash + 1));
  if (part >= parts || parts > kMostParts)
    throwBadInput("--part {}: expected K/N, whole numbers, K from 0 and below N, N at most {}", text, kMostParts);
  return {part, parts};
}

Json readDescription(const fs::path& folder) {
  const fs::path file = folder / kDescription;
  const Json json = Json::parse(readFileText(file), nullptr, false);
  const auto isNumber = [&](const char* key) { return json.contains(key) && json.at(key).is_number_unsigned(); };
  const auto isText = [&](const char* key) { return json.contains(key) && json.at(key).is_string(); };
  if (!json.is_object() || json.value("lucerna_part", 0) != 1 || !isText("command") || !isText("identity") ||
      !isNumber("units") || !isNumber("first") || !isNumber("last") || !json.contains("done") ||
      !json.at("done").is_boolean() || json.at("last") > json.at("units") || json.at("first") > json.at("last"))
    throwBadInput("{}: not a part made by --part, or a damaged one", file.string());
  return json;
}

}  // namespace

void PartOptions::declare(Command app, const std::string& units) {
  app.addOption("--part", part,
                "K/N: only part K of N, from 0, of the " + units +
                    ", stored in --checkpoint and nothing else; lucerna merge combines all parts");
  app.addOption("--checkpoint", checkpoint,
                "a folder: finished " + units +
                    " are kept there and taken from there, such as those of lucerna merge --checkpoint");
}

PartOptions::Range PartOptions::rangeOf(std::size_t units) const {
  if (part.empty()) return {0, units};
  const PartOf p = parsePart(part);
  if (checkpoint.empty()) throwBadInput("--part {}: needs --checkpoint PART, which lucerna merge reads", part);
  return {p.part * units / p.parts, (p.part + 1) * units / p.parts};
}

PartFolder::PartFolder(const PartOptions& options, const std::string& command, const std::string& identity,
                       std::size_t units)
    : command_(command), identity_(identity), units_(units), range_(options.rangeOf(units)), isPart_(options.isPart()) {
  if (options.checkpoint.empty()) return;
  folder_ = options.checkpoint;
  std::error_code error;
  fs::create_directories(*folder_, error);
  if (error) throwBadInput("--checkpoint {}: cannot create folder ({})", folder_->string(), error.message());
  if (!fs::exists(*folder_ / kDescription)) {
    if (fs::directory_iterator(*folder_) != fs::directory_iterator())
      throwBadInput("--checkpoint {}: holds something else; choose another folder", folder_->string());
    writeFileAtomically(*folder_ / kDescription, description(false).dump(1) + "\n");
    return;
  }
  const Json known = readDescription(*folder_), own = description(false);
  for (const char* key : {"command", "identity", "units", "first", "last"})
    if (known.at(key) != own.at(key))
      throwBadInput("--checkpoint {}: is of another scene, setting or part ({}: {} instead of {})", folder_->string(),
                    key, known.at(key).dump(), own.at(key).dump());
}

Json PartFolder::description(bool done) const {
  return {{"lucerna_part", 1},     {"command", command_}, {"identity", identity_}, {"units", units_},
          {"first", range_.first}, {"last", range_.last}, {"done", done}};
}

fs::path PartFolder::file(std::size_t unit, const std::string& extension) const {
  return *folder_ / fmt::format("{:06}{}", unit, extension);
}

std::optional<Json> PartFolder::load(std::size_t unit) const {
  if (!folder_ || !fs::exists(file(unit, ".json"))) return std::nullopt;
  Json json = Json::parse(readFileText(file(unit, ".json")), nullptr, false);
  if (!json.is_discarded()) return json;
  logWarning("{}: damaged, will be recomputed", file(unit, ".json").string());
  return std::nullopt;
}

void PartFolder::store(std::size_t unit, const Json& result) const {
  if (folder_) writeFileAtomically(file(unit, ".json"), result.dump() + "\n");
}

void PartFolder::finish() const {
  if (folder_) writeFileAtomically(*folder_ / kDescription, description(true).dump(1) + "\n");
}

bool isPartFolder(const fs::path& folder) { return fs::is_directory(folder) && fs::exists(folder / kDescription); }

bool isFinishedPart(const fs::path& folder) {
  return isPartFolder(folder) && readDescription(folder).at("done").get<bool>();
}

void copyUnits(const fs::path& from, const fs::path& to) {
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path name = fs::relative(entry.path(), from), target = to / name;
    if (name == kDescription || name.filename().string().starts_with(".")) continue;
    std::error_code error;
    if (entry.is_directory()) {
      fs::create_directories(target, error);
    } else if (!fs::exists(target)) {
      fs::copy_file(entry.path(), target, error);
    } else if (readFileBytes(entry.path()) != readFileBytes(target)) {
      throwBadInput("{}: {} is not that of the parts before it: another scene, setting or reference", from.string(),
                    name.string());
    }
    if (error) throwBadInput("{}: cannot be written ({})", target.string(), error.message());
  }
}

Json mergeParts(std::vector<fs::path> parts, const fs::path& whole) {
  if (fs::exists(whole)) throwBadInput("--checkpoint {}: already exists; choose another folder", whole.string());
  std::vector<std::pair<Json, fs::path>> found;
  for (fs::path& part : parts) found.emplace_back(readDescription(part), std::move(part));
  // In the order of their units; an empty part comes before the one that begins at the same unit.
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.at("first").template get<std::size_t>(), a.first.at("last").template get<std::size_t>()) <
           std::pair(b.first.at("first").template get<std::size_t>(), b.first.at("last").template get<std::size_t>());
  });
  Json all = found.front().first;
  std::size_t next = 0;
  for (const auto& [json, part] : found) {
    for (const char* key : {"command", "identity", "units"})
      if (json.at(key) != all.at(key))
        throwBadInput("{}: a part of another scene or of other settings than {} ({}: {} instead of {})", part.string(),
                      found.front().second.string(), key, json.at(key).dump(), all.at(key).dump());
    if (!json.at("done").get<bool>())
      throwBadInput("{}: is not finished; the command that makes it resumes it", part.string());
    const auto first = json.at("first").get<std::size_t>(), last = json.at("last").get<std::size_t>();
    if (first < next && first != last)
      throwBadInput("{}: holds the same units ({} to {}) as an earlier part", part.string(), first,
                    std::min(last, next) - 1);
    if (first > next) throwBadInput("units {} to {} are in no part (the next is {})", next, first - 1, part.string());
    next = std::max(next, last);
  }
  if (next < all.at("units").get<std::size_t>())
    throwBadInput("units {} to {} are in no part", next, all.at("units").get<std::size_t>() - 1);
  // Written next to its final place until it is complete.
  const fs::path draft = fmt::format("{}.draft.{}", whole.string(), ::getpid());
  std::error_code error;
  fs::create_directories(draft, error);
  if (error) throwBadInput("--checkpoint {}: cannot create folder ({})", whole.string(), error.message());
  try {
    for (const auto& [json, part] : found) copyUnits(part, draft);
  } catch (...) {
    fs::remove_all(draft, error);
    throw;
  }
  all["first"] = 0;
  all["last"] = all.at("units");
  writeFileAtomically(draft / kDescription, all.dump(1) + "\n");
  fs::rename(draft, whole);
  return all;
}

}  // namespace lucerna::demo
