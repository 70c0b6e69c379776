#include "server/net/frame_guard.h"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/net/frames.h"

namespace ccst::server {
namespace {

const std::string kBeginning = kHttp2Preface + MakeSettings();

// What a guard makes of a whole exchange, with a clock that jumps to when it may go on.
struct Outcome {
  std::string passed;
  std::string offence;
  double seconds = 0.0;
};

Outcome Pass(FrameGuard& guard, const std::string& bytes, std::size_t piece, double begin = 100.0) {
  Outcome outcome;
  double now = begin;
  std::string waiting;
  for (std::size_t at = 0; at < bytes.size() && outcome.offence.empty(); at += piece) {
    waiting += bytes.substr(at, piece);
    while (!waiting.empty()) {
      const FrameGuard::Verdict verdict = guard.Inspect(waiting, now);
      outcome.offence = std::string(verdict.offence);
      if (!outcome.offence.empty()) break;
      outcome.passed += waiting.substr(0, verdict.allowed);
      waiting.erase(0, verdict.allowed);
      if (waiting.empty()) break;
      EXPECT_GT(verdict.resume_at, now);
      now = verdict.resume_at;
    }
  }
  outcome.seconds = now - begin;
  return outcome;
}

Outcome Pass(const std::string& bytes, std::size_t piece = 1 << 20) {
  FrameGuard guard({});
  return Pass(guard, bytes, piece);
}

std::string Repeat(int count, const std::function<std::string(int)>& make) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += make(i);
  return bytes;
}

std::string Calls(int count) {
  return Repeat(count, [](int i) {
    const auto stream = static_cast<std::uint32_t>(2 * i + 1);
    return MakeHeaders(stream, "headers") + MakeData(stream, "request", true);
  });
}

TEST(FrameGuard, OrdinaryCallsPassAtOnceAndUnchanged) {
  const std::string bytes = kBeginning + Calls(2000) + MakeData(1, std::string(1 << 20, 'm')) +
                            MakePing() + MakeReset(1) + MakeFrame(8, 0, 0, "1234");
  for (const std::size_t piece : {1 << 20, 4096, 7, 1}) {
    const Outcome outcome = Pass(bytes, piece);
    EXPECT_EQ(outcome.offence, "");
    EXPECT_EQ(outcome.passed, bytes);
    EXPECT_EQ(outcome.seconds, 0.0);
  }
}

TEST(FrameGuard, KnowsWhenHttp2HasBegunAndSomethingIsAsked) {
  FrameGuard guard({});
  guard.Inspect(std::string(kHttp2Preface), 0.0);
  EXPECT_FALSE(guard.has_begun());
  guard.Inspect(MakeSettings(), 0.0);
  EXPECT_TRUE(guard.has_begun());
  EXPECT_FALSE(guard.has_requests());
  guard.Inspect(MakeHeaders(1, "headers"), 0.0);
  EXPECT_TRUE(guard.has_requests());
}

TEST(FrameGuard, WhatIsNotHttp2IsRefusedWithTheFirstWrongByte) {
  for (const std::string wrong :
       {"GET / HTTP/1.1\r\n\r\n", "PRI * HTTP/2.0\r\n\r\nSM\r\n\rX", "\x16\x03\x01"}) {
    EXPECT_EQ(Pass(wrong).offence, "no HTTP/2") << wrong;
    EXPECT_EQ(Pass(wrong, 1).offence, "no HTTP/2") << wrong;
  }
}

TEST(FrameGuard, ResetsOfAWholeConnectionPassAtOnce) {
  const Outcome outcome = Pass(kBeginning + Calls(1024) + Repeat(1024, [](int i) {
                                 return MakeReset(static_cast<std::uint32_t>(2 * i + 1));
                               }));
  EXPECT_EQ(outcome.seconds, 0.0);
}

TEST(FrameGuard, RapidResetsAreSlowedDownAndNoneIsLost) {
  const std::string bytes = kBeginning + Repeat(3000, [](int i) {
                              const auto stream = static_cast<std::uint32_t>(2 * i + 1);
                              return MakeHeaders(stream, "h") + MakeReset(stream);
                            });
  for (const std::size_t piece : {1 << 20, 1000, 1}) {
    const Outcome outcome = Pass(bytes, piece);
    EXPECT_EQ(outcome.passed, bytes);
    EXPECT_NEAR(outcome.seconds, (3000 - 1024) / 100.0, 0.1);
  }
}

// A client can make the server reset streams, as by a window that overflows.
TEST(FrameGuard, ResetsByTheServerCountToo) {
  FrameGuard guard({});
  ASSERT_EQ(guard.Inspect(kBeginning, 0.0).allowed, kBeginning.size());
  const std::string resets =
      Repeat(2024, [](int i) { return MakeReset(static_cast<std::uint32_t>(2 * i + 1)); });
  for (const char byte : resets) guard.InspectAnswer({&byte, 1}, 0.0);
  const FrameGuard::Verdict verdict = guard.Inspect(Calls(1), 0.0);
  EXPECT_EQ(verdict.allowed, 0U);
  EXPECT_NEAR(verdict.resume_at, 10.0, 0.1);
}

TEST(FrameGuard, ResetsAreChargedToTheAddressToo) {
  int taken = 0;
  FrameGuard guard([&taken](double now) {
    ++taken;
    return now + 3.0;
  });
  const Outcome outcome = Pass(guard, kBeginning + MakeReset(1) + MakeReset(3), 1 << 20);
  EXPECT_EQ(taken, 2);
  EXPECT_EQ(outcome.seconds, 6.0);
}

TEST(FrameGuard, FramesThatCarryNothingAreSlowedDown) {
  const std::vector<std::string> empty = {
      MakeSettings(),
      MakePing(),
      MakeData(1, ""),
      MakeFrame(2, 0, 1, "12345"),
      MakeFrame(7, 0, 0, "12345678"),
      MakeFrame(6, 1, 0, "12345678"),
      MakeFrame(0xfa, 0, 1, "unknown"),
  };
  for (const std::string& frame : empty) {
    const std::string bytes = kBeginning + Repeat(2000, [&frame](int) { return frame; });
    const Outcome outcome = Pass(bytes, 4096);
    EXPECT_EQ(outcome.offence, "");
    EXPECT_EQ(outcome.passed, bytes);
    EXPECT_NEAR(outcome.seconds, 1000 / 200.0, 0.1) << static_cast<int>(frame[3]);
  }
}

TEST(FrameGuard, EndOfARequestIsNotAFrameThatCarriesNothing) {
  EXPECT_EQ(Pass(kBeginning + Repeat(5000, [](int) { return MakeData(1, "", true); })).seconds, 0);
}

TEST(FrameGuard, TinyFramesAreSlowedDownFarAboveWhatCallersDo) {
  const std::string update = MakeFrame(8, 0, 0, "1234");
  for (const std::string& frame : {update, MakeData(1, "a"), MakeHeaders(1, "h")}) {
    const Outcome outcome =
        Pass(kBeginning + Repeat(60'000, [&frame](int) { return frame; }), 1 << 16);
    EXPECT_NEAR(outcome.seconds, 2.0, 0.1);
  }
}

TEST(FrameGuard, LongestBlockOfHeadersPasses) {
  const std::string half(FrameGuard::kMaxHeaderBytes / 2, 'h');
  const std::string bytes =
      kBeginning + MakeHeaders(1, half, false) + MakeContinuation(1, half, true) + Calls(1);
  EXPECT_EQ(Pass(bytes).offence, "");
  EXPECT_EQ(Pass(bytes).passed, bytes);
}

TEST(FrameGuard, EndlessBlocksOfHeadersAreRefused) {
  const std::string half(FrameGuard::kMaxHeaderBytes / 2, 'h');
  const std::vector<std::string> endless = {
      MakeHeaders(1, half, false) + MakeContinuation(1, half + "h", true),
      MakeHeaders(1, half + half + "h"),
      MakeHeaders(1, "", false) + Repeat(9, [](int) { return MakeContinuation(1, ""); }),
      MakeHeaders(1, "h", false) + Repeat(9, [](int) { return MakeContinuation(1, "h"); }),
  };
  for (const std::string& bytes : endless) {
    EXPECT_EQ(Pass(kBeginning + bytes).offence, "an endless block of headers");
    EXPECT_EQ(Pass(kBeginning + bytes, 1).offence, "an endless block of headers");
  }
}

TEST(FrameGuard, NothingMayInterruptABlockOfHeaders) {
  const std::string open = kBeginning + MakeHeaders(1, "h", false);
  for (const std::string& frame : {MakeData(1, "d"), MakePing(), MakeHeaders(3, "h"),
                                   MakeContinuation(3, "h"), MakeReset(1)}) {
    EXPECT_NE(Pass(open + frame).offence, "") << static_cast<int>(frame[3]);
  }
  EXPECT_NE(Pass(kBeginning + MakeContinuation(1, "h")).offence, "");
  EXPECT_NE(Pass(kBeginning + MakeFrame(5, 4, 1, "h")).offence, "");
}

// Any bytes in any pieces: what passes is a prefix, and pieces change nothing.
TEST(FrameGuard, PiecesDoNotChangeTheVerdict) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::string bytes = kBeginning;
    for (int i = 0; i < 40; ++i) {
      bytes += MakeFrame(static_cast<int>(random() % 11), static_cast<int>(random() % 8),
                         random() % 4, std::string(random() % 300, 'x'));
    }
    const Outcome whole = Pass(bytes);
    const Outcome pieces = Pass(bytes, 1 + random() % 20);
    EXPECT_EQ(pieces.offence, whole.offence);
    EXPECT_EQ(bytes.substr(0, pieces.passed.size()), pieces.passed);
    if (whole.offence.empty()) {
      EXPECT_EQ(pieces.passed, bytes);
    }
  }
}

}  // namespace
}  // namespace ccst::server
