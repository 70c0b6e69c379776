#include "tests/interleavings/server_process.h"

#include <csignal>
#include <cstdlib>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"

extern char** environ;

namespace ccst::interleavings {
namespace {

// What follows `prefix` on the next line of the pipe; empty when there is another line or none.
std::string LineAfter(int pipe, const std::string& prefix) {
  std::string line;
  char byte = 0;
  while (read(pipe, &byte, 1) == 1 && byte != '\n') line += byte;
  return line.compare(0, prefix.size(), prefix) == 0 ? line.substr(prefix.size()) : std::string();
}

// The answer to a GET of the page; empty when there is none.
std::string Fetch(const std::string& address, const std::string& path) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(address, ':');
  sockaddr_in target = {};
  target.sin_family = AF_INET;
  int port = 0;
  if (!absl::SimpleAtoi(parts.second, &port)) return "";
  target.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, parts.first.c_str(), &target.sin_addr) != 1) return "";
  const int socket_number = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_number < 0) return "";
  std::string page;
  const std::string request = absl::StrCat("GET ", path, " HTTP/1.0\r\n\r\n");
  const auto size = static_cast<ssize_t>(request.size());
  if (connect(socket_number, reinterpret_cast<const sockaddr*>(&target), sizeof target) == 0 &&
      send(socket_number, request.data(), request.size(), MSG_NOSIGNAL) == size) {
    char piece[4096];
    ssize_t count = 0;
    while ((count = recv(socket_number, piece, sizeof piece, 0)) > 0) {
      page.append(piece, static_cast<std::size_t>(count));
    }
  }
  close(socket_number);
  return page;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ServerProcess>> ServerProcess::Start(
    const std::string& program, const std::vector<std::string>& flags) {
  std::vector<std::string> words = {program, "--listen", "127.0.0.1:0", "--metrics-listen",
                                    "127.0.0.1:0"};
  words.insert(words.end(), flags.begin(), flags.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) return absl::InternalError("no pipe can be made");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t process = -1;
  const int failed =
      posix_spawn(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::unique_ptr<ServerProcess> server;
  if (failed == 0) {
    server.reset(new ServerProcess(process));
    server->address_ = LineAfter(ends[0], "listening on ");
    server->metrics_address_ = LineAfter(ends[0], "metrics on ");
  }
  close(ends[0]);
  if (server != nullptr && !server->metrics_address_.empty()) return server;
  return absl::InternalError(program + " does not start");
}

ServerProcess::~ServerProcess() {
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

absl::StatusOr<double> ServerProcess::Gauge(const std::string& name) const {
  const std::string page = Fetch(metrics_address_, "/metrics");
  if (page.empty()) return absl::UnavailableError("the page of metrics does not answer");
  const std::size_t line = page.find("\n" + name + " ");
  double value = 0.0;
  if (line != std::string::npos &&
      absl::SimpleAtod(page.substr(line + name.size() + 2,
                                   page.find_first_of("\r\n", line + 1) - line - name.size() - 2),
                       &value)) {
    return value;
  }
  return absl::NotFoundError("there is no metric " + name);
}

}  // namespace ccst::interleavings
