#include "tests/server/meshes/mesh_store_fixture.h"

#include <filesystem>
#include <utility>

#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "server/meshes/measure_mesh.h"
#include "tests/support/shapes.h"

namespace ccst::server {

MeshStoreTest::MeshStoreTest()
    : dependencies_{.decode = DecodeDraco,
                    .take_memory = nullptr,
                    .measure = MeasureMesh,
                    .clock = {.now = [this] { return now_; }, .seconds = [] { return 0.0; }}} {}

void MeshStoreTest::AcceptAnyBytes() {
  dependencies_.decode = [](std::span<const char>, const MeshLimits&) { return shapes::Cube(); };
}

MeshStore& MeshStoreTest::meshes() {
  if (!meshes_.has_value()) {
    pins_.emplace(*store_);
    meshes_.emplace(*store_, *pins_, options_, dependencies_);
  }
  return *meshes_;
}

absl::StatusOr<StoredMesh> MeshStoreTest::Upload(const std::string& owner,
                                                 const std::string& bytes) {
  const MeshUpload upload = Announced(owner, bytes);
  std::unique_ptr<BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, meshes().Begin(upload));
  CCST_RETURN_IF_ERROR(writer->Append(bytes.substr(0, bytes.size() / 2)));
  CCST_RETURN_IF_ERROR(writer->Append(bytes.substr(bytes.size() / 2)));
  return meshes().Finish(upload, *writer);
}

std::size_t MeshStoreTest::FileCount() const {
  std::size_t count = 0;
  for (const char* folder : {"/blobs", "/incoming"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_ + folder)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
  }
  return count;
}

void MeshStoreTest::AddJob(const std::string& owner, const std::string& sha256) {
  JobRecord job = SomeJob("job" + std::to_string(jobs_.size()));
  job.owner = owner;
  job.mesh_sha256 = sha256;
  ASSERT_TRUE(store_->AddJob(job).ok());
  jobs_.push_back(job);
}

void MeshStoreTest::EndJobs() {
  for (const JobRecord& job : jobs_) ASSERT_TRUE(store_->EndJob(Ended(job), "").ok());
}

MeshUpload Announced(const std::string& owner, const std::string& bytes) {
  return {.owner = owner,
          .sha256 = Digest(bytes),
          .size_bytes = static_cast<std::int64_t>(bytes.size()),
          .display_name = "a mesh"};
}

std::string CubeBytes(double scale) {
  return *EncodeDraco(shapes::Moved(shapes::Cube(), Eigen::Vector3d::Zero(), scale));
}

}  // namespace ccst::server
