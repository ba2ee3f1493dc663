// The barrier ledger: without a GPU, finds what a GPU would not forgive.
//
// Shader writes to storage blocks and images are ordered with other accesses by glMemoryBarrier alone [OpenGL 4.3,
// 7.12.2]. Mesa's software renderer runs work groups one after another over coherent memory and forgives a missing
// barrier; GPUs do not. The ledger records for every buffer and texture the last shader write, the reads since, and
// the barriers after both. An access that lacks its barrier bit is a finding that names the resource, the writer or
// reader before, the access, and the bit:
//   RAW  a read after a shader write             the bit of the read
//   WAW  a write after a shader write            the bit of the write
//   WAR  a shader write after an access          the storage or image bit; the access is of a draw or dispatch, as
//                                                calls of the API end in order
// and, beside barriers: a texture sampled while it is attached (feedback), a resource accessed in two ways in one draw
// or dispatch (aliasing), nothing bound where a program reads or writes.
//
// It replaces entry points as they are loaded (host/gl_procs.hpp), so that a program without it runs none of it.
// It is on in debug builds, in tests, and with `--check-barriers` or LUCERNA_CHECK_BARRIERS=1.
//
// Exceptions are declared in the shader, with the reason; NAME is the storage block or image:
//   // unordered NAME: each dispatch writes the rows of its own chunk
//   // aliased NAME: an invocation reads its own cell before it writes it
// unordered: runs of the program within one pass need no barrier among themselves. aliased: the resource may be bound a
// second time in the same run.
//
// A barrier of all kinds (GL_ALL_BARRIER_BITS) is a workaround for a driver and covers nothing here.
#pragma once

#include "host/api.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lucerna::gl {

/// The rules, without OpenGL.
class BarrierLedger {
 public:
  enum class Kind { buffer, texture };
  using Resource = std::pair<Kind, GLuint>;

  /// One access of a draw, a dispatch or an API call.
  struct Access {
    Resource resource;
    GLbitfield bit = 0;  ///< GL_..._BARRIER_BIT of this way of access
    bool reads = false, writes = false;
    bool byShader = true;  ///< false: by the API or an attachment, which OpenGL orders among themselves
    std::string how;  ///< "storage block Slots", "glBufferSubData"
    bool unordered = false, aliased = false;  ///< declared
  };

  void name(Resource resource, std::string label);
  void forget(Resource resource);
  /// All of the resource was overwritten by the API: earlier shader writes are gone.
  void overwritten(Resource resource);
  /// Accesses of one command, at the same time. run: 0 for API calls, else one number per program and pass, within
  /// which `unordered` holds.
  void access(const std::string& command, std::uint64_t run, const std::vector<Access>& accesses);
  /// A barrier; site: the pass that issues it.
  void barrier(GLbitfield bits, const std::string& site);
  void report(std::string finding);

  /// Findings since the last call, each once with its number of occurrences.
  std::vector<std::string> takeFindings();

  /// How often a pass issued a barrier bit, and how often an access depended on it alone.
  struct Use {
    long issued = 0, needed = 0;
  };
  const std::map<std::pair<std::string, GLbitfield>, Use>& barriers() const { return barriers_; }
  /// Barriers of these bits by this pass are neither counted nor issued, as if they were missing in the source.
  void omit(const std::string& site, GLbitfield bits) { omitted_[site] |= bits; }
  void omitNothing() { omitted_.clear(); }
  /// `bits` without those omitted.
  GLbitfield issued(GLbitfield bits, const std::string& site) const;

 private:
  static constexpr int kBits = 32;
  /// The barriers since an access: per bit the one pass that issued it, or several.
  struct Event {
    bool open = false;  ///< there was such an access
    std::string by;
    std::uint64_t unorderedWithin = 0;  ///< run
    std::vector<const std::string*> covers;  ///< per bit; null: none
  };
  struct State {
    std::string label;
    Event written, accessed;  ///< by a shader; any access since that write
  };
  State& state(Resource resource);
  void require(const Event& event, const Access& access, std::uint64_t run, const std::string& label,
               const char* hazard, const std::string& command);
  void cover(Event& event, GLbitfield bits, const std::string* site);

  std::map<Resource, State> states_;
  std::set<Resource> open_;  ///< with events that barriers can cover
  std::set<std::string> sites_;
  std::map<std::pair<std::string, GLbitfield>, Use> barriers_;
  std::map<std::string, GLbitfield> omitted_;
  std::map<std::string, long> findings_;
};

/// "GL_SHADER_STORAGE_BARRIER_BIT".
std::string nameOfBarrierBit(GLbitfield bit);

/// Checks the contexts created from now on.
void checkBarriers();
/// In debug builds, and where LUCERNA_CHECK_BARRIERS is 1; 0 turns it off.
bool barriersCheckedByDefault();
/// The ledger of the current context; null unless barriers are checked.
BarrierLedger* barrierLedger();
/// Names the barrier that comes next, which is none of the current pass.
void nameNextBarrier(const std::string& site);
/// Appends a line per pass and bit to the file LUCERNA_BARRIERS, if set: pass, bit, times issued, times needed, with
/// tabs between. tests/barriers lists those never needed.
void writeBarrierUses();

}  // namespace lucerna::gl
