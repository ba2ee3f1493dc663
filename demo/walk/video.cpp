#include "walk/video.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace lucerna::demo {

// Uses a pair of sockets instead of a pipe: a pipe whose reader has died ends the writer by a signal.
Video::Video(std::filesystem::path file, glm::ivec2 size) : file_(std::move(file)), size_(size) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throwMissingCapability("video: cannot connect to ffmpeg");
  // H.264 stores colours at half the resolution: sides must be even.
  std::vector<std::string> words{"ffmpeg",
                                 "-y",
                                 "-loglevel",
                                 "warning",
                                 "-f",
                                 "rawvideo",
                                 "-pixel_format",
                                 "rgba",
                                 "-video_size",
                                 fmt::format("{}x{}", size.x, size.y),
                                 "-framerate",
                                 std::to_string(kPicturesASecond),
                                 "-i",
                                 "-",
                                 "-vf",
                                 "crop=trunc(iw/2)*2:trunc(ih/2)*2",
                                 "-pix_fmt",
                                 "yuv420p",
                                 file_.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string log = file_.string() + ".log";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int failed = posix_spawnp(&ffmpeg_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (failed == 0) return;
  close(pipe_);
  throwMissingCapability(
      "video: ffmpeg cannot be started: it is not installed (apt install ffmpeg), or {} cannot be "
      "written",
      log);
}

bool Video::canBeMade() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder.empty() ? "./ffmpeg" : folder + "/ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

Video::~Video() { finish(); }

bool Video::add(const Bitmap& shown, double seconds) {
  if (pipe_ < 0) return false;
  constexpr double kMostOwed = kPicturesASecond;  // a frame that took longer counts as one second
  for (owed_ = std::min(owed_ + seconds * kPicturesASecond, kMostOwed); owed_ >= 1.0; owed_ -= 1.0) {
    for (std::size_t sent = 0; sent < shown.rgba.size();) {
      const ssize_t now = send(pipe_, shown.rgba.data() + sent, shown.rgba.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return false;
      sent += static_cast<std::size_t>(now);
    }
    ++pictures_;
  }
  return true;
}

bool Video::finish() {
  if (pipe_ < 0) return false;
  close(pipe_);
  pipe_ = -1;
  int status = -1;
  const bool whole = waitpid(ffmpeg_, &status, 0) == ffmpeg_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (whole) {  // success: the log is not needed
    std::error_code ignored;
    std::filesystem::remove(file_.string() + ".log", ignored);
  }
  return whole;
}

}  // namespace lucerna::demo
