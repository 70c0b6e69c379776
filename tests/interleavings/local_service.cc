#include "tests/interleavings/local_service.h"

#include <condition_variable>
#include <mutex>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "core/io/samples_digest.h"
#include "proto/convert/names.h"
#include "server/rpc/job_events.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/mesh_messages.h"

namespace ccst::interleavings {
namespace {

constexpr int kMaxRunning = 3;
constexpr int kMaxQueued = 100'000;
constexpr int kPageSize = 7;  // Several pages even of few jobs.
constexpr absl::Duration kLongestWait = absl::Seconds(60);

class NoObserver final : public server::JobObserver {
 public:
  void OnPhase(std::string_view /*phase*/, double /*seconds*/) override {}
  void OnAlternation() override {}
  void OnEnd(std::string_view /*state*/, double /*seconds*/) override {}
  void OnCancel(std::string_view /*reason*/) override {}
  void OnCacheLookup(std::string_view /*cache*/, bool /*hit*/) override {}
};

server::Caller CallerOf(int owner) {
  return {.owner = "owner" + std::to_string(owner), .scope = server::Scope::kFull, .known = true};
}

std::string OwnerName(int owner) { return CallerOf(owner).visible_owner(); }

// What follows the slash of `jobs/...` or `meshes/...`.
std::string KeyOf(const std::string& name) { return name.substr(name.find('/') + 1); }

// Of the bytes, so that samples differ between meshes.
absl::StatusOr<TriangleMesh> Decode(std::span<const char> bytes, const MeshLimits& /*limits*/) {
  TriangleMesh mesh;
  for (const char byte : bytes) mesh.positions.emplace_back(byte, 0.0, 0.0);
  return mesh;
}

template <typename Records, typename List>
absl::Status AllPages(const List& list, std::vector<Records>& all) {
  std::string token;
  do {
    auto page = list(token);
    if (!page.ok()) return page.status();
    for (Records& record : page->records) all.push_back(std::move(record));
    token = page->next_token;
  } while (!token.empty());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<LocalService>> LocalService::Start(OpenStore open,
                                                                  std::uint64_t seed) {
  std::unique_ptr<LocalService> service(new LocalService(std::move(open), seed));
  CCST_RETURN_IF_ERROR(service->Open());
  return service;
}

LocalService::LocalService(OpenStore open, std::uint64_t seed)
    : open_(std::move(open)), seed_(seed) {}

LocalService::~LocalService() { Close(); }

absl::Duration LocalService::retention() const { return absl::Seconds(100); }

absl::Status LocalService::Open() {
  static NoObserver observer;
  schedule_ = std::make_unique<Schedule>(seed_ + static_cast<std::uint64_t>(++openings_));
  std::unique_ptr<server::Store> store;
  CCST_ASSIGN_OR_RETURN(store, open_());
  store_ = std::make_unique<server::WatchedStore>(std::move(store));
  store_->before = [this](std::string_view call) {
    schedule_->Pass(call, Side::kBefore);
    return absl::OkStatus();
  };
  store_->after = [this](std::string_view call) { schedule_->Pass(call, Side::kAfter); };
  pins_ = std::make_unique<server::BlobPins>(*store_);
  const server::RunDependencies run = Run();
  server::MeshStoreOptions mesh_options;
  mesh_options.retention = absl::Hours(1000);
  meshes_ = std::make_unique<server::MeshStore>(
      *store_, *pins_, mesh_options,
      server::MeshDependencies{.decode = Decode,
                               .take_memory = nullptr,
                               .measure = [](const TriangleMesh&) { return server::MeshFacts(); },
                               .clock = run.clock});
  server::JobManagerOptions options;
  options.runner = {.max_running_jobs = kMaxRunning,
                    .max_queued_jobs = kMaxQueued,
                    .max_queued_jobs_per_caller = kMaxQueued};
  options.retention = retention();
  const auto budget = std::make_shared<server::MemoryBudget>(options.memory_budget_bytes);
  CCST_ASSIGN_OR_RETURN(
      jobs_, server::JobManager::Start(*store_, *pins_, options,
                                       {.run = run,
                                        .new_id = [this] { return std::to_string(next_id_++); },
                                        .observer = &observer,
                                        .budget = budget}));
  analyst_ = std::make_unique<server::JobAnalyst>(*jobs_, store_->blobs(), budget, run, 1,
                                                  absl::ZeroDuration());
  unused_ = std::make_unique<server::Executor>(1, 1);
  support_ = std::make_unique<server::JobSupport>(server::JobSupport{.jobs = *jobs_,
                                                                     .meshes = *meshes_,
                                                                     .blobs = store_->blobs(),
                                                                     .pins = *pins_,
                                                                     .analyst = *analyst_,
                                                                     .disk = *unused_,
                                                                     .analyses = *unused_,
                                                                     .limits = {}});
  return absl::OkStatus();
}

void LocalService::Close() {
  if (schedule_ != nullptr) schedule_->Release();
  support_ = nullptr;
  unused_ = nullptr;
  analyst_ = nullptr;
  jobs_ = nullptr;
  meshes_ = nullptr;
  pins_ = nullptr;
  store_ = nullptr;
  schedule_ = nullptr;
}

server::RunDependencies LocalService::Run() {
  return {.count = [](const ByteSource&, const MeshLimits&) -> absl::StatusOr<server::MeshCounts> {
            return server::MeshCounts{.vertices = 10, .faces = 20};
          },
          .image_facts = nullptr,
          .decode = Decode,
          .decode_image = nullptr,
          .sample = [this](const TriangleMesh& mesh, const SamplingOptions& options,
                           const RunControl& run) { return SampleMesh(mesh, options, run); },
          .digest = SamplesDigest,
          .clock = {.now = [this] { return Now(); },
                    .seconds = [this] { return static_cast<double>(seconds_); }},
          .mesh_limits = {},
          .threads_per_job = 1};
}

absl::StatusOr<SamplingResult> LocalService::SampleMesh(const TriangleMesh& mesh,
                                                        const SamplingOptions& options,
                                                        const RunControl& run) {
  SamplingResult result;
  run.progress->OnPhase(Phase::kRelaxing);
  const bool moves = options.method != SamplingMethod::kWhiteNoise;
  if (moves) result.alternations = 1 + static_cast<int>(options.seed % 3);
  // As a real run does: the initial set is the first that is reported.
  for (int i = 0; moves && i <= result.alternations; ++i) {
    schedule_->Pass("a run", Side::kBefore);
    if (run.stop.stop_requested()) {
      return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped");
    }
    AlternationReport report;
    report.alternation = i;
    run.progress->OnAlternation(report);
  }
  for (int i = 0; i < static_cast<int>(options.sample_count); ++i) {
    const Eigen::Vector3d& place =
        mesh.positions[(static_cast<std::size_t>(i) + options.seed) % mesh.positions.size()];
    result.samples.faces.push_back(i);
    result.samples.barycentrics.emplace_back(0.25, 0.5);
    result.samples.positions.push_back(place);
    result.samples.normals.emplace_back(0.0, 0.0, 1.0);
    result.samples.triangles.emplace_back(i, static_cast<int>(place.x()),
                                          static_cast<int>(options.seed));
  }
  return result;
}

absl::StatusOr<v1::Job> LocalService::CreateJob(int owner, const v1::CreateJobRequest& request) {
  return server::Submit(*support_, CallerOf(owner), request);
}

absl::StatusOr<Sampled> LocalService::Sample(int owner, const v1::SampleRequest& request,
                                             bool leave) {
  JobCall call;
  CCST_ASSIGN_OR_RETURN(call, FromProto(request));
  v1::SampleRequest mine = request;
  std::shared_ptr<server::Job> job;
  CCST_ASSIGN_OR_RETURN(job, server::Submit(*support_, CallerOf(owner), std::move(call), mine));
  Sampled sampled;
  if (leave) {
    sampled.end = server::ToProto(*job);
    jobs_->Stop(*job, server::StopCause::kCaller);
  } else {
    interleavings::Watched watched;
    CCST_ASSIGN_OR_RETURN(watched, Watch(*job));
    sampled.end = std::move(watched.end);
    if (sampled.end.has_result()) {
      CCST_ASSIGN_OR_RETURN(sampled.samples, Read(*job));
    }
  }
  // As the stream does when it is done, however it ended.
  CCST_RETURN_IF_ERROR(jobs_->Cancel(job, server::StopCause::kCaller));
  return sampled;
}

absl::StatusOr<std::shared_ptr<server::Job>> LocalService::Find(int owner,
                                                                const std::string& name) {
  return jobs_->Find(OwnerName(owner), KeyOf(name));
}

absl::StatusOr<v1::Job> LocalService::GetJob(int owner, const std::string& name) {
  std::shared_ptr<server::Job> job;
  CCST_ASSIGN_OR_RETURN(job, Find(owner, name));
  return server::ToProto(*job);
}

absl::StatusOr<std::vector<v1::Job>> LocalService::ListJobs(int owner) {
  server::JobFilter filter;
  filter.owner = OwnerName(owner);
  std::vector<server::JobSummary> summaries;
  CCST_RETURN_IF_ERROR(AllPages(
      [&](const std::string& token) { return jobs_->List(filter, kPageSize, token); }, summaries));
  std::vector<v1::Job> jobs;
  for (const server::JobSummary& summary : summaries) {
    jobs.push_back(server::ToProto(summary.id, summary.spec, summary.view));
  }
  return jobs;
}

absl::StatusOr<Watched> LocalService::WatchJob(int owner, const std::string& name) {
  std::shared_ptr<server::Job> job;
  CCST_ASSIGN_OR_RETURN(job, Find(owner, name));
  return Watch(*job);
}

absl::StatusOr<Watched> LocalService::Watch(server::Job& job) {
  std::mutex mutex;
  std::condition_variable changed;
  bool news = true;
  server::JobEvents events(job.shared_from_this(), 0, 0);
  std::int64_t watcher = 0;
  CCST_ASSIGN_OR_RETURN(watcher, jobs_->Watch(
                                     job,
                                     [&] {
                                       const std::lock_guard lock(mutex);
                                       news = true;
                                       changed.notify_all();
                                     },
                                     0));
  interleavings::Watched watched;
  absl::Status status;
  for (auto kind = events.Next(); kind != server::JobEvents::Kind::kEnd; kind = events.Next()) {
    if (kind == server::JobEvents::Kind::kProgress && events.sequence() != ++watched.report_count) {
      status = absl::DataLossError("the sequence of reports has gaps");
    }
    if (kind != server::JobEvents::Kind::kNothing) continue;
    std::unique_lock lock(mutex);
    if (!changed.wait_for(lock, absl::ToChronoSeconds(kLongestWait), [&] { return news; })) {
      status = absl::DeadlineExceededError("nothing new of the job for a minute");
      break;
    }
    news = false;
  }
  jobs_->Unwatch(job, watcher);
  CCST_RETURN_IF_ERROR(status);
  watched.end = server::ToProto(job.id(), job.spec(), events.end());
  return watched;
}

absl::StatusOr<v1::Job> LocalService::CancelJob(int owner, const std::string& name) {
  std::shared_ptr<server::Job> job;
  CCST_ASSIGN_OR_RETURN(job, Find(owner, name));
  CCST_RETURN_IF_ERROR(jobs_->Cancel(job, server::StopCause::kCaller));
  return server::ToProto(*job);
}

absl::Status LocalService::DeleteJob(int owner, const std::string& name) {
  return jobs_->Delete(OwnerName(owner), KeyOf(name));
}

absl::StatusOr<std::string> LocalService::ReadSamples(int owner, const std::string& name) {
  std::shared_ptr<server::Job> job;
  CCST_ASSIGN_OR_RETURN(job, Find(owner, name));
  return Read(*job);
}

absl::StatusOr<std::string> LocalService::Read(const server::Job& job) {
  auto stored = jobs_->OpenSamples(job);
  if (!stored.ok()) return stored.status();
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored->ReadSamples(0, stored->sample_count()));
  SampleSet triangles;
  CCST_ASSIGN_OR_RETURN(triangles, stored->ReadTriangles(0, stored->triangle_count()));
  samples.triangles = std::move(triangles.triangles);
  return SamplesDigest(samples);
}

absl::Status LocalService::UploadMesh(int owner, const std::string& bytes) {
  const server::MeshUpload upload = {.owner = OwnerName(owner),
                                     .sha256 = Sha256Of(bytes),
                                     .size_bytes = static_cast<std::int64_t>(bytes.size()),
                                     .display_name = ""};
  v1::Mesh held_mesh;
  bool held = false;
  CCST_ASSIGN_OR_RETURN(held, server::FindHeld(*meshes_, upload, held_mesh));
  if (held) return absl::OkStatus();
  std::unique_ptr<server::BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, meshes_->Begin(upload));
  CCST_RETURN_IF_ERROR(writer->Append(bytes));
  return meshes_->Finish(upload, *writer).status();
}

absl::StatusOr<std::string> LocalService::DownloadMesh(int owner, const std::string& name) {
  std::shared_ptr<const server::Blob> blob;
  CCST_ASSIGN_OR_RETURN(blob, meshes_->Open(OwnerName(owner), KeyOf(name)));
  std::string bytes(static_cast<std::size_t>(blob->size_bytes()), '\0');
  CCST_RETURN_IF_ERROR(blob->Read(0, bytes));
  return bytes;
}

absl::Status LocalService::DeleteMesh(int owner, const std::string& name) {
  return meshes_->Delete(OwnerName(owner), KeyOf(name));
}

absl::StatusOr<std::vector<std::string>> LocalService::ListMeshes(int owner) {
  std::vector<server::StoredMesh> meshes;
  CCST_RETURN_IF_ERROR(AllPages(
      [&](const std::string& token) { return meshes_->List(OwnerName(owner), 1, token); }, meshes));
  std::vector<std::string> names;
  for (const server::StoredMesh& mesh : meshes) names.push_back(MeshName(mesh.record.sha256));
  return names;
}

absl::Status LocalService::Tend(absl::Duration passes) {
  seconds_ += absl::ToInt64Seconds(passes);
  CCST_RETURN_IF_ERROR(jobs_->Sweep());
  return meshes_->DropExpired();
}

absl::Status LocalService::WaitUntilIdle() {
  if (jobs_->WaitUntilIdle(kLongestWait)) return absl::OkStatus();
  return absl::DeadlineExceededError("the service is not idle after a minute");
}

absl::StatusOr<Holdings> LocalService::Look() {
  Holdings holdings;
  std::vector<std::string> digests;
  CCST_ASSIGN_OR_RETURN(digests, store_->blobs().List());
  for (const std::string& sha256 : digests) {
    std::shared_ptr<const server::Blob> blob;
    CCST_ASSIGN_OR_RETURN(blob, store_->blobs().Open(sha256));
    holdings.blobs[sha256] = blob->size_bytes();
  }
  holdings.counted_bytes = store_->blobs().used_bytes();
  holdings.memory_bytes = jobs_->memory().used_bytes();
  holdings.watchers = jobs_->watcher_count();
  return holdings;
}

absl::Status LocalService::Restart() {
  Close();
  return Open();
}

}  // namespace ccst::interleavings
