// The rules of the barrier ledger [OpenGL 4.3, 7.12.2], without OpenGL: which sequence of accesses lacks which bit.
#include "gl/barrier_ledger.hpp"

#include <gtest/gtest.h>

namespace lucerna::gl {
namespace {

using MemoryAccess = BarrierLedger::Access;
const BarrierLedger::Resource kBuffer{BarrierLedger::Kind::buffer, 1}, kTexture{BarrierLedger::Kind::texture, 1};

MemoryAccess storage(bool reads, bool writes) {
  return {kBuffer, GL_SHADER_STORAGE_BARRIER_BIT, reads, writes, true, "storage block B"};
}
MemoryAccess fetch() { return {kBuffer, GL_TEXTURE_FETCH_BARRIER_BIT, true, false, true, "sampler S"}; }
MemoryAccess update(bool writes) {
  return {kBuffer, GL_BUFFER_UPDATE_BARRIER_BIT, !writes, writes, false, "its target"};
}
MemoryAccess sampled() { return {kTexture, GL_TEXTURE_FETCH_BARRIER_BIT, true, false, true, "sampler S"}; }
MemoryAccess stored() { return {kTexture, GL_SHADER_IMAGE_ACCESS_BARRIER_BIT, false, true, true, "image I"}; }
MemoryAccess attached() { return {kTexture, GL_FRAMEBUFFER_BARRIER_BIT, false, true, false, "attachment"}; }

std::vector<std::string> after(const std::vector<MemoryAccess>& accesses, GLbitfield barrier = 0) {
  BarrierLedger ledger;
  ledger.name(kBuffer, "cells");
  ledger.name(kTexture, "picture");
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    if (i > 0 && barrier != 0) ledger.barrier(barrier, "pass");
    const bool api = accesses[i].bit == GL_BUFFER_UPDATE_BARRIER_BIT;
    ledger.access("command " + std::to_string(i), api ? 0u : i + 1, {accesses[i]});
  }
  return ledger.takeFindings();
}

TEST(BarrierLedger, EachAccessAfterAShaderWriteNeedsTheBitOfItsKind) {
  const std::vector<std::pair<MemoryAccess, GLbitfield>> uses{{storage(true, false), GL_SHADER_STORAGE_BARRIER_BIT},
                                                              {storage(false, true), GL_SHADER_STORAGE_BARRIER_BIT},
                                                              {fetch(), GL_TEXTURE_FETCH_BARRIER_BIT},
                                                              {update(false), GL_BUFFER_UPDATE_BARRIER_BIT},
                                                              {update(true), GL_BUFFER_UPDATE_BARRIER_BIT}};
  for (const auto& [use, bit] : uses) {
    EXPECT_TRUE(after({storage(false, true), use}, bit).empty()) << nameOfBarrierBit(bit);
    const GLbitfield others = ~bit & ~static_cast<GLbitfield>(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    const auto findings = after({storage(false, true), use}, others);
    ASSERT_EQ(findings.size(), 1u) << nameOfBarrierBit(bit);
    EXPECT_NE(findings[0].find(nameOfBarrierBit(bit)), std::string::npos) << findings[0];
  }
}

TEST(BarrierLedger, AFindingNamesResourceWriterReaderAndBit) {
  EXPECT_EQ(after({storage(false, true), fetch()}),
            std::vector<std::string>{"RAW: 'cells' was written by command 0 as storage block B; then command 1 "
                                     "accesses it as sampler S without GL_TEXTURE_FETCH_BARRIER_BIT"});
  EXPECT_EQ(after({sampled(), stored()}),
            std::vector<std::string>{"WAR: 'picture' was accessed by command 0 as sampler S; then command 1 "
                                     "accesses it as image I without GL_SHADER_IMAGE_ACCESS_BARRIER_BIT"});
}

TEST(BarrierLedger, AShaderWriteWaitsForEveryEarlierAccess) {
  for (const MemoryAccess& earlier : {sampled(), attached()}) {
    EXPECT_EQ(after({earlier, stored()}).size(), 1u);
    EXPECT_TRUE(after({earlier, stored()}, GL_SHADER_IMAGE_ACCESS_BARRIER_BIT).empty());
  }
}

TEST(BarrierLedger, OpenGlOrdersTheRest) {
  EXPECT_TRUE(after({attached(), sampled(), attached()}).empty());
  EXPECT_TRUE(after({update(true), storage(false, true)}).empty());
  EXPECT_TRUE(after({update(true), storage(true, false), update(true), fetch()}).empty());
}

TEST(BarrierLedger, ABarrierBeforeTheWriteDoesNotCount) {
  BarrierLedger ledger;
  ledger.barrier(GL_TEXTURE_FETCH_BARRIER_BIT, "pass");
  ledger.access("writer", 1, {storage(false, true)});
  ledger.access("reader", 2, {fetch()});
  EXPECT_EQ(ledger.takeFindings().size(), 1u);
}

TEST(BarrierLedger, ABarrierOfAllKindsIsAWorkaroundAndCoversNothing) {
  EXPECT_EQ(after({storage(false, true), fetch()}, GL_ALL_BARRIER_BITS).size(), 1u);
}

TEST(BarrierLedger, WhatTheApiOverwritesIsNoLongerTheShaders) {
  BarrierLedger ledger;
  ledger.access("writer", 1, {storage(false, true)});
  ledger.overwritten(kBuffer);
  ledger.access("reader", 2, {fetch()});
  EXPECT_TRUE(ledger.takeFindings().empty());
}

TEST(BarrierLedger, AnUnorderedBlockIsExemptWithinItsProgramAlone) {
  BarrierLedger ledger;
  MemoryAccess chunk = storage(true, true);
  chunk.unordered = true;
  ledger.access("chunk", 7, {chunk});
  ledger.access("chunk", 7, {chunk});
  EXPECT_TRUE(ledger.takeFindings().empty());
  ledger.access("another program", 8, {chunk});
  EXPECT_EQ(ledger.takeFindings().size(), 1u);
}

TEST(BarrierLedger, TwoWaysToOneResourceInOneDrawAreNamed) {
  BarrierLedger ledger;
  ledger.access("draw", 1, {sampled(), attached()});
  ASSERT_EQ(ledger.takeFindings().at(0).find("feedback: "), 0u);
  ledger.forget(kBuffer);
  ledger.access("dispatch", 1, {fetch(), storage(false, true)});
  EXPECT_EQ(ledger.takeFindings().at(0).find("aliasing: "), 0u);
}

TEST(BarrierLedger, KnowsWhichBarriersAnAccessDependedOn) {
  BarrierLedger ledger;
  ledger.access("writer", 1, {storage(false, true)});
  ledger.barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT, "first");
  ledger.access("reader", 2, {fetch()});
  ledger.access("writer", 1, {MemoryAccess(storage(false, true))});
  const auto use = [&](const char* site, GLbitfield bit) { return ledger.barriers().at({site, bit}); };
  EXPECT_EQ(use("first", GL_TEXTURE_FETCH_BARRIER_BIT).needed, 1);
  EXPECT_EQ(use("first", GL_COMMAND_BARRIER_BIT).needed, 0);
  EXPECT_EQ(use("first", GL_COMMAND_BARRIER_BIT).issued, 1);
  // Of two barriers neither is needed by itself.
  ledger.takeFindings();
  ledger.access("writer", 1, {});
  ledger.barrier(GL_TEXTURE_FETCH_BARRIER_BIT, "first");
  ledger.barrier(GL_TEXTURE_FETCH_BARRIER_BIT, "second");
  ledger.access("reader", 2, {fetch()});
  EXPECT_EQ(use("first", GL_TEXTURE_FETCH_BARRIER_BIT).needed, 1);
  EXPECT_EQ(use("second", GL_TEXTURE_FETCH_BARRIER_BIT).needed, 0);
}

TEST(BarrierLedger, AnOmittedBarrierIsMissing) {
  BarrierLedger ledger;
  ledger.omit("pass", GL_TEXTURE_FETCH_BARRIER_BIT);
  EXPECT_EQ(ledger.issued(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT, "pass"), GL_COMMAND_BARRIER_BIT + 0u);
  EXPECT_EQ(ledger.issued(GL_TEXTURE_FETCH_BARRIER_BIT, "another"), GL_TEXTURE_FETCH_BARRIER_BIT + 0u);
}

}  // namespace
}  // namespace lucerna::gl
