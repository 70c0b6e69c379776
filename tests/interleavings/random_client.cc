#include "tests/interleavings/random_client.h"

#include <utility>

#include "tests/interleavings/messages.h"

namespace ccst::interleavings {
namespace {

// So many calls of CreateJob after each other, of all clients, have the same request id.
constexpr int kEqualRequests = 4;

}  // namespace

int RandomClient::Draw(int count) {
  return static_cast<int>(random_() % static_cast<std::uint64_t>(count));
}

const std::string& RandomClient::Mesh() {
  return workload_
      .meshes[static_cast<std::size_t>(Draw(static_cast<int>(workload_.meshes.size())))];
}

const v1::SamplingOptions& RandomClient::Options() {
  return workload_
      .options[static_cast<std::size_t>(Draw(static_cast<int>(workload_.options.size())))];
}

std::string RandomClient::Job(int owner) {
  const std::vector<std::string> names = journal_.Jobs(Chance(5) ? Owner() : owner);
  return names.empty() ? "" : names[static_cast<std::size_t>(Draw(static_cast<int>(names.size())))];
}

void RandomClient::Act() {
  struct Choice {
    int weight;
    void (RandomClient::*act)();
  };
  static constexpr Choice kChoices[] = {
      {28, &RandomClient::Create},  {6, &RandomClient::Sample},     {4, &RandomClient::Get},
      {6, &RandomClient::Watch},    {5, &RandomClient::Cancel},     {20, &RandomClient::Delete},
      {9, &RandomClient::Read},     {3, &RandomClient::List},       {8, &RandomClient::Upload},
      {4, &RandomClient::Download}, {4, &RandomClient::DeleteMesh}, {3, &RandomClient::Tend}};
  int draw = Draw(100);
  for (const Choice& choice : kChoices) {
    if ((draw -= choice.weight) < 0) return (this->*choice.act)();
  }
}

void RandomClient::Create() {
  const int owner = Owner();
  v1::CreateJobRequest request;
  request.mutable_spec()->set_mesh(NameOfMesh(Mesh()));
  *request.mutable_spec()->mutable_options() = Options();
  request.set_skip_cache_lookup(Chance(40));
  if (Chance(60)) {
    const int group = workload_.requests_made++ / kEqualRequests;
    request.set_request_id("request-" + std::to_string(group));
    // Determined by the id: callers repeat a request as it was.
    const auto pick = [&](std::size_t count) { return static_cast<std::size_t>(group) % count; };
    request.mutable_spec()->set_mesh(NameOfMesh(workload_.meshes[pick(workload_.meshes.size())]));
    *request.mutable_spec()->mutable_options() = workload_.options[pick(workload_.options.size())];
    if (Chance(5)) *request.mutable_spec()->mutable_options() = Options();  // By mistake.
  }
  const Moment begin = journal_.BeginCreate(owner, request);
  journal_.Created(owner, request, begin, service_.CreateJob(owner, request));
}

void RandomClient::Sample() {
  const int owner = Owner();
  v1::SampleRequest request;
  if (Chance(70)) {
    request.mutable_inline_mesh()->set_format(v1::MESH_FORMAT_DRACO);
    request.mutable_inline_mesh()->set_data(Mesh());
  } else {
    request.set_mesh_name(NameOfMesh(Mesh()));
  }
  *request.mutable_options() = Options();
  request.set_skip_cache_lookup(Chance(40));
  const bool leave = Chance(30);
  const Moment begin = journal_.Begin();
  journal_.TookSamples(owner, request, leave, begin, service_.Sample(owner, request, leave));
}

void RandomClient::Get() {
  const int owner = Owner();
  const std::string job = Job(owner);
  if (job.empty()) return;
  const Moment begin = journal_.Begin();
  journal_.Saw(owner, job, begin, service_.GetJob(owner, job));
}

void RandomClient::Watch() {
  const int owner = Owner();
  const std::string job = Job(owner);
  if (job.empty()) return;
  const Moment begin = journal_.Begin();
  journal_.SawEnd(owner, job, begin, service_.WatchJob(owner, job));
}

void RandomClient::Cancel() {
  const int owner = Owner();
  const std::string job = Job(owner);
  if (job.empty()) return;
  const Moment begin = journal_.BeginCancel(job);
  journal_.Saw(owner, job, begin, service_.CancelJob(owner, job));
}

void RandomClient::Delete() {
  const int owner = Owner();
  const std::string job = Job(owner);
  if (job.empty()) return;
  const Moment begin = journal_.BeginDelete(job);
  journal_.Deleted(owner, job, begin, service_.DeleteJob(owner, job));
}

void RandomClient::Read() {
  const int owner = Owner();
  const std::string job = Job(owner);
  if (job.empty()) return;
  const Moment begin = journal_.Begin();
  journal_.Read(owner, job, begin, service_.ReadSamples(owner, job));
}

void RandomClient::List() {
  const int owner = Owner();
  Moment begin = journal_.Begin();
  journal_.Listed(owner, begin, service_.ListJobs(owner));
  begin = journal_.Begin();
  journal_.ListedMeshes(owner, begin, service_.ListMeshes(owner));
}

void RandomClient::Upload() { UploadMesh(Mesh()); }

void RandomClient::UploadMesh(const std::string& mesh) {
  const int owner = Owner();
  const Moment begin = journal_.BeginUpload(owner, NameOfMesh(mesh));
  journal_.Uploaded(owner, NameOfMesh(mesh), begin, service_.UploadMesh(owner, mesh));
}

void RandomClient::Download() {
  const int owner = Owner();
  const std::string& mesh = Mesh();
  const Moment begin = journal_.Begin();
  journal_.Downloaded(owner, NameOfMesh(mesh), mesh, begin,
                      service_.DownloadMesh(owner, NameOfMesh(mesh)));
}

void RandomClient::DeleteMesh() {
  const int owner = Owner();
  const std::string& mesh = Mesh();
  const Moment begin = journal_.BeginDeleteMesh(owner, NameOfMesh(mesh));
  journal_.DeletedMesh(owner, NameOfMesh(mesh), begin,
                       service_.DeleteMesh(owner, NameOfMesh(mesh)));
}

void RandomClient::Tend() {
  const absl::Status status = service_.Tend(absl::Seconds(Draw(30)));
  if (!status.ok()) journal_.AddFault("dropping what expired: " + std::string(status.message()));
}

}  // namespace ccst::interleavings
