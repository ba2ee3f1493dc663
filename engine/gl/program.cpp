#include "gl/program.hpp"

#include "base/clock.hpp"
#include "gl/build_watch.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "gl/objects.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

namespace lucerna::gl {

namespace fs = std::filesystem;

namespace {

std::string shaderLog(GLuint shader) {
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  log.resize(log.find('\0') == std::string::npos ? log.size() : log.find('\0'));
  return log;
}

std::string programLog(GLuint program) {
  GLint length = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  glGetProgramInfoLog(program, length, nullptr, log.data());
  log.resize(log.find('\0') == std::string::npos ? log.size() : log.find('\0'));
  return log;
}

const char* suffixOf(GLenum stage) {
  return stage == GL_VERTEX_SHADER     ? "vert"
         : stage == GL_GEOMETRY_SHADER ? "geom"
         : stage == GL_FRAGMENT_SHADER ? "frag"
                                       : "comp";
}

/// A linked program's use of OpenGL's limits: lines "NAME VALUE" for GL_MAX_NAME, zeros omitted, and
/// SAMPLER_TYPES_OF_A_UNIT, of which OpenGL allows one. Shared memory cannot be queried.
std::string needsOf(GLuint program, const std::vector<std::pair<GLenum, std::string>>& texts) {
  struct Stage {
    GLenum referenced;
    const char* name;
  };
  constexpr std::array kStages{
      Stage{GL_REFERENCED_BY_VERTEX_SHADER, "VERTEX"}, Stage{GL_REFERENCED_BY_GEOMETRY_SHADER, "GEOMETRY"},
      Stage{GL_REFERENCED_BY_FRAGMENT_SHADER, "FRAGMENT"}, Stage{GL_REFERENCED_BY_COMPUTE_SHADER, "COMPUTE"}};
  std::map<std::string, GLint> needs;
  const auto property = [&](GLenum interface, GLuint resource, GLenum key) {
    GLint value = 0;
    glGetProgramResourceiv(program, interface, resource, 1, &key, 1, nullptr, &value);
    return value;
  };
  const auto countOf = [&](GLenum interface) {
    GLint count = 0;
    glGetProgramInterfaceiv(program, interface, GL_ACTIVE_RESOURCES, &count);
    return static_cast<GLuint>(count);
  };
  const auto add = [&](GLenum interface, GLuint resource, const std::string& what, GLint count) {
    for (const Stage& stage : kStages)
      if (property(interface, resource, stage.referenced) != 0) {
        needs[fmt::format("{}_{}", stage.name, what)] += count;
        needs["COMBINED_" + what] += count;
      }
  };
  const auto raise = [&](const std::string& what, GLint value) { needs[what] = std::max(needs[what], value); };
  for (GLuint i = 0; i < countOf(GL_SHADER_STORAGE_BLOCK); ++i) {
    // For most of them Mesa does not say which stages refer to them; a stage counts if its source declares an active
    // block.
    std::array<char, 128> block{};
    glGetProgramResourceName(program, GL_SHADER_STORAGE_BLOCK, i, static_cast<GLsizei>(block.size()), nullptr,
                             block.data());
    for (const auto& [stage, text] : texts)
      if (text.find(fmt::format("buffer {} {{", block.data())) != std::string::npos) {
        const char* name = stage == GL_VERTEX_SHADER     ? "VERTEX"
                           : stage == GL_GEOMETRY_SHADER ? "GEOMETRY"
                           : stage == GL_FRAGMENT_SHADER ? "FRAGMENT"
                                                         : "COMPUTE";
        ++needs[fmt::format("{}_SHADER_STORAGE_BLOCKS", name)];
        ++needs["COMBINED_SHADER_STORAGE_BLOCKS"];
      }
    raise("SHADER_STORAGE_BUFFER_BINDINGS", property(GL_SHADER_STORAGE_BLOCK, i, GL_BUFFER_BINDING) + 1);
  }
  for (GLuint i = 0; i < countOf(GL_UNIFORM_BLOCK); ++i) {
    add(GL_UNIFORM_BLOCK, i, "UNIFORM_BLOCKS", 1);
    raise("UNIFORM_BUFFER_BINDINGS", property(GL_UNIFORM_BLOCK, i, GL_BUFFER_BINDING) + 1);
    raise("UNIFORM_BLOCK_SIZE", property(GL_UNIFORM_BLOCK, i, GL_BUFFER_DATA_SIZE));
  }
  std::map<GLint, std::set<GLenum>> typesOfUnit;  // two: OpenGL refuses to draw, Mesa's software renderer does not
  for (GLuint i = 0; i < countOf(GL_UNIFORM); ++i) {
    const GLint location = property(GL_UNIFORM, i, GL_LOCATION), count = property(GL_UNIFORM, i, GL_ARRAY_SIZE);
    if (location < 0) continue;  // in a block
    const auto type = static_cast<GLenum>(property(GL_UNIFORM, i, GL_TYPE));
    const bool image = type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY;
    const bool sampler = (type >= GL_SAMPLER_1D && type <= GL_SAMPLER_2D_RECT_SHADOW) ||
                         (type >= GL_SAMPLER_1D_ARRAY && type <= GL_SAMPLER_CUBE_SHADOW) ||
                         (type >= GL_INT_SAMPLER_1D && type <= GL_UNSIGNED_INT_SAMPLER_BUFFER);
    if (!image && !sampler) continue;
    GLint unit = 0;
    glGetUniformiv(program, location, &unit);
    add(GL_UNIFORM, i, image ? "IMAGE_UNIFORMS" : "TEXTURE_IMAGE_UNITS", count);
    raise(image ? "IMAGE_UNITS" : "TEXTURE_UNITS", unit + count);
    for (GLint k = 0; sampler && k < count; ++k) typesOfUnit[unit + k].insert(type);
  }
  for (const auto& [unit, types] : typesOfUnit) raise("SAMPLER_TYPES_OF_A_UNIT", static_cast<GLint>(types.size()));
  if (texts.front().first == GL_COMPUTE_SHADER) {
    std::array<GLint, 3> group{};
    glGetProgramiv(program, GL_COMPUTE_WORK_GROUP_SIZE, group.data());
    raise("COMPUTE_WORK_GROUP_INVOCATIONS", group[0] * group[1] * group[2]);
  }
  std::string text;
  for (const auto& [name, value] : needs) text += fmt::format("{} {}\n", name, value);
  return text;
}

/// LUCERNA_DUMP_PROGRAMS=FOLDER stores the sources, for other drivers and validators: FOLDER/HASH.vert .geom .frag
/// .comp per stage, HASH.name the program's name and flags, HASH.needs its requirements. Programs with identical source
/// are stored once.
void dump(const std::string& name, GLuint program, const std::vector<std::pair<GLenum, std::string>>& texts) {
  const char* folder = std::getenv("LUCERNA_DUMP_PROGRAMS");
  if (!folder || !*folder) return;
  Hash hash;
  for (const auto& [stage, text] : texts) hash.bytes(text.data(), text.size());
  fs::create_directories(folder);
  const auto keep = [&](const char* suffix, const std::string& text) {
    const fs::path file = fs::path(folder) / fmt::format("{:016x}.{}", hash.value(), suffix);
    if (!(std::ofstream(file) << text))
      throwBadInput("LUCERNA_DUMP_PROGRAMS={}: cannot write {}", folder, file.filename().string());
  };
  for (const auto& [stage, text] : texts) keep(suffixOf(stage), text);
  keep("needs", needsOf(program, texts));
  keep("name", name + "\n");
}

}  // namespace

ShaderFlags with(ShaderFlags flags, const ShaderFlags& more) {
  flags.insert(flags.end(), more.begin(), more.end());
  return flags;
}

// ---------------------------------------------------------------------------------------------------- Program

Program::~Program() {
  if (id_) glDeleteProgram(id_);
}

GLint Program::location(std::string_view uniform) const {
  if (const auto found = locations_.find(uniform); found != locations_.end()) return found->second;
  const std::string name(uniform);
  return locations_[name] = glGetUniformLocation(id_, name.c_str());
}

void Program::set(std::string_view u, int v) const { glProgramUniform1i(id_, location(u), v); }
void Program::set(std::string_view u, unsigned v) const { glProgramUniform1ui(id_, location(u), v); }
void Program::set(std::string_view u, float v) const { glProgramUniform1f(id_, location(u), v); }
void Program::set(std::string_view u, const glm::ivec2& v) const { glProgramUniform2iv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::ivec3& v) const { glProgramUniform3iv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::uvec4& v) const { glProgramUniform4uiv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::vec2& v) const { glProgramUniform2fv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::vec3& v) const { glProgramUniform3fv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::vec4& v) const { glProgramUniform4fv(id_, location(u), 1, &v.x); }
void Program::set(std::string_view u, const glm::mat4& v) const {
  glProgramUniformMatrix4fv(id_, location(u), 1, GL_FALSE, &v[0][0]);
}

std::vector<std::string> Program::activeResources() const {
  std::vector<std::string> names;
  for (const GLenum interface : std::initializer_list<GLenum>{GL_UNIFORM, GL_UNIFORM_BLOCK, GL_SHADER_STORAGE_BLOCK}) {
    GLint count = 0, longest = 0;
    glGetProgramInterfaceiv(id_, interface, GL_ACTIVE_RESOURCES, &count);
    glGetProgramInterfaceiv(id_, interface, GL_MAX_NAME_LENGTH, &longest);
    std::string name(static_cast<std::size_t>(std::max(longest, 1)), '\0');
    for (GLint i = 0; i < count; ++i) {
      GLsizei length = 0;
      glGetProgramResourceName(id_, interface, static_cast<GLuint>(i), longest, &length, name.data());
      names.emplace_back(name.data(), static_cast<std::size_t>(length));
    }
  }
  return names;
}

// ---------------------------------------------------------------------------------------------------- ProgramLibrary

ProgramLibrary::ProgramLibrary(fs::path root) : root_(std::move(root)) {
  if (!root_.empty()) return;
  const char* environment = std::getenv("LUCERNA_SHADERS");
  root_ = environment && *environment ? fs::path(environment) : dataFolder() / "shaders";
  if (!fs::is_directory(root_))
    throwBadInput("{}: the shaders folder is missing (LUCERNA_SHADERS names another)", root_.string());
}

const Program& ProgramLibrary::load(const ProgramDescription& description) {
  for (const auto& program : programs_) {
    const auto& known = program->description_;
    const bool sameStages =
        std::equal(known.stages.begin(), known.stages.end(), description.stages.begin(), description.stages.end(),
                   [](const ShaderStage& a, const ShaderStage& b) { return a.type == b.type && a.file == b.file; });
    if (sameStages && known.flags == description.flags) {
      ++statistics_.reused;
      return *program;
    }
  }
  BuildWatch::say(description.name);
  std::unique_ptr<Program> program(new Program(description));
  build(*program);
  programs_.push_back(std::move(program));
  ++statistics_.built;
  return *programs_.back();
}

const Program& ProgramLibrary::loadRaster(const std::string& name, const std::string& vertex,
                                          const std::string& fragment, const ShaderFlags& flags,
                                          const std::string& geometry) {
  ProgramDescription description{name, {{GL_VERTEX_SHADER, vertex}}, flags};
  if (!geometry.empty()) description.stages.push_back({GL_GEOMETRY_SHADER, geometry});
  if (!fragment.empty()) description.stages.push_back({GL_FRAGMENT_SHADER, fragment});
  return load(description);
}

const Program& ProgramLibrary::loadCompute(const std::string& name, const std::string& compute,
                                           const ShaderFlags& flags) {
  return load({name, {{GL_COMPUTE_SHADER, compute}}, flags});
}

void ProgramLibrary::build(Program& program) {
  const auto start = Clock::now();
  const ProgramDescription& description = program.description_;
  std::map<fs::path, fs::file_time_type> dependencies;
  const GLuint id = glCreateProgram();
  std::vector<GLuint> shaders;
  std::vector<std::pair<GLenum, std::string>> texts;
  const auto fail = [&](const std::string& message, ErrorKind kind = ErrorKind::badInput) {
    for (GLuint shader : shaders) glDeleteShader(shader);
    glDeleteProgram(id);
    // So that an edit that fixes a file is noticed, and the same failure is not repeated until then: the previous files
    // with their current times, and those read since.
    for (auto& [file, time] : program.dependencies_) {
      std::error_code gone;
      if (const auto now = fs::last_write_time(root_ / file, gone); !gone) time = now;
    }
    for (const auto& [file, time] : dependencies) program.dependencies_[file] = time;
    throw Error(kind, fmt::format("program {}: {}", description.name, message));
  };
  for (const ShaderStage& stage : description.stages) {
    ExpandedSource source;
    try {
      source = expandShader(root_, stage.file, description.flags);
    } catch (const Error& error) { fail(error.what(), error.kind()); }
    for (const fs::path& file : source.files) dependencies[file] = fs::last_write_time(root_ / file);
    const GLuint shader = glCreateShader(stage.type);
    shaders.push_back(shader);
    const char* text = source.text.c_str();
    texts.emplace_back(stage.type, source.text);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    const std::string log = rewriteShaderLog(shaderLog(shader), source);
    if (!compiled) fail(fmt::format("shaders/{} does not compile:\n{}", stage.file, log));
    if (!log.empty()) logVerbose("program {}: {}", description.name, log);
    glAttachShader(id, shader);
  }
  glLinkProgram(id);
  GLint linked = GL_FALSE;
  glGetProgramiv(id, GL_LINK_STATUS, &linked);
  if (!linked) fail(fmt::format("does not link:\n{}", programLog(id)));
  std::string name = description.name;
  for (const auto& [flag, value] : description.flags)
    if (value != 0) name += value == 1 ? " " + flag : fmt::format(" {}={}", flag, value);
  dump(name, id, texts);
  for (GLuint shader : shaders) {
    glDetachShader(id, shader);
    glDeleteShader(shader);
  }
  label(GL_PROGRAM, id, description.name);
  if (program.id_) glDeleteProgram(program.id_);
  program.id_ = id;
  program.locations_.clear();
  program.dependencies_ = std::move(dependencies);
  statistics_.compileSeconds += secondsSince(start);
}

ProgramLibrary::Reload ProgramLibrary::reloadChanged() {
  Reload result;
  for (const auto& program : programs_) {
    bool changed = false;
    for (auto& [file, time] : program->dependencies_) {
      std::error_code error;
      const auto now = fs::last_write_time(root_ / file, error);
      changed = changed || (!error && now != time);
    }
    if (!changed) continue;
    try {
      build(*program);
      ++result.reloaded;
    } catch (const Error& error) { result.failures.emplace_back(error.what()); }
  }
  return result;
}

std::vector<std::string> ProgramLibrary::names() const {
  std::vector<std::string> result;
  for (const auto& program : programs_) result.push_back(program->name());
  return result;
}

}  // namespace lucerna::gl
