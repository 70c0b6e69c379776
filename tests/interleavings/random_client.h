#pragma once

#include <atomic>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "ccst/v1/job.pb.h"
#include "tests/interleavings/journal.h"
#include "tests/interleavings/service.h"

namespace ccst::interleavings {

/// What clients choose from: little, so that they meet.
struct Workload {
  int owners = 2;
  std::vector<std::string> meshes;             ///< Encoded.
  std::vector<v1::SamplingOptions> options;    ///< Of jobs.
  mutable std::atomic<int> requests_made = 0;  ///< A few requests after each other have one id.
};

/// One client that makes calls of chance and tells the journal what it was answered. Not
/// thread-safe; several work side by side.
class RandomClient {
 public:
  /// All outlive it.
  RandomClient(Service& service, Journal& journal, const Workload& workload, std::uint64_t seed)
      : service_(service), journal_(journal), workload_(workload), random_(seed) {}

  /// Makes one call, or a few.
  void Act();

  /// Uploads this one.
  void UploadMesh(const std::string& mesh);

 private:
  // In [0, count), count >= 1.
  int Draw(int count);
  bool Chance(int percent) { return Draw(100) < percent; }
  int Owner() { return Draw(workload_.owners); }
  const std::string& Mesh();
  const v1::SamplingOptions& Options();
  // One of the owner's jobs; empty when it has none. Rarely another owner's.
  std::string Job(int owner);

  void Create();
  void Sample();
  void Get();
  void Watch();
  void Cancel();
  void Delete();
  void Read();
  void List();
  void Upload();
  void Download();
  void DeleteMesh();
  void Tend();

  Service& service_;
  Journal& journal_;
  const Workload& workload_;
  std::mt19937_64 random_;
};

}  // namespace ccst::interleavings
