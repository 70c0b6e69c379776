#include "server/app/command_line.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/auth/token.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

// A variable of the environment for as long as it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    setenv(name, value.c_str(), 1);
  }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

// What a command line came to.
struct Outcome {
  std::variant<Done, ServerOptions> command;
  std::string output;
  std::string errors;

  const ServerOptions& options() const { return std::get<ServerOptions>(command); }
  int exit_code() const {
    return std::holds_alternative<Done>(command) ? std::get<Done>(command).exit_code : -1;
  }
};

Outcome Parse(std::vector<std::string> arguments) {
  std::vector<const char*> argv = {"ccst-server"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  auto command = ParseCommandLine(static_cast<int>(argv.size()), argv.data());
  std::fflush(stdout);
  return {.command = std::move(command),
          .output = testing::internal::GetCapturedStdout(),
          .errors = testing::internal::GetCapturedStderr()};
}

class CommandLineTest : public testing::Test {
 protected:
  TempFolder folder_;
};

TEST_F(CommandLineTest, FlagBeatsVariableBeatsFileBeatsDefault) {
  const std::string file =
      folder_.Write("config", "threads = 2\nmax-queued-jobs = 22\nmax-iterations = 222\n");
  const Variable threads("CCST_THREADS", "3");
  const Variable queued("CCST_MAX_QUEUED_JOBS", "33");
  const Outcome outcome = Parse({"--config", file, "--threads", "4"});
  EXPECT_EQ(outcome.options().threads_per_job, 4);
  EXPECT_EQ(outcome.options().runner.max_queued_jobs, 33);
  EXPECT_EQ(outcome.options().request_limits.max_iterations, 222);
  EXPECT_EQ(outcome.options().request_limits.max_sample_count,
            ServerOptions().request_limits.max_sample_count);
}

TEST_F(CommandLineTest, FileMayComeFromTheEnvironmentAndSetEveryKind) {
  const Variable config("CCST_CONFIG",
                        folder_.Write("config",
                                      "# a comment\nlisten = \"0.0.0.0:0\"\ninsecure = true\n"
                                      "without-proxy = true\n"
                                      "drain-timeout = 1.5\nlog-format = \"json\"\n"));
  const Outcome outcome = Parse({});
  EXPECT_EQ(outcome.options().listen, "0.0.0.0:0");
  EXPECT_TRUE(outcome.options().security.insecure);
  EXPECT_EQ(outcome.options().drain_timeout_seconds, 1.5);
  EXPECT_EQ(outcome.options().log_format, LogFormat::kJson);
}

TEST_F(CommandLineTest, SwitchMayBeTurnedOffAboveTheFile) {
  const std::string file = folder_.Write("config", "insecure = true\n");
  EXPECT_TRUE(Parse({"--config", file}).options().security.insecure);
  EXPECT_FALSE(Parse({"--config", file, "--insecure=false"}).options().security.insecure);
  const Variable insecure("CCST_INSECURE", "false");
  EXPECT_FALSE(Parse({"--config", file}).options().security.insecure);
}

TEST_F(CommandLineTest, WrongFileIsAnErrorThatNamesTheKey) {
  const auto errors = [this](const std::string& text) {
    const Outcome outcome = Parse({"--config", folder_.Write("config", text)});
    EXPECT_EQ(outcome.exit_code(), 1) << text;
    return outcome.errors;
  };
  EXPECT_NE(errors("thread = 2\n").find("no such key: thread;"), std::string::npos);
  EXPECT_NE(errors("[server]\nthreads = 2\n").find("server.threads"), std::string::npos);
  for (const char* text :
       {"threads = 2\nthreads = 3\n", "threads = 2\nlisten = \"[::1]:0\"\nthreads = 2\n",
        "threads = [2, 3]\n"}) {
    EXPECT_NE(errors(text).find("threads must have one value"), std::string::npos) << text;
  }
  EXPECT_NE(errors("threads = \"two\"\n").find("--threads"), std::string::npos);
  EXPECT_NE(errors("config = \"x\"\n").find("no such key: config;"), std::string::npos);
  const Outcome missing = Parse({"--config", folder_.Path("none")});
  EXPECT_EQ(missing.exit_code(), 1);
}

TEST_F(CommandLineTest, CheckConfigPrintsWhatAFileCouldSay) {
  const Outcome first = Parse({"--check-config", "--threads", "3", "--log-format", "json",
                               "--max-running-jobs", "5", "--drain-timeout", "0.25"});
  EXPECT_EQ(first.exit_code(), 0) << first.errors;
  EXPECT_NE(first.output.find("threads = 3\n"), std::string::npos) << first.output;
  EXPECT_NE(first.output.find("log-format = \"json\"\n"), std::string::npos) << first.output;
  const Outcome second = Parse({"--check-config", "--config", folder_.Write("c", first.output)});
  EXPECT_EQ(second.output, first.output) << second.errors;
}

TEST_F(CommandLineTest, CheckConfigReadsTheFilesAndShowsNoneOfTheirContents) {
  const std::string line = TokenLine("alice", Scope::kFull, "t");
  const std::string tokens = folder_.Write("tokens", line);
  const Outcome right = Parse({"--check-config", "--auth-token-file", tokens});
  EXPECT_EQ(right.exit_code(), 0) << right.errors;
  EXPECT_EQ(right.output.find("alice"), std::string::npos);
  EXPECT_EQ(right.output.find(line.substr(line.rfind(' ') + 1)), std::string::npos);
  folder_.Write("tokens", "nonsense\n");
  const Outcome wrong = Parse({"--check-config", "--auth-token-file", tokens});
  EXPECT_EQ(wrong.exit_code(), 1);
  EXPECT_EQ(wrong.output, "");
  EXPECT_NE(wrong.errors.find("--auth-token-file: line 1"), std::string::npos) << wrong.errors;
}

TEST_F(CommandLineTest, OtherMachinesNeedTlsOrInsecure) {
  const Outcome refused = Parse({"--listen", "0.0.0.0:0"});
  EXPECT_EQ(refused.exit_code(), 1);
  for (const char* advice : {"--tls-cert", "--insecure", "127.0.0.1"}) {
    EXPECT_NE(refused.errors.find(advice), std::string::npos) << refused.errors;
  }
  EXPECT_EQ(Parse({"--listen", "0.0.0.0:0", "--insecure", "--without-proxy"}).exit_code(), -1);
  EXPECT_EQ(Parse({"--listen", "[::]:0", "--tls-cert", "c", "--tls-key", "k", "--without-proxy"})
                .exit_code(),
            -1);
  EXPECT_EQ(Parse({"--listen", "0.0.0.0:0", "--auth-token-file", "t"}).exit_code(), 1);
  const Outcome metrics = Parse({"--metrics-listen", "0.0.0.0:0"});
  EXPECT_EQ(metrics.exit_code(), 1);
  EXPECT_NE(metrics.errors.find("--metrics-listen 0.0.0.0:0"), std::string::npos);
  EXPECT_EQ(Parse({"--metrics-listen", "127.0.0.1:0"}).exit_code(), -1);
}

TEST_F(CommandLineTest, OtherMachinesNeedAProxyOrSayWhatIsLacking) {
  const Outcome refused = Parse({"--listen", "0.0.0.0:0", "--insecure"});
  EXPECT_EQ(refused.exit_code(), 1);
  for (const char* advice : {"deploy/haproxy", "--proxy-socket", "--without-proxy", "how often"}) {
    EXPECT_NE(refused.errors.find(advice), std::string::npos) << refused.errors;
  }
  EXPECT_EQ(Parse({"--listen", "[::]:0", "--tls-cert", "c", "--tls-key", "k"}).exit_code(), 1);
  // Encryption is another matter.
  EXPECT_EQ(Parse({"--listen", "0.0.0.0:0", "--without-proxy"}).exit_code(), 1);
  EXPECT_EQ(Parse({"--listen", "127.0.0.1:0", "--proxy-socket", "/run/ccst/p.sock"}).exit_code(),
            -1);
  EXPECT_EQ(Parse({"--proxy-socket", std::string(108, 'p')}).exit_code(), 1);
}

TEST_F(CommandLineTest, LimitsOfConnectionsAreSettings) {
  const Outcome outcome = Parse({"--max-connections", "50", "--max-connections-per-address", "20"});
  const GateOptions gate = outcome.options().ConnectionOptions(1'000'000);
  EXPECT_EQ(gate.max_connections, 50);
  EXPECT_EQ(gate.max_connections_per_address, 20);
  EXPECT_EQ(Parse({"--max-connections", "0"}).exit_code(), 1);
  EXPECT_EQ(Parse({"--max-connections-per-address", "0"}).exit_code(), 1);
}

// Three for each connection, with half of few, or a thousand, for everything else.
TEST_F(CommandLineTest, FewDescriptorsMeanFewerConnections) {
  const ServerOptions options;
  EXPECT_EQ(options.ConnectionOptions(1'000'000).max_connections, 2048);
  EXPECT_EQ(options.ConnectionOptions(4096).max_connections, 1024);
  EXPECT_EQ(options.ConnectionOptions(1024).max_connections, 170);
  EXPECT_EQ(options.ConnectionOptions(1024).max_connections_per_address, 85);
  EXPECT_EQ(options.ConnectionOptions(128).max_connections, 21);
  EXPECT_EQ(options.ConnectionOptions(0).max_connections, 1);
}

TEST_F(CommandLineTest, TlsFilesGoTogether) {
  EXPECT_EQ(Parse({"--tls-cert", "c"}).exit_code(), 1);
  EXPECT_EQ(Parse({"--tls-key", "k"}).exit_code(), 1);
  EXPECT_EQ(Parse({"--tls-client-ca", "a"}).exit_code(), 1);
  EXPECT_EQ(Parse({"--tls-cert", "c", "--tls-key", "k", "--tls-client-ca", "a"}).exit_code(), -1);
}

TEST_F(CommandLineTest, NewTokenFitsTheLinePrintedWithIt) {
  for (const bool is_read_only : {false, true}) {
    const Outcome outcome = Parse({"--new-token", is_read_only ? "bob:read-only" : "bob"});
    EXPECT_EQ(outcome.exit_code(), 0);
    const std::size_t begin = outcome.output.find("ccst_");
    const std::string token = outcome.output.substr(begin, outcome.output.find('\n') - begin);
    const auto entries = ParseTokens(outcome.output.substr(outcome.output.find("bob")));
    ASSERT_TRUE(entries.ok()) << outcome.output;
    const Caller* caller = FindCaller(*entries, token);
    ASSERT_NE(caller, nullptr) << outcome.output;
    EXPECT_EQ(caller->owner, "bob");
    EXPECT_EQ(caller->scope, is_read_only ? Scope::kReadOnly : Scope::kFull);
  }
  for (const char* wrong : {"a b", "bob:most", ":read-only", "bob:"}) {
    EXPECT_EQ(Parse({"--new-token", wrong}).exit_code(), 1) << wrong;
  }
}

}  // namespace
}  // namespace ccst::server
