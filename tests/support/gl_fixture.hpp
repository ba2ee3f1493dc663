// A GL context for tests: OSMesa, made once an executable. Any OpenGL error fails the test in which it happens.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "host/host.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace lucerna::test {

class GlTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (host()) return;
    host() = Host::create(HostKind::osmesa);
    context_() = std::make_unique<gl::Context>();
  }
  void SetUp() override { context().takeErrors(); }
  void TearDown() override {
    for (const std::string& error : context().takeErrors()) ADD_FAILURE() << "OpenGL error: " << error;
  }

  static gl::Context& context() { return *context_(); }
  static const gl::Capabilities& capabilities() { return context().capabilities(); }
  gl::ProgramLibrary& programs() { return programs_; }

 private:
  friend class GlEnvironment;
  static std::unique_ptr<Host>& host() {
    static std::unique_ptr<Host> instance;
    return instance;
  }
  static std::unique_ptr<gl::Context>& context_() {
    static std::unique_ptr<gl::Context> instance;
    return instance;
  }
  gl::ProgramLibrary programs_;
};

/// Ends the context before the program's exit handlers run: OSMesa brings LLVM along, whose static objects are gone by the time
/// our own are destroyed, and a context that still holds compiled compute shaders would then crash.
class GlEnvironment : public ::testing::Environment {
 public:
  void TearDown() override {
    GlTest::context_().reset();
    GlTest::host().reset();
  }
};
inline ::testing::Environment* const kGlEnvironment = ::testing::AddGlobalTestEnvironment(new GlEnvironment);

}  // namespace lucerna::test
