// The barrier ledger's entry points: each tells the ledger and calls the driver's function.
#include "gl/barrier_ledger.hpp"
#include "host/gl_procs.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <regex>

namespace lucerna::gl {

namespace {

using Kind = BarrierLedger::Kind;
using Resource = BarrierLedger::Resource;
using MemoryAccess = BarrierLedger::Access;

struct Block {
  std::string name;
  GLuint binding = 0;
  bool reads = true, writes = true, unordered = false, aliased = false;
};
struct Unit {  // of a sampler or an image
  std::string name;
  GLuint unit = 0;
  GLenum target = 0;  // of the texture; 0: image
  bool unordered = false, aliased = false;
};
struct ProgramUses {
  std::string label, text;
  bool known = false;
  std::vector<Block> storage, uniform;
  std::vector<Unit> samplers, images;
};
struct Image {
  GLuint texture = 0;
  GLenum access = GL_READ_ONLY;
};

// What OpenGL has bound. One context at a time.
struct Bindings {
  GLuint program = 0, framebuffer = 0, readFramebuffer = 0, vertexArray = 0;
  GLenum activeUnit = 0;
  std::map<GLenum, GLuint> buffers;  // by target
  std::map<std::pair<GLenum, GLuint>, GLuint> indexed;  // uniform and storage blocks
  std::map<std::pair<GLuint, GLenum>, GLuint> textures;  // by unit and target
  std::map<GLuint, Image> images;
  std::map<GLuint, GLuint> bufferOfTexture;
  std::map<GLuint, std::map<GLenum, GLuint>> attachments;  // by framebuffer
  std::map<GLuint, std::set<GLuint>> attributes;  // vertex buffers, by vertex array
  std::map<GLuint, GLuint> elements;
  std::map<GLuint, std::string> shaders;
  std::map<GLuint, ProgramUses> programs;
  struct Group {
    std::string name;
    std::uint64_t serial;
  };
  std::vector<Group> groups;
  std::uint64_t groupCount = 0;
};

std::unique_ptr<BarrierLedger> g_ledger;
Bindings g_bound;

std::string g_nextSite;

std::string site() {
  if (!g_nextSite.empty()) return std::exchange(g_nextSite, {});
  return g_bound.groups.empty() ? "between passes" : g_bound.groups.back().name;
}

GLuint bound(GLenum target) { return g_bound.buffers[target]; }
GLuint boundTexture(GLenum target) { return g_bound.textures[{g_bound.activeUnit, target}]; }
Resource bufferAt(GLenum target) { return {Kind::buffer, bound(target)}; }
Resource textureAt(GLenum target) { return {Kind::texture, boundTexture(target)}; }

// ---------------------------------------------------------------------------------------- programs

GLenum targetOfSampler(GLenum type) {
  switch (type) {
    case GL_SAMPLER_2D:
    case GL_SAMPLER_2D_SHADOW:
    case GL_INT_SAMPLER_2D:
    case GL_UNSIGNED_INT_SAMPLER_2D: return GL_TEXTURE_2D;
    case GL_SAMPLER_3D:
    case GL_INT_SAMPLER_3D:
    case GL_UNSIGNED_INT_SAMPLER_3D: return GL_TEXTURE_3D;
    case GL_SAMPLER_2D_ARRAY:
    case GL_SAMPLER_2D_ARRAY_SHADOW:
    case GL_INT_SAMPLER_2D_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY: return GL_TEXTURE_2D_ARRAY;
    case GL_SAMPLER_CUBE_MAP_ARRAY:
    case GL_SAMPLER_CUBE_MAP_ARRAY_SHADOW: return GL_TEXTURE_CUBE_MAP_ARRAY;
    case GL_SAMPLER_BUFFER:
    case GL_INT_SAMPLER_BUFFER:
    case GL_UNSIGNED_INT_SAMPLER_BUFFER: return GL_TEXTURE_BUFFER;
    default: return 0;
  }
}

/// OpenGL does not say which blocks a program reads or writes: its source does. Of several declarations under #if, any.
void readQualifiers(const std::string& text, Block& block) {
  const std::regex declaration("((?:(?:readonly|writeonly|restrict|coherent|volatile)\\s+)*)buffer\\s+" + block.name +
                               "\\b");
  bool reads = false, writes = false, found = false;
  for (std::sregex_iterator i(text.begin(), text.end(), declaration), end; i != end; ++i, found = true) {
    const std::string qualifiers = (*i)[1];
    reads = reads || qualifiers.find("writeonly") == std::string::npos;
    writes = writes || qualifiers.find("readonly") == std::string::npos;
  }
  if (found) block.reads = reads, block.writes = writes;
}

const ProgramUses& usesOf(GLuint program) {
  ProgramUses& uses = g_bound.programs[program];
  if (uses.known) return uses;
  uses.known = true;
  if (uses.label.empty()) uses.label = fmt::format("program {}", program);
  std::map<std::string, std::set<std::string>> declared;
  const std::regex declaration("// (unordered|aliased) (\\w+): ");
  for (std::sregex_iterator i(uses.text.begin(), uses.text.end(), declaration), end; i != end; ++i)
    declared[(*i)[1]].insert((*i)[2]);
  const std::set<std::string>&unordered = declared["unordered"], &aliased = declared["aliased"];
  const auto property = [&](GLenum interface, GLuint resource, GLenum key) {
    GLint value = 0;
    glGetProgramResourceiv(program, interface, resource, 1, &key, 1, nullptr, &value);
    return value;
  };
  const auto forEach = [&](GLenum interface, const auto& use) {
    GLint count = 0;
    glGetProgramInterfaceiv(program, interface, GL_ACTIVE_RESOURCES, &count);
    for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
      char name[256] = "";
      glGetProgramResourceName(program, interface, i, sizeof name, nullptr, name);
      use(i, std::string(name).substr(0, std::strcspn(name, "[")));
    }
  };
  forEach(GL_SHADER_STORAGE_BLOCK, [&](GLuint i, const std::string& name) {
    Block block{name, static_cast<GLuint>(property(GL_SHADER_STORAGE_BLOCK, i, GL_BUFFER_BINDING))};
    readQualifiers(uses.text, block);
    block.unordered = unordered.contains(name);
    block.aliased = aliased.contains(name);
    uses.storage.push_back(block);
  });
  forEach(GL_UNIFORM_BLOCK, [&](GLuint i, const std::string& name) {
    uses.uniform.push_back({name, static_cast<GLuint>(property(GL_UNIFORM_BLOCK, i, GL_BUFFER_BINDING)), true, false});
  });
  forEach(GL_UNIFORM, [&](GLuint i, const std::string& name) {
    const GLint location = property(GL_UNIFORM, i, GL_LOCATION);
    const auto type = static_cast<GLenum>(property(GL_UNIFORM, i, GL_TYPE));
    const bool image = type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY;
    const GLenum target = targetOfSampler(type);
    if (location < 0 || (!image && target == 0)) return;
    GLint first = 0;
    glGetUniformiv(program, location, &first);
    for (GLint k = 0; k < property(GL_UNIFORM, i, GL_ARRAY_SIZE); ++k)
      (image ? uses.images : uses.samplers)
          .push_back({name, static_cast<GLuint>(first + k), target, unordered.contains(name), aliased.contains(name)});
  });
  return uses;
}

// ---------------------------------------------------------------------------------------- draws and dispatches

void addAttachments(std::vector<MemoryAccess>& accesses, GLuint framebuffer, bool writes, const std::string& how) {
  if (framebuffer == 0) return;  // the window's
  for (const auto& [attachment, texture] : g_bound.attachments[framebuffer])
    if (texture != 0)
      accesses.push_back({{Kind::texture, texture}, GL_FRAMEBUFFER_BARRIER_BIT, !writes, writes, false, how});
}

/// indirect: the buffer with the number of groups, or 0.
void run(bool draws, bool withElements, GLuint indirect) {
  const ProgramUses& uses = usesOf(g_bound.program);
  const std::string command = fmt::format("{} '{}'", draws ? "draw" : "dispatch", uses.label);
  std::vector<MemoryAccess> accesses;
  const auto missing = [&](const char* kind, const std::string& name, GLuint place) {
    g_ledger->report(fmt::format("nothing bound: {} has nothing at {} {}, {}", command, kind, name, place));
  };
  for (const auto* blocks : {&uses.storage, &uses.uniform})
    for (const Block& block : *blocks) {
      const bool storage = blocks == &uses.storage;
      const GLuint buffer = g_bound.indexed[{storage ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER, block.binding}];
      const char* kind = storage ? "storage block" : "uniform block";
      if (buffer == 0) missing(kind, block.name, block.binding);
      else
        accesses.push_back({{Kind::buffer, buffer},
                            static_cast<GLbitfield>(storage ? GL_SHADER_STORAGE_BARRIER_BIT : GL_UNIFORM_BARRIER_BIT),
                            block.reads,
                            block.writes,
                            true,
                            fmt::format("{} {}", kind, block.name),
                            block.unordered,
                            block.aliased});
    }
  for (const Unit& sampler : uses.samplers) {
    const GLuint texture = g_bound.textures[{sampler.unit, sampler.target}];
    if (texture == 0) {
      missing("sampler", sampler.name, sampler.unit);
      continue;
    }
    const auto buffer = g_bound.bufferOfTexture.find(texture);
    accesses.push_back({buffer == g_bound.bufferOfTexture.end() ? Resource(Kind::texture, texture)
                                                                : Resource(Kind::buffer, buffer->second),
                        GL_TEXTURE_FETCH_BARRIER_BIT, true, false, true, "sampler " + sampler.name});
  }
  for (const Unit& unit : uses.images) {
    const Image image = g_bound.images[unit.unit];
    if (image.texture == 0) missing("image", unit.name, unit.unit);
    else
      accesses.push_back({{Kind::texture, image.texture},
                          GL_SHADER_IMAGE_ACCESS_BARRIER_BIT,
                          image.access != GL_WRITE_ONLY,
                          image.access != GL_READ_ONLY,
                          true,
                          "image " + unit.name,
                          unit.unordered,
                          unit.aliased});
  }
  if (draws) {
    addAttachments(accesses, g_bound.framebuffer, true, "attachment");
    for (const GLuint buffer : g_bound.attributes[g_bound.vertexArray])
      accesses.push_back(
          {{Kind::buffer, buffer}, GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT, true, false, true, "vertex attributes"});
    if (const GLuint elements = g_bound.elements[g_bound.vertexArray]; withElements && elements != 0)
      accesses.push_back({{Kind::buffer, elements}, GL_ELEMENT_ARRAY_BARRIER_BIT, true, false, true, "indices"});
  }
  if (indirect != 0)
    accesses.push_back({{Kind::buffer, indirect}, GL_COMMAND_BARRIER_BIT, true, false, false, "group counts"});
  const std::uint64_t pass = g_bound.groups.empty() ? 0 : g_bound.groups.back().serial;
  g_ledger->access(command, pass << 32 | g_bound.program, accesses);
}

void api(const char* call, Resource resource, GLbitfield bit, bool writes) {
  if (resource.second != 0) g_ledger->access(call, 0, {{resource, bit, !writes, writes, false, "its target"}});
}

/// An upload into a texture, from a bound pixel buffer or from memory.
void upload(const char* call, GLenum target) {
  api(call, textureAt(target), GL_TEXTURE_UPDATE_BARRIER_BIT, true);
  if (bound(GL_PIXEL_UNPACK_BUFFER) != 0)
    api(call, bufferAt(GL_PIXEL_UNPACK_BUFFER), GL_PIXEL_BUFFER_BARRIER_BIT, false);
}

void deleted(std::map<std::pair<GLuint, GLenum>, GLuint>& map, GLuint id) {
  std::erase_if(map, [&](const auto& entry) { return entry.second == id; });
}

// ---------------------------------------------------------------------------------------- entry points

struct Hook {
  GlProc replacement;
  GlProc* driver;
};
std::map<std::string, Hook>& hooks() {
  static std::map<std::string, Hook> all;
  return all;
}
bool add(const char* name, GlProc replacement, GlProc* driver) {
  return hooks().insert({name, {replacement, driver}}).second;
}

// HOOK(glName, (parameters), (arguments), { what the ledger learns, before the driver })
#define HOOK(name, parameters, arguments, ...) \
  void(GLAPIENTRY * driver_##name) parameters; \
  void GLAPIENTRY on_##name parameters {       \
    __VA_ARGS__                                \
    driver_##name arguments;                   \
  }                                            \
  const bool added_##name = add(#name, reinterpret_cast<GlProc>(&on_##name), reinterpret_cast<GlProc*>(&driver_##name));

// Objects
HOOK(glObjectLabel, (GLenum type, GLuint id, GLsizei length, const GLchar* text), (type, id, length, text), {
  const std::string label = length < 0 ? std::string(text) : std::string(text, static_cast<std::size_t>(length));
  if (type == GL_BUFFER) g_ledger->name({Kind::buffer, id}, label);
  if (type == GL_TEXTURE) g_ledger->name({Kind::texture, id}, label);
  if (type == GL_PROGRAM) g_bound.programs[id].label = label;
})
HOOK(glDeleteBuffers, (GLsizei n, const GLuint* ids), (n, ids), {
  for (GLsizei i = 0; i < n; ++i) {
    g_ledger->forget({Kind::buffer, ids[i]});
    std::erase_if(g_bound.indexed, [&](const auto& entry) { return entry.second == ids[i]; });
    std::erase_if(g_bound.buffers, [&](const auto& entry) { return entry.second == ids[i]; });
  }
})
HOOK(glDeleteTextures, (GLsizei n, const GLuint* ids), (n, ids), {
  for (GLsizei i = 0; i < n; ++i) {
    g_ledger->forget({Kind::texture, ids[i]});
    g_bound.bufferOfTexture.erase(ids[i]);
    deleted(g_bound.textures, ids[i]);
    std::erase_if(g_bound.images, [&](const auto& entry) { return entry.second.texture == ids[i]; });
  }
})
HOOK(glDeleteFramebuffers, (GLsizei n, const GLuint* ids), (n, ids), {
  for (GLsizei i = 0; i < n; ++i) g_bound.attachments.erase(ids[i]);
})
HOOK(glDeleteVertexArrays, (GLsizei n, const GLuint* ids), (n, ids), {
  for (GLsizei i = 0; i < n; ++i) {
    g_bound.attributes.erase(ids[i]);
    g_bound.elements.erase(ids[i]);
  }
})
HOOK(glDeleteProgram, (GLuint id), (id), { g_bound.programs.erase(id); })
HOOK(glShaderSource, (GLuint id, GLsizei n, const GLchar* const* texts, const GLint* lengths), (id, n, texts, lengths),
     {
       g_bound.shaders[id].clear();
       for (GLsizei i = 0; i < n; ++i)
         g_bound.shaders[id] += lengths ? std::string(texts[i], static_cast<std::size_t>(lengths[i])) : texts[i];
     })
HOOK(glDeleteShader, (GLuint id), (id), { g_bound.shaders.erase(id); })
HOOK(glAttachShader, (GLuint program, GLuint id), (program, id),
     { g_bound.programs[program].text += g_bound.shaders[id]; })
HOOK(glLinkProgram, (GLuint program), (program), { g_bound.programs[program].known = false; })

// Bindings
HOOK(glUseProgram, (GLuint program), (program), { g_bound.program = program; })
HOOK(glBindBuffer, (GLenum target, GLuint id), (target, id), {
  g_bound.buffers[target] = id;
  if (target == GL_ELEMENT_ARRAY_BUFFER) g_bound.elements[g_bound.vertexArray] = id;
})
HOOK(glBindBufferBase, (GLenum target, GLuint index, GLuint id), (target, index, id), {
  g_bound.buffers[target] = id;
  g_bound.indexed[{target, index}] = id;
})
HOOK(glActiveTexture, (GLenum unit), (unit), { g_bound.activeUnit = unit - GL_TEXTURE0; })
HOOK(glBindTexture, (GLenum target, GLuint id), (target, id), { g_bound.textures[{g_bound.activeUnit, target}] = id; })
HOOK(glTexBuffer, (GLenum target, GLenum format, GLuint buffer), (target, format, buffer),
     { g_bound.bufferOfTexture[boundTexture(target)] = buffer; })
HOOK(glBindImageTexture,
     (GLuint unit, GLuint id, GLint level, GLboolean layered, GLint layer, GLenum access, GLenum format),
     (unit, id, level, layered, layer, access, format), {
       g_bound.images[unit] = {id, access};
     })
HOOK(glBindFramebuffer, (GLenum target, GLuint id), (target, id), {
  if (target != GL_READ_FRAMEBUFFER) g_bound.framebuffer = id;
  if (target != GL_DRAW_FRAMEBUFFER) g_bound.readFramebuffer = id;
})
HOOK(glFramebufferTexture, (GLenum target, GLenum attachment, GLuint texture, GLint level),
     (target, attachment, texture, level), { g_bound.attachments[g_bound.framebuffer][attachment] = texture; })
HOOK(glBindVertexArray, (GLuint id), (id), { g_bound.vertexArray = id; })
HOOK(glVertexAttribPointer,
     (GLuint index, GLint size, GLenum type, GLboolean normalized, GLsizei stride, const void* offset),
     (index, size, type, normalized, stride, offset),
     { g_bound.attributes[g_bound.vertexArray].insert(bound(GL_ARRAY_BUFFER)); })
HOOK(glPushDebugGroup, (GLenum source, GLuint id, GLsizei length, const GLchar* text), (source, id, length, text), {
  g_bound.groups.push_back(
      {length < 0 ? std::string(text) : std::string(text, static_cast<std::size_t>(length)), ++g_bound.groupCount});
})
HOOK(glPopDebugGroup, (), (), {
  if (!g_bound.groups.empty()) g_bound.groups.pop_back();
})

// Barriers
HOOK(glMemoryBarrier, (GLbitfield bits), (bits), {
  const std::string by = site();
  bits = g_ledger->issued(bits, by);
  g_ledger->barrier(bits, by);
  if (bits == 0) return;
})

// Draws and dispatches
HOOK(glDispatchCompute, (GLuint x, GLuint y, GLuint z), (x, y, z), { run(false, false, 0); })
HOOK(glDispatchComputeIndirect, (GLintptr offset), (offset), { run(false, false, bound(GL_DISPATCH_INDIRECT_BUFFER)); })
HOOK(glDrawArrays, (GLenum mode, GLint first, GLsizei count), (mode, first, count), { run(true, false, 0); })
HOOK(glDrawArraysInstanced, (GLenum mode, GLint first, GLsizei count, GLsizei instances),
     (mode, first, count, instances), { run(true, false, 0); })
HOOK(glDrawElements, (GLenum mode, GLsizei count, GLenum type, const void* indices), (mode, count, type, indices),
     { run(true, true, 0); })

// The API's own reads and writes
HOOK(glBufferData, (GLenum target, GLsizeiptr bytes, const void* data, GLenum usage), (target, bytes, data, usage),
     { g_ledger->overwritten(bufferAt(target)); })
HOOK(glBufferSubData, (GLenum target, GLintptr offset, GLsizeiptr bytes, const void* data),
     (target, offset, bytes, data), { api("glBufferSubData", bufferAt(target), GL_BUFFER_UPDATE_BARRIER_BIT, true); })
HOOK(glClearBufferData, (GLenum target, GLenum internal, GLenum format, GLenum type, const void* data),
     (target, internal, format, type, data), {
       api("glClearBufferData", bufferAt(target), GL_BUFFER_UPDATE_BARRIER_BIT, true);
       g_ledger->overwritten(bufferAt(target));
     })
HOOK(glCopyBufferSubData, (GLenum from, GLenum to, GLintptr fromOffset, GLintptr toOffset, GLsizeiptr bytes),
     (from, to, fromOffset, toOffset, bytes), {
       api("glCopyBufferSubData", bufferAt(from), GL_BUFFER_UPDATE_BARRIER_BIT, false);
       api("glCopyBufferSubData", bufferAt(to), GL_BUFFER_UPDATE_BARRIER_BIT, true);
     })
HOOK(glGetBufferSubData, (GLenum target, GLintptr offset, GLsizeiptr bytes, void* data), (target, offset, bytes, data),
     { api("glGetBufferSubData", bufferAt(target), GL_BUFFER_UPDATE_BARRIER_BIT, false); })
HOOK(glTexSubImage2D,
     (GLenum target, GLint level, GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
      const void* data),
     (target, level, x, y, width, height, format, type, data), { upload("glTexSubImage2D", target); })
HOOK(glTexSubImage3D,
     (GLenum target, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height, GLsizei depth,
      GLenum format, GLenum type, const void* data),
     (target, level, x, y, z, width, height, depth, format, type, data), { upload("glTexSubImage3D", target); })
HOOK(glGetTexImage, (GLenum target, GLint level, GLenum format, GLenum type, void* data),
     (target, level, format, type, data),
     { api("glGetTexImage", textureAt(target), GL_TEXTURE_UPDATE_BARRIER_BIT, false); })
HOOK(glGenerateMipmap, (GLenum target), (target),
     { api("glGenerateMipmap", textureAt(target), GL_TEXTURE_UPDATE_BARRIER_BIT, true); })
HOOK(glClearTexImage, (GLuint id, GLint level, GLenum format, GLenum type, const void* data),
     (id, level, format, type, data), {
       api("glClearTexImage", {Kind::texture, id}, GL_TEXTURE_UPDATE_BARRIER_BIT, true);
     })
HOOK(glCopyImageSubData,
     (GLuint from, GLenum fromTarget, GLint fromLevel, GLint fromX, GLint fromY, GLint fromZ, GLuint to,
      GLenum toTarget, GLint toLevel, GLint toX, GLint toY, GLint toZ, GLsizei width, GLsizei height, GLsizei depth),
     (from, fromTarget, fromLevel, fromX, fromY, fromZ, to, toTarget, toLevel, toX, toY, toZ, width, height, depth), {
       api("glCopyImageSubData", {Kind::texture, from}, GL_TEXTURE_UPDATE_BARRIER_BIT, false);
       api("glCopyImageSubData", {Kind::texture, to}, GL_TEXTURE_UPDATE_BARRIER_BIT, true);
     })
void attachmentsAccessed(const char* call, GLuint framebuffer, bool writes) {
  std::vector<MemoryAccess> accesses;
  addAttachments(accesses, framebuffer, writes, "attachment");
  g_ledger->access(call, 0, accesses);
}
HOOK(glClearBufferfv, (GLenum buffer, GLint index, const GLfloat* value), (buffer, index, value),
     { attachmentsAccessed("glClearBufferfv", g_bound.framebuffer, true); })
HOOK(glClearBufferuiv, (GLenum buffer, GLint index, const GLuint* value), (buffer, index, value),
     { attachmentsAccessed("glClearBufferuiv", g_bound.framebuffer, true); })
HOOK(glReadPixels, (GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void* data),
     (x, y, width, height, format, type, data),
     { attachmentsAccessed("glReadPixels", g_bound.readFramebuffer, false); })
HOOK(glBlitFramebuffer,
     (GLint x0, GLint y0, GLint x1, GLint y1, GLint X0, GLint Y0, GLint X1, GLint Y1, GLbitfield mask, GLenum filter),
     (x0, y0, x1, y1, X0, Y0, X1, Y1, mask, filter), {
       attachmentsAccessed("glBlitFramebuffer", g_bound.readFramebuffer, false);
       attachmentsAccessed("glBlitFramebuffer", g_bound.framebuffer, true);
     })

#undef HOOK

GlProc replace(const char* name, GlProc driver) {
  const auto found = hooks().find(name);
  if (found == hooks().end()) return driver;
  if (std::strcmp(name, "glObjectLabel") == 0) {  // a new context
    g_bound = {};
    g_ledger = std::make_unique<BarrierLedger>();
  }
  *found->second.driver = driver;
  return found->second.replacement;
}

}  // namespace

void checkBarriers() { wrapGlProcs(replace); }

bool barriersCheckedByDefault() {
  const char* value = std::getenv("LUCERNA_CHECK_BARRIERS");
#ifdef NDEBUG
  return value && std::strcmp(value, "1") == 0;
#else
  return !value || std::strcmp(value, "0") != 0;
#endif
}

void nameNextBarrier(const std::string& site) {
  if (g_ledger) g_nextSite = site;
}

void writeBarrierUses() {
  const char* file = std::getenv("LUCERNA_BARRIERS");
  if (!file || !*file || !g_ledger) return;
  std::ofstream stream(file, std::ios::app);
  for (const auto& [barrier, use] : g_ledger->barriers())
    stream << fmt::format("{}\t{}\t{}\t{}\n", barrier.first, nameOfBarrierBit(barrier.second), use.issued, use.needed);
}

BarrierLedger* barrierLedger() { return g_ledger.get(); }

}  // namespace lucerna::gl
