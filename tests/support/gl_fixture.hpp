// A GL context for tests: by testHost(), made once an executable. Any OpenGL error, and any finding of the
// barrier ledger, fails the test in which it happens.
#pragma once

#include "gl/barrier_ledger.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "host/host.hpp"
#include "support/test_host.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace lucerna::test {

class GlTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (host()) return;
    gl::checkBarriers();
    host() = Host::create(testHost(), {.windowVisible = false});
    context_() = std::make_unique<gl::Context>(gl::DebugOutput::synchronous);
    ::testing::UnitTest::GetInstance()->listeners().Append(new EndOfProgram);
  }
  void SetUp() override { context().takeErrors(); }
  void TearDown() override {
    for (const std::string& error : context().takeErrors()) ADD_FAILURE() << "OpenGL error: " << error;
  }

  static gl::Context& context() { return *context_(); }
  /// Of all suites of this process, made when it is first asked for.
  static gl::ProgramLibrary& library() {
    if (!library_()) library_() = std::make_unique<gl::ProgramLibrary>();
    return *library_();
  }
  static const gl::Capabilities& capabilities() { return context().capabilities(); }
  gl::ProgramLibrary& programs() { return programs_; }

 private:
  /// Ends the context before main() does: later, among the destructors of statics, those of the driver have run
  /// already.
  struct EndOfProgram : ::testing::EmptyTestEventListener {
    void OnTestProgramEnd(const ::testing::UnitTest&) override {
      gl::writeBarrierUses();
      library_().reset();
      context_().reset();
      host().reset();
    }
  };
  static std::unique_ptr<Host>& host() {
    static std::unique_ptr<Host> instance;
    return instance;
  }
  static std::unique_ptr<gl::Context>& context_() {
    static std::unique_ptr<gl::Context> instance;
    return instance;
  }
  static std::unique_ptr<gl::ProgramLibrary>& library_() {
    static std::unique_ptr<gl::ProgramLibrary> instance;
    return instance;
  }
  gl::ProgramLibrary programs_;
};

/// Programs are compiled once a process, for suites that make many objects of few kinds.
class SharedProgramsTest : public GlTest {
 protected:
  static gl::ProgramLibrary& programs() { return library(); }
};

}  // namespace lucerna::test
