#include "gl/barrier_ledger.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>

namespace lucerna::gl {

namespace {

const std::string kSeveral = "several passes";

std::size_t indexOf(GLbitfield bit) { return static_cast<std::size_t>(std::countr_zero(bit)); }

}  // namespace

std::string nameOfBarrierBit(GLbitfield bit) {
  switch (bit) {
    case GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT: return "GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT";
    case GL_ELEMENT_ARRAY_BARRIER_BIT: return "GL_ELEMENT_ARRAY_BARRIER_BIT";
    case GL_UNIFORM_BARRIER_BIT: return "GL_UNIFORM_BARRIER_BIT";
    case GL_TEXTURE_FETCH_BARRIER_BIT: return "GL_TEXTURE_FETCH_BARRIER_BIT";
    case GL_SHADER_IMAGE_ACCESS_BARRIER_BIT: return "GL_SHADER_IMAGE_ACCESS_BARRIER_BIT";
    case GL_COMMAND_BARRIER_BIT: return "GL_COMMAND_BARRIER_BIT";
    case GL_PIXEL_BUFFER_BARRIER_BIT: return "GL_PIXEL_BUFFER_BARRIER_BIT";
    case GL_TEXTURE_UPDATE_BARRIER_BIT: return "GL_TEXTURE_UPDATE_BARRIER_BIT";
    case GL_BUFFER_UPDATE_BARRIER_BIT: return "GL_BUFFER_UPDATE_BARRIER_BIT";
    case GL_FRAMEBUFFER_BARRIER_BIT: return "GL_FRAMEBUFFER_BARRIER_BIT";
    case GL_SHADER_STORAGE_BARRIER_BIT: return "GL_SHADER_STORAGE_BARRIER_BIT";
    default: return fmt::format("barrier bit {:#x}", bit);
  }
}

BarrierLedger::State& BarrierLedger::state(Resource resource) {
  State& state = states_[resource];
  if (state.label.empty())
    state.label = fmt::format("{} {}", resource.first == Kind::buffer ? "buffer" : "texture", resource.second);
  return state;
}

void BarrierLedger::name(Resource resource, std::string label) {
  forget(resource);
  states_[resource].label = std::move(label);
}

void BarrierLedger::forget(Resource resource) {
  states_.erase(resource);
  open_.erase(resource);
}

void BarrierLedger::overwritten(Resource resource) { state(resource).written.open = false; }

void BarrierLedger::require(const Event& event, const Access& access, std::uint64_t run, const std::string& label,
                            const char* hazard, const std::string& command) {
  if (!event.open || (run != 0 && event.unorderedWithin == run)) return;
  const std::string* site = event.covers[indexOf(access.bit)];
  if (!site)
    report(fmt::format("{}: '{}' was {} by {}; then {} accesses it as {} without {}", hazard, label,
                       hazard[0] == 'W' && hazard[2] == 'R' ? "accessed" : "written", event.by, command, access.how,
                       nameOfBarrierBit(access.bit)));
  else if (site != &kSeveral) ++barriers_[{*site, access.bit}].needed;
}

void BarrierLedger::access(const std::string& command, std::uint64_t run, const std::vector<Access>& accesses) {
  // An API write that follows shader writes waits for the barrier bit of its own kind; API reads too. A shader write
  // waits for every earlier access.
  for (const Access& a : accesses) {
    const State& s = state(a.resource);
    require(s.written, a, run, s.label, a.reads ? "RAW" : "WAW", command);
    if (a.writes && a.byShader) require(s.accessed, a, run, s.label, "WAR", command);
  }
  for (std::size_t i = 0; i < accesses.size(); ++i)
    for (std::size_t j = i + 1; j < accesses.size(); ++j) {
      const Access &a = accesses[i], &b = accesses[j];
      const bool clash = a.resource == b.resource && a.how != b.how && (a.writes || b.writes) &&
                         (a.byShader || b.byShader) && !a.aliased && !b.aliased;
      // Group counts are read before the dispatch begins.
      if (!clash || a.bit == GL_COMMAND_BARRIER_BIT || b.bit == GL_COMMAND_BARRIER_BIT) continue;
      const bool feedback = a.bit == GL_FRAMEBUFFER_BARRIER_BIT || b.bit == GL_FRAMEBUFFER_BARRIER_BIT;
      report(fmt::format("{}: {} accesses '{}' as {} and as {}", feedback ? "feedback" : "aliasing", command,
                         state(a.resource).label, a.how, b.how));
    }
  const auto opened = [&](const Access& a) {
    const bool unordered = std::any_of(accesses.begin(), accesses.end(),
                                       [&](const Access& b) { return b.resource == a.resource && b.unordered; });
    return Event{true, fmt::format("{} as {}", command, a.how), unordered ? run : 0,
                 std::vector<const std::string*>(kBits, nullptr)};
  };
  if (run == 0) return;  // calls of the API end in order
  for (const Access& a : accesses) {
    state(a.resource).accessed = opened(a);
    open_.insert(a.resource);
  }
  for (const Access& a : accesses)
    if (a.writes && a.byShader) {
      state(a.resource).written = opened(a);
      state(a.resource).accessed.open = false;
    }
}

GLbitfield BarrierLedger::issued(GLbitfield bits, const std::string& site) const {
  const auto found = omitted_.find(site);
  return found == omitted_.end() || bits == GL_ALL_BARRIER_BITS ? bits : bits & ~found->second;
}

void BarrierLedger::cover(Event& event, GLbitfield bits, const std::string* site) {
  if (!event.open) return;
  for (GLbitfield left = bits; left != 0; left &= left - 1) {
    const std::string*& by = event.covers[indexOf(left & (0u - left))];
    by = !by || by == site ? site : &kSeveral;
  }
}

void BarrierLedger::barrier(GLbitfield bits, const std::string& site) {
  if (bits == GL_ALL_BARRIER_BITS) return;
  const std::string* by = &*sites_.insert(site).first;
  for (GLbitfield left = bits; left != 0; left &= left - 1) ++barriers_[{site, left & (0u - left)}].issued;
  for (const Resource& resource : open_) {
    State& s = states_.at(resource);
    cover(s.written, bits, by);
    cover(s.accessed, bits, by);
  }
}

void BarrierLedger::report(std::string finding) { ++findings_[std::move(finding)]; }

std::vector<std::string> BarrierLedger::takeFindings() {
  std::vector<std::string> result;
  for (const auto& [finding, count] : findings_)
    result.push_back(count == 1 ? finding : fmt::format("{} ({} times)", finding, count));
  findings_.clear();
  return result;
}

}  // namespace lucerna::gl
