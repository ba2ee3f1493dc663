// Shader programs from files.
//
// A small preprocessor runs before the driver's: it writes `#version 430 core`, the program's declared flags as
// `#define NAME value`, then the file with its include-once, root-relative `#include "lib/x.glsl"`s. It refuses what
// drivers accept: an undeclared identifier in #if (a misspelt one would silently disable a feature), a missing file, a
// cycle. A branch that a flag leaves out (`#if FLAG`, `#if !FLAG`) includes nothing. Driver logs are rewritten to
// shaders/lib/x.glsl:12. Flags come only from SceneFeatures and Settings.
#pragma once

#include "gl/objects.hpp"

#include <glm/glm.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna::gl {

/// (name, value) in the order written; 0/1 switches or small constants such as a work-group size.
using ShaderFlags = std::vector<std::pair<std::string, int>>;
ShaderFlags with(ShaderFlags flags, const ShaderFlags& more);

struct ShaderStage {
  GLenum type;
  std::string file;  ///< relative to the shader root
};

struct ProgramDescription {
  std::string name;
  std::vector<ShaderStage> stages;
  ShaderFlags flags;
};

/// A file with its includes expanded, and where each line came from.
struct ExpandedSource {
  std::string text;
  struct Line {
    int file;
    int line;
  };
  std::vector<Line> lines;  ///< one per line of `text`
  std::vector<std::filesystem::path> files;  ///< relative to the root, in order of first inclusion
};

/// Expands a shader file. Throws Error(badInput) naming file and line. Pure: tested without GL.
ExpandedSource expandShader(const std::filesystem::path& root, const std::string& file, const ShaderFlags& flags);

/// Rewrites a driver's log (Mesa "0:12(3): error", NVIDIA "0(12) : error", AMD "ERROR: 0:12:") to file:line.
std::string rewriteShaderLog(const std::string& log, const ExpandedSource& source);

class Program {
 public:
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  const std::string& name() const { return description_.name; }
  GLuint id() const { return id_; }
  void use() const { glUseProgram(id_); }

  // Uniforms by name; one that the driver optimised away is skipped.
  void set(std::string_view uniform, int value) const;
  void set(std::string_view uniform, unsigned value) const;
  void set(std::string_view uniform, float value) const;
  void set(std::string_view uniform, const glm::ivec2& value) const;
  void set(std::string_view uniform, const glm::ivec3& value) const;
  void set(std::string_view uniform, const glm::uvec4& value) const;
  void set(std::string_view uniform, const glm::vec2& value) const;
  void set(std::string_view uniform, const glm::vec3& value) const;
  void set(std::string_view uniform, const glm::vec4& value) const;
  void set(std::string_view uniform, const glm::mat4& value) const;

  /// Names of the active uniforms, blocks and storage buffers.
  std::vector<std::string> activeResources() const;

 private:
  friend class ProgramLibrary;
  explicit Program(ProgramDescription description) : description_(std::move(description)) {}
  GLint location(std::string_view uniform) const;

  ProgramDescription description_;
  GLuint id_ = 0;
  std::map<std::filesystem::path, std::filesystem::file_time_type> dependencies_;
  mutable std::map<std::string, GLint, std::less<>> locations_;
};

/// Builds programs, one per (files, flags), and reloads those whose files changed.
class ProgramLibrary {
 public:
  /// `root`: the shaders folder; empty: LUCERNA_SHADERS in the environment, else the one beside the assets
  /// (base/data.hpp).
  explicit ProgramLibrary(std::filesystem::path root = {});

  /// Throws Error(badInput) with the rewritten log if it does not compile or link.
  const Program& load(const ProgramDescription& description);
  const Program& loadRaster(const std::string& name, const std::string& vertex, const std::string& fragment,
                            const ShaderFlags& flags = {}, const std::string& geometry = {});
  const Program& loadCompute(const std::string& name, const std::string& compute, const ShaderFlags& flags = {});

  /// Rebuilds the programs whose files changed since. A program that fails keeps its old version; its log is returned.
  struct Reload {
    int reloaded = 0;
    std::vector<std::string> failures;
  };
  Reload reloadChanged();

  struct Statistics {
    int built = 0, reused = 0;
    double compileSeconds = 0.0;
  };
  const Statistics& statistics() const { return statistics_; }
  const std::filesystem::path& root() const { return root_; }
  /// Names of all programs built so far.
  std::vector<std::string> names() const;
  const std::vector<std::unique_ptr<Program>>& programs() const { return programs_; }

 private:
  void build(Program& program);
  std::filesystem::path root_;
  std::vector<std::unique_ptr<Program>> programs_;
  Statistics statistics_;
};

}  // namespace lucerna::gl
