// Makes the seeds of fuzz_requests: fuzz_requests_corpus FOLDER writes
// FOLDER/fuzz_requests/<input>.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ccst/v1/mesh_service.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "server/formats/job_definition.h"
#include "server/formats/job_history.h"
#include "server/formats/job_outcome.h"
#include "server/formats/mesh_facts.h"

namespace {

namespace v1 = ccst::v1;

// The order of the types in requests.cc.
enum Type : char {
  kSample,
  kCreateJob,
  kListJobs,
  kFind,
  kUpload,
  kCreateMesh,
  kName,
  kStored,
  kEarlier
};

constexpr char kSha256[] = "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";

v1::SamplingOptions Options() {
  v1::SamplingOptions options;
  options.set_sample_count(100);
  options.set_max_iterations(5);
  options.set_relative_tolerance(0.5);
  options.set_seed(7);
  options.set_crease_angle_radians(1.0);
  options.mutable_time_limit()->set_seconds(1);
  options.mutable_curvature()->set_exponent(2.0);
  return options;
}

v1::MeshUploadHeader Header() {
  v1::MeshUploadHeader header;
  header.mutable_digest()->set_sha256(kSha256);
  header.mutable_digest()->set_size_bytes(5);
  header.set_format(v1::MESH_FORMAT_DRACO);
  header.set_display_name("name");
  return header;
}

void Write(const std::filesystem::path& folder, const std::string& name, Type type,
           const std::string& bytes) {
  std::ofstream file(folder / name, std::ios::binary);
  file << type << bytes;
  if (!file.flush()) throw std::runtime_error("cannot write " + name);
}

void WriteAll(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  v1::SampleRequest sample;
  *sample.mutable_options() = Options();
  sample.mutable_inline_mesh()->set_format(v1::MESH_FORMAT_DRACO);
  sample.mutable_inline_mesh()->set_data("DRACO");
  sample.mutable_inline_mesh()->mutable_origin()->set_x(1.0);
  sample.set_preview_sample_count(10);
  (*sample.mutable_labels())["key"] = "value";
  Write(folder, "sample", kSample, sample.SerializeAsString());
  sample.set_mesh_name(std::string("meshes/") + kSha256);
  sample.mutable_options()->mutable_texture()->set_image("PNG");
  Write(folder, "sample-texture", kSample, sample.SerializeAsString());

  v1::CreateJobRequest create;
  create.mutable_spec()->set_mesh(std::string("meshes/") + kSha256);
  *create.mutable_spec()->mutable_options() = Options();
  create.mutable_spec()->mutable_options()->mutable_attribute()->set_attribute_name("weight");
  create.set_request_id("request");
  create.set_display_name("name");
  create.mutable_abandon_timeout()->set_seconds(3);
  Write(folder, "create-job", kCreateJob, create.SerializeAsString());
  Write(folder, "earlier-definition", kEarlier, create.SerializeAsString());

  v1::ListJobsRequest list;
  list.set_page_size(5);
  list.add_states(v1::Job::STATE_RUNNING);
  list.set_mesh(std::string("meshes/") + kSha256);
  (*list.mutable_labels())["key"] = "value";
  Write(folder, "list-jobs", kListJobs, list.SerializeAsString());

  v1::FindMissingMeshesRequest find;
  *find.add_digests() = Header().digest();
  Write(folder, "find-missing", kFind, find.SerializeAsString());
  v1::UploadMeshRequest upload;
  *upload.mutable_header() = Header();
  Write(folder, "upload", kUpload, upload.SerializeAsString());
  v1::CreateMeshRequest mesh;
  *mesh.mutable_header() = Header();
  mesh.set_data("DRACO");
  Write(folder, "create-mesh", kCreateMesh, mesh.SerializeAsString());

  Write(folder, "mesh-name", kName, std::string("meshes/") + kSha256);
  Write(folder, "job-name", kName, "jobs/01234567-89ab-4cde-8f01-23456789abcd");
  Write(folder, "mesh-path", kName, "meshes/../../x");

  v1::Job outcome;
  outcome.set_state(v1::Job::STATE_SUCCEEDED);
  outcome.mutable_result()->set_sample_count(100);
  outcome.mutable_result()->mutable_samples_digest()->set_sha256(kSha256);
  outcome.mutable_progress()->set_iteration(3);
  Write(folder, "earlier-outcome", kEarlier, outcome.SerializeAsString());

  ccst::server::JobDefinition definition;
  definition.options.sample_count = 100;
  definition.origin = Eigen::Vector3d(1.0, 2.0, 3.0);
  Write(folder, "definition", kStored, ccst::server::EncodeDefinition(definition));
  ccst::server::JobOutcome ended;
  ended.result = std::make_shared<const ccst::server::JobResult>();
  ended.last_report = ccst::AlternationReport();
  Write(folder, "outcome", kStored, ccst::server::EncodeOutcome(ended));
  Write(folder, "history", kStored,
        ccst::server::EncodeHistory(std::vector<ccst::AlternationReport>(3)));
  ccst::server::MeshFacts facts;
  facts.attributes.push_back({.name = "heat"});
  facts.warnings = {"one"};
  Write(folder, "facts", kStored, ccst::server::EncodeFacts(facts));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_requests_corpus FOLDER\n");
    return 1;
  }
  try {
    WriteAll(std::filesystem::path(argv[1]) / "fuzz_requests");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
