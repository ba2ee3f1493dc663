// Records the window as a video with ffmpeg, if installed: pictures are sent to it raw, and it writes the file.
#pragma once

#include "base/image.hpp"

#include <filesystem>
#include <optional>
#include <string>

#include <sys/types.h>

namespace lucerna::demo {

class Video {
 public:
  static constexpr int kPicturesASecond = 30;
  /// Throws Error(missingCapability) without ffmpeg; its output goes next to the file, as FILE.log.
  Video(std::filesystem::path file, glm::ivec2 size);
  /// Whether there is an ffmpeg in the folders of PATH.
  static bool canBeMade();
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  glm::ivec2 size() const { return size_; }
  const std::filesystem::path& file() const { return file_; }
  int pictures() const { return pictures_; }
  /// Adds the picture shown for the next `seconds`. False: ffmpeg accepts no more.
  bool add(const Bitmap& shown, double seconds);
  /// Waits for ffmpeg; true: the file is complete.
  bool finish();

 private:
  std::filesystem::path file_;
  glm::ivec2 size_;
  pid_t ffmpeg_ = -1;
  int pipe_ = -1;
  int pictures_ = 0;
  double owed_ = 0.0;  ///< pictures
};

}  // namespace lucerna::demo
