#include "server/log/log_stream.h"

#include <csignal>
#include <fstream>
#include <sstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

using std::chrono::milliseconds;

// Two ends, of a pipe or of a socket.
struct Ends {
  explicit Ends(bool is_socket) {
    int ends[2] = {-1, -1};
    const int made = is_socket ? socketpair(AF_UNIX, SOCK_STREAM, 0, ends) : pipe(ends);
    EXPECT_EQ(made, 0);
    reading = ends[0];
    writing = ends[1];
  }
  ~Ends() {
    CloseReading();
    close(writing);
  }
  void CloseReading() {
    if (reading >= 0) close(reading);
    reading = -1;
  }
  // What is there to be read now.
  std::string Read() const {
    fcntl(reading, F_SETFL, O_NONBLOCK);
    std::string text;
    char buffer[1 << 14];
    for (ssize_t got = 0; (got = read(reading, buffer, sizeof buffer)) > 0;) {
      text.append(buffer, static_cast<std::size_t>(got));
    }
    return text;
  }

  int reading = -1;
  int writing = -1;
};

class LogStreamOf : public testing::TestWithParam<bool> {
 protected:
  LogStreamOf() { std::signal(SIGPIPE, SIG_IGN); }
  ~LogStreamOf() override { std::signal(SIGPIPE, SIG_DFL); }
};

TEST_P(LogStreamOf, LinesArriveInOrder) {
  const Ends ends(GetParam());
  LogStream stream(ends.writing);
  stream.Write("one");
  stream.Write("");
  stream.Write("three");
  EXPECT_EQ(ends.Read(), "one\n\nthree\n");
  EXPECT_EQ(stream.lost_lines(), 0);
  EXPECT_TRUE(stream.FlushWithin(milliseconds(0)));
}

// Would hang where a write waited for somebody to read.
TEST_P(LogStreamOf, NobodyWhoReadsCostsMemoryOnlyUpToABound) {
  const Ends ends(GetParam());
  LogStream stream(ends.writing, 100'000);
  const std::string line(999, 'x');
  constexpr int kLines = 3000;
  for (int i = 0; i < kLines; ++i) stream.Write(line);
  EXPECT_FALSE(stream.FlushWithin(milliseconds(1)));
  const std::int64_t lost = stream.lost_lines();
  EXPECT_GT(lost, 0);
  // What was not lost is in order and whole, however often the reader comes back.
  std::string text;
  for (std::string more = ends.Read(); !more.empty(); more = ends.Read()) {
    text += more;
    stream.Flush();
  }
  EXPECT_TRUE(stream.FlushWithin(milliseconds(0)));
  EXPECT_EQ(text.size() % 1000, 0U);
  EXPECT_EQ(static_cast<std::int64_t>(text.size()) / 1000, kLines - lost);
  EXPECT_EQ(text.find("\n\n"), std::string::npos);
  // It goes on.
  stream.Write("again");
  EXPECT_EQ(ends.Read(), "again\n");
  EXPECT_EQ(stream.lost_lines(), lost);
}

TEST_P(LogStreamOf, ReaderThatIsGoneLosesLinesAndNothingElse) {
  Ends ends(GetParam());
  LogStream stream(ends.writing);
  stream.Write("read");
  ends.CloseReading();
  for (int i = 0; i < 10; ++i) stream.Write("lost");
  EXPECT_EQ(stream.lost_lines(), 10);
  EXPECT_TRUE(stream.FlushWithin(milliseconds(0)));
}

TEST_P(LogStreamOf, WhatWasGivenKeepsItsMode) {
  const Ends ends(GetParam());
  const LogStream stream(ends.writing);
  EXPECT_EQ(fcntl(ends.writing, F_GETFL) & O_NONBLOCK, 0);
}

INSTANTIATE_TEST_SUITE_P(PipeAndSocket, LogStreamOf, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Socket" : "Pipe"; });

TEST(LogStream, FileIsWrittenBehindWhatOthersWrite) {
  const TempFolder folder;
  const std::string path = folder.Path("log");
  const int file = open(path.c_str(), O_CREAT | O_WRONLY, 0600);
  LogStream stream(file);
  stream.Write("one");
  ASSERT_EQ(write(file, "two\n", 4), 4);
  stream.Write("three");
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "one\ntwo\nthree\n");
  close(file);
}

TEST(LogStream, DescriptorThatIsClosedLosesLines) {
  LogStream stream(-1);
  stream.Write("lost");
  EXPECT_EQ(stream.lost_lines(), 1);
}

}  // namespace
}  // namespace ccst::server
