#include "tests/interleavings/rounds.h"

#include <barrier>
#include <chrono>
#include <set>
#include <string>
#include <thread>

#include "tests/interleavings/messages.h"

namespace ccst::interleavings {
namespace {

// What is let go of on another thread, or expires just now, may be seen once more.
constexpr int kLooks = 40;
constexpr auto kPause = std::chrono::milliseconds(50);

class Round {
 public:
  Round(Service& service, const Workload& workload)
      : service_(service),
        workload_(workload),
        journal_([&service] { return service.Now(); }, service.retention()) {}

  void Work(const RoundOptions& options) {
    // Nothing is stored yet: two commits of the same bytes meet only here, or hardly ever.
    std::barrier together(options.clients);
    std::vector<std::jthread> threads;
    for (int i = 0; i < options.clients; ++i) {
      threads.emplace_back([&, i] {
        const std::uint64_t seed = options.seed * 1000 + static_cast<std::uint64_t>(i);
        RandomClient client(service_, journal_, workload_, seed);
        for (const std::string& mesh : workload_.meshes) {
          together.arrive_and_wait();
          client.UploadMesh(mesh);
        }
        for (int call = 0; call < options.calls_a_client; ++call) client.Act();
      });
    }
  }

  // All that was acknowledged is there, and nothing else.
  void Check(const std::string& when) {
    if (!Try(when + ": ", service_.WaitUntilIdle())) return;
    std::vector<std::string> faults;
    for (int look = 0; look < kLooks; ++look) {
      faults = LookAtAll();
      if (faults.empty()) break;
      std::this_thread::sleep_for(kPause);
    }
    for (const std::string& fault : faults) journal_.AddFault(when + ": " + fault);
    for (int owner = 0; owner < workload_.owners; ++owner) ReadAll(owner);
  }

  void DeleteAll() {
    for (int owner = 0; owner < workload_.owners; ++owner) {
      const auto jobs = service_.ListJobs(owner);
      if (!Try("listing jobs to delete: ", jobs.status())) return;
      for (const v1::Job& job : *jobs) {
        const absl::Status deleted = service_.DeleteJob(owner, job.name());
        if (!absl::IsNotFound(deleted)) Try("deleting " + job.name() + ": ", deleted);
      }
      const auto meshes = service_.ListMeshes(owner);
      if (!Try("listing meshes to delete: ", meshes.status())) return;
      for (const std::string& mesh : *meshes) {
        Try("deleting " + mesh + ": ", service_.DeleteMesh(owner, mesh));
      }
    }
    std::vector<std::string> faults;
    for (int look = 0; look < kLooks; ++look) {
      faults = FaultsOfNothing();
      if (faults.empty()) break;
      std::this_thread::sleep_for(kPause);
    }
    for (const std::string& fault : faults) journal_.AddFault("everything is deleted: " + fault);
  }

  RoundReport Report() const {
    return {
        .calls = journal_.call_count(), .jobs = journal_.job_count(), .faults = journal_.faults()};
  }

  bool Try(const std::string& what, const absl::Status& status) {
    if (!status.ok()) journal_.AddFault(what + Text(status));
    return status.ok();
  }

 private:
  std::vector<std::string> LookAtAll() {
    std::vector<v1::Job> jobs;
    std::set<std::string> meshes;
    for (int owner = 0; owner < workload_.owners; ++owner) {
      Moment begin = journal_.Begin();
      const auto listed = service_.ListJobs(owner);
      journal_.Listed(owner, begin, listed);
      if (!listed.ok()) return {Text(listed.status())};
      jobs.insert(jobs.end(), listed->begin(), listed->end());
      begin = journal_.Begin();
      const auto listed_meshes = service_.ListMeshes(owner);
      journal_.ListedMeshes(owner, begin, listed_meshes);
      if (!listed_meshes.ok()) return {Text(listed_meshes.status())};
      meshes.insert(listed_meshes->begin(), listed_meshes->end());
    }
    const auto holdings = service_.Look();
    if (!holdings.ok()) return {Text(holdings.status())};
    return FaultsAtRest(jobs, meshes, *holdings);
  }

  std::vector<std::string> FaultsOfNothing() {
    const auto left = service_.Look();
    if (!left.ok()) return {Text(left.status())};
    std::vector<std::string> faults;
    for (const auto& [sha256, size] : left->blobs) faults.push_back("blob " + sha256 + " is left");
    if (left->counted_bytes != 0) {
      faults.push_back(std::to_string(left->counted_bytes) + " bytes are counted still");
    }
    return faults;
  }

  void ReadAll(int owner) {
    for (const std::string& job : journal_.Jobs(owner)) {
      Moment begin = journal_.Begin();
      journal_.SawEnd(owner, job, begin, service_.WatchJob(owner, job));
      begin = journal_.Begin();
      journal_.Read(owner, job, begin, service_.ReadSamples(owner, job));
    }
    for (const std::string& mesh : workload_.meshes) {
      const Moment begin = journal_.Begin();
      const std::string name = NameOfMesh(mesh);
      journal_.Downloaded(owner, name, mesh, begin, service_.DownloadMesh(owner, name));
    }
  }

  Service& service_;
  const Workload& workload_;
  Journal journal_;
};

}  // namespace

RoundReport RunRound(Service& service, const Workload& workload, const RoundOptions& options) {
  Round round(service, workload);
  round.Work(options);
  round.Check("at rest");
  if (round.Try("restarting: ", service.Restart())) {
    round.Check("after a restart");
    round.DeleteAll();
  }
  return round.Report();
}

}  // namespace ccst::interleavings
