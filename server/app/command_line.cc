#include "server/app/command_line.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/printable_text.h"
#include "core/base/version.h"
#include "server/app/health_check.h"
#include "server/app/thread_limits.h"
#include "server/auth/token.h"

namespace ccst::server {
namespace {

constexpr int kUsageError = 1;
constexpr std::int64_t kMaxThreadsLookedAt = 1'000'000;
constexpr char kReadOnlySuffix[] = ":read-only";

const std::map<std::string, LogFormat> kLogFormats = {{"text", LogFormat::kText},
                                                      {"json", LogFormat::kJson}};

std::string Show(const std::string& value) {
  return absl::StrCat("\"", absl::CEscape(value), "\"");
}
std::string Show(bool value) { return value ? "true" : "false"; }
std::string Show(LogFormat value) {
  return Show(std::string(value == LogFormat::kJson ? "json" : "text"));
}
template <typename Number>
std::string Show(Number value) {
  return absl::StrCat(value);
}

std::string Variable(const std::string& name) {
  std::string variable = "CCST_" + name;
  for (char& c : variable) {
    c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return variable;
}

// The flags of the server, by the names they have without dashes.
class Flags {
 public:
  Flags(CLI::App& app, ServerOptions& options) : app_(app) {
    AddServing(options);
    AddSecurity(options.security);
    AddLimits(options);
  }

  // Sets what neither flag nor variable has set. Throws CLI::ParseError.
  void ReadFile(const std::string& path) {
    std::set<std::string> seen;
    for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_file(path)) {
      if (item.name == "++" || item.name == "--") continue;  // Where a section begins and ends.
      const std::string name = item.fullname();
      if (settings_.count(name) == 0) {
        throw CLI::ConfigError("--config: no such key: " + name +
                               "; the keys are the flags without dashes");
      }
      // Lines that follow each other with the same key arrive as one of two values.
      if (!seen.insert(name).second || item.inputs.size() != 1) {
        throw CLI::ConfigError("--config: " + name + " must have one value");
      }
      CLI::Option& option = *app_.get_option("--" + name);
      if (option.count() > 0) continue;
      option.add_result(item.inputs);
      option.run_callback();
    }
  }

  // The effective settings, in the form of a configuration file.
  std::string ToText() const {
    std::string text;
    for (const auto& [name, show] : settings_) absl::StrAppend(&text, name, " = ", show(), "\n");
    return text;
  }

 private:
  // Adds `--name`, also read from CCST_NAME and from the file.
  template <typename T>
  CLI::Option* Add(const std::string& name, T& value, const std::string& help) {
    settings_[name] = [&value] { return Show(value); };
    return app_.add_option("--" + name, value, help)
        ->envname(Variable(name))
        ->capture_default_str();
  }
  void AddSwitch(const std::string& name, bool& value, const std::string& help) {
    settings_[name] = [&value] { return Show(value); };
    app_.add_flag("--" + name, value, help)->envname(Variable(name));
  }

  void AddServing(ServerOptions& options) {
    Add("listen", options.listen, "HOST:PORT to listen on; port 0 picks a free one");
    Add("proxy-socket", options.proxy_socket,
        "Unix socket for a proxy in front, which says whom it connects (PROXY protocol 2); off by "
        "default");
    Add("data-dir", options.data_dir,
        "Directory for jobs, meshes and results; by default one of the user's")
        ->default_str("$XDG_STATE_HOME/ccst/server");
    Add("metrics-listen", options.metrics_listen,
        "HOST:PORT that serves /metrics to Prometheus; off by default");
    Add("threads", options.threads_per_job, "Threads a job computes on");
    Add("max-running-jobs", options.runner.max_running_jobs,
        "Jobs that compute at once; by default running x threads is the number of cores, as far as "
        "the control group has threads")
        ->default_str("cores / threads");
    Add("drain-timeout", options.drain_timeout_seconds,
        "Seconds that jobs may go on after SIGTERM, SIGINT or SIGHUP");
    Add("log-format", options.log_format, "text or json, on standard error")
        ->transform(CLI::CheckedTransformer(kLogFormats))
        ->default_str("text");
  }

  void AddSecurity(SecurityOptions& security) {
    Add("tls-cert", security.tls.certificate, "Certificate chain (PEM); callers then need TLS");
    Add("tls-key", security.tls.key, "Private key of --tls-cert (PEM)");
    Add("tls-client-ca", security.tls.client_ca,
        "Who vouches for callers (PEM); they then need a certificate");
    Add("auth-token-file", security.auth_token_file,
        "Callers need one of these tokens; lines of --new-token");
    Add("health-cert", security.health_cert,
        "Certificate that --health shows where callers need one (PEM); by default --tls-cert");
    Add("health-key", security.health_key, "Private key of --health-cert (PEM)");
    AddSwitch("insecure", security.insecure,
              "Let other machines connect without encryption, also to the metrics");
    AddSwitch("metrics-insecure", security.metrics_insecure,
              "Let other machines read the metrics, which are never encrypted");
    AddSwitch("without-proxy", security.without_proxy,
              "Let other machines connect without the proxy of deploy/haproxy");
    AddSwitch("reflection", security.reflection,
              "Describe the services to other machines too, not to this one alone");
  }

  void AddLimits(ServerOptions& options) {
    Add("max-connections", options.max_connections,
        "Connections at once; fewer where the process may have few descriptors, 3 for each");
    Add("max-connections-per-address", options.max_connections_per_address,
        "Connections of one address at once, of one /64 network with IPv6");
    Add("max-queued-jobs", options.runner.max_queued_jobs, "Jobs that may wait");
    Add("max-queued-jobs-per-caller", options.runner.max_queued_jobs_per_caller,
        "Jobs of one caller that may wait");
    Add("max-job-memory-bytes", options.max_job_memory_bytes,
        "Memory that running jobs, uploads and analyses may need, by estimate; 0 is half of the "
        "machine's");
    Add("max-watchers-per-job", options.max_watchers_per_job, "WatchJob streams of one job");
    Add("max-stream-bytes", options.streams.most_bytes,
        "Memory for messages of open streams that their readers have not taken yet; one caller may "
        "have three quarters");
    Add("max-write-duration", options.streams.longest_write_seconds,
        "Seconds after which a stream ends whose reader takes no message");
    Add("job-retention", options.job_retention_seconds, "Seconds that an ended job is kept");
    Add("max-mesh-bytes", options.mesh_limits.max_bytes, "Bytes of an encoded mesh");
    Add("max-record-bytes", options.records.max_bytes,
        "Bytes of what is written down of all jobs and meshes, reports of their runs included");
    Add("max-record-bytes-per-caller", options.records.max_owner_bytes, "The same of one caller's");
    Add("max-data-bytes", options.max_data_bytes,
        "Bytes of all meshes, images and samples together; 0: what the disk has");
    Add("max-stored-mesh-bytes", options.max_stored_mesh_bytes,
        "Bytes of encoded meshes that one caller may have stored");
    Add("mesh-retention", options.mesh_retention_seconds, "Seconds that an unused mesh is kept");
    Add("max-inline-mesh-bytes", options.request_limits.max_inline_mesh_bytes,
        "Bytes of an encoded mesh in a request");
    Add("max-texture-bytes", options.request_limits.max_texture_bytes,
        "Bytes of an encoded image in a request");
    Add("max-sample-count", options.request_limits.max_sample_count, "Samples of a job");
    Add("max-vertex-count", options.mesh_limits.max_vertices, "Vertices of a mesh");
    Add("max-face-count", options.mesh_limits.max_faces, "Triangles of a mesh");
    Add("max-iterations", options.request_limits.max_iterations, "Alternations of a job");
    Add("max-job-duration", options.request_limits.max_job_seconds,
        "Seconds that a job may compute");
  }

  CLI::App& app_;
  std::map<std::string, std::function<std::string()>> settings_;
};

int Fail(const absl::Status& status) {
  const std::string_view message(status.message().data(), status.message().size());
  std::fprintf(stderr, "ccst-server: %s\n", PrintableText(message).c_str());
  return kUsageError;
}

// `request` is NAME or NAME:read-only.
int PrintNewToken(const std::string& request) {
  const std::size_t colon = request.find(':');
  const std::string name = request.substr(0, colon);
  const bool is_read_only = colon != std::string::npos && request.substr(colon) == kReadOnlySuffix;
  if (!IsTokenName(name) || (colon != std::string::npos && !is_read_only)) {
    return Fail(absl::InvalidArgumentError(
        "--new-token must be NAME or NAME:read-only; a name has 1 to 64 letters, digits and ._@-"));
  }
  const auto token = NewToken();
  if (!token.ok()) return Fail(token.status());
  const Scope scope = is_read_only ? Scope::kReadOnly : Scope::kFull;
  std::printf("for the caller, not kept anywhere: %s\nfor --auth-token-file: %s\n", token->c_str(),
              TokenLine(name, scope, *token).c_str());
  return EXIT_SUCCESS;
}

}  // namespace

std::variant<Done, ServerOptions> ParseCommandLine(int argc, const char* const* argv) {
  ServerOptions options;
  CLI::App app(
      "Puts blue-noise samples on triangle meshes, over gRPC (ccst.v1).\n"
      "Every setting comes from its flag, else from the environment as CCST_<FLAG>, else from the\n"
      "file that --config names.",
      "ccst-server");
  app.set_version_flag("--version", absl::StrCat("ccst-server ", std::string(ProjectVersion()),
                                                 " (", std::string(SourceRevision()), ")"));
  std::string config;
  bool check = false;
  bool health = false;
  std::string new_token;
  app.add_option("--config", config, "File of settings, a line each: flag = value")
      ->envname("CCST_CONFIG");
  app.add_flag("--check-config", check, "Print the settings, or what is wrong, and exit");
  app.add_flag("--health", health,
               "Ask the server with these settings whether it serves, and exit");
  app.add_option("--new-token", new_token, "Print a new token and its line, and exit")
      ->type_name("NAME[:read-only]");
  Flags flags(app, options);
  try {
    app.parse(argc, argv);
    if (!config.empty()) flags.ReadFile(config);
  } catch (const CLI::ParseError& error) {
    return Done{app.exit(error) == 0 ? EXIT_SUCCESS : kUsageError};
  }
  if (!new_token.empty()) return Done{PrintNewToken(new_token)};
  if (app.get_option("--max-running-jobs")->count() == 0) {
    options.runner.max_running_jobs = DefaultMaxRunningJobs(options.threads_per_job);
    if (const auto left = ThreadsLeftInControlGroup()) {
      const int fitting = MaxRunningJobsWithin(
          options, static_cast<int>(std::min<std::int64_t>(*left, kMaxThreadsLookedAt)));
      // Where none fits, the start says so in words.
      options.runner.max_running_jobs =
          std::clamp(options.runner.max_running_jobs, 1, std::max(1, fitting));
    }
  }
  if (const absl::Status status = options.Validate(); !status.ok()) return Done{Fail(status)};
  if (health) {
    const absl::Status status = CheckHealth(options);
    return status.ok() ? Done{EXIT_SUCCESS} : Done{Fail(status)};
  }
  if (!check) return options;
  if (const absl::Status status = options.security.CheckFiles(); !status.ok()) {
    return Done{Fail(status)};
  }
  std::fputs(flags.ToText().c_str(), stdout);
  return Done{EXIT_SUCCESS};
}

}  // namespace ccst::server
