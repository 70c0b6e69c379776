#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/store.h"

namespace ccst::server {

/// A real store that lets a test act between its calls, or makes one of them fail. Calls have the
/// names of the methods of Store, BlobStore and BlobWriter: those that change something, and those
/// that read of a job or a blob what may be dropped between two of them.
class WatchedStore : public Store {
 public:
  explicit WatchedStore(std::unique_ptr<Store> store) : store_(std::move(store)), blobs_(*this) {}

  /// Before a call; what is not OK becomes its answer, and the store does not learn of it.
  std::function<absl::Status(std::string_view call)> before = [](std::string_view) {
    return absl::OkStatus();
  };
  /// After a call that went well.
  std::function<void(std::string_view call)> after = [](std::string_view) {};

  BlobStore& blobs() override { return blobs_; }

  absl::Status PutMesh(const MeshRecord& mesh) override {
    return Watched("PutMesh", [&] { return store_->PutMesh(mesh); });
  }
  absl::StatusOr<std::optional<MeshRecord>> GetMesh(const std::string& owner,
                                                    const std::string& sha256) override {
    return store_->GetMesh(owner, sha256);
  }
  absl::Status TouchMeshes(const std::string& owner, const std::vector<std::string>& sha256s,
                           absl::Time expire_time) override {
    return Watched("TouchMeshes", [&] { return store_->TouchMeshes(owner, sha256s, expire_time); });
  }
  absl::StatusOr<Page<MeshRecord>> ListMeshes(const std::string& owner, int page_size,
                                              const std::string& page_token) override {
    return store_->ListMeshes(owner, page_size, page_token);
  }
  absl::Status DeleteMesh(const std::string& owner, const std::string& sha256) override {
    return Watched("DeleteMesh", [&] { return store_->DeleteMesh(owner, sha256); });
  }
  absl::StatusOr<std::int64_t> MeshBytes(const std::string& owner) override {
    return store_->MeshBytes(owner);
  }
  absl::StatusOr<std::vector<MeshRecord>> DropExpiredMeshes(absl::Time now, int limit) override {
    return Watched("DropExpiredMeshes", [&] { return store_->DropExpiredMeshes(now, limit); });
  }
  absl::StatusOr<std::vector<MeshRecord>> IdleMeshes(const std::string& owner) override {
    return store_->IdleMeshes(owner);
  }
  absl::StatusOr<bool> IsMeshInUse(const std::string& owner, const std::string& sha256) override {
    return store_->IsMeshInUse(owner, sha256);
  }

  absl::StatusOr<JobRecord> AddJob(const JobRecord& job) override {
    return Watched("AddJob", [&] { return store_->AddJob(job); });
  }
  absl::StatusOr<JobRecord> AddEndedJob(const JobRecord& job, const std::string& history) override {
    return Watched("AddEndedJob", [&] { return store_->AddEndedJob(job, history); });
  }
  absl::Status MarkCancelling(const std::string& id) override {
    return Watched("MarkCancelling", [&] { return store_->MarkCancelling(id); });
  }
  absl::Status CountStart(const std::string& id) override {
    return Watched("CountStart", [&] { return store_->CountStart(id); });
  }
  absl::Status GiveBackStart(const std::string& id) override {
    return Watched("GiveBackStart", [&] { return store_->GiveBackStart(id); });
  }
  absl::Status EndJob(const JobRecord& job, const std::string& history) override {
    return Watched("EndJob", [&] { return store_->EndJob(job, history); });
  }
  absl::StatusOr<std::optional<JobRecord>> GetJob(const std::string& id) override {
    return Watched("GetJob", [&] { return store_->GetJob(id); });
  }
  absl::StatusOr<std::optional<JobRecord>> FindRequest(const std::string& owner,
                                                       const std::string& request_id) override {
    return store_->FindRequest(owner, request_id);
  }
  absl::StatusOr<std::string> GetHistory(const std::string& id) override {
    return Watched("GetHistory", [&] { return store_->GetHistory(id); });
  }
  absl::StatusOr<Page<JobRecord>> ListJobs(const JobFilter& filter, int page_size,
                                           const std::string& page_token) override {
    return store_->ListJobs(filter, page_size, page_token);
  }
  absl::StatusOr<std::vector<JobRecord>> UnfinishedJobs() override {
    return store_->UnfinishedJobs();
  }
  absl::StatusOr<std::optional<JobRecord>> FindReusable(const std::string& spec_digest,
                                                        absl::Time now) override {
    return store_->FindReusable(spec_digest, now);
  }
  absl::Status DeleteJob(const std::string& id) override {
    return Watched("DeleteJob", [&] { return store_->DeleteJob(id); });
  }
  absl::StatusOr<std::vector<DroppedJob>> DropExpiredJobs(absl::Time now, int limit) override {
    return Watched("DropExpiredJobs", [&] { return store_->DropExpiredJobs(now, limit); });
  }
  absl::StatusOr<std::int64_t> RecordBytes(const std::string& owner) override {
    return store_->RecordBytes(owner);
  }
  absl::StatusOr<std::int64_t> AllRecordBytes() override { return store_->AllRecordBytes(); }
  absl::StatusOr<bool> IsReferenced(const std::string& sha256) override {
    return store_->IsReferenced(sha256);
  }

 private:
  class Writer : public BlobWriter {
   public:
    Writer(WatchedStore& store, std::unique_ptr<BlobWriter> writer)
        : store_(store), writer_(std::move(writer)) {}
    absl::Status Append(std::string_view bytes) override {
      return store_.Watched("Append", [&] { return writer_->Append(bytes); });
    }
    std::int64_t size_bytes() const override { return writer_->size_bytes(); }
    const std::string& Seal() override { return writer_->Seal(); }
    absl::Status Commit() override {
      return store_.Watched("Commit", [&] { return writer_->Commit(); });
    }

   private:
    WatchedStore& store_;
    const std::unique_ptr<BlobWriter> writer_;
  };

  class Blobs : public BlobStore {
   public:
    explicit Blobs(WatchedStore& store) : store_(store) {}
    absl::StatusOr<std::unique_ptr<BlobWriter>> NewBlob() override {
      auto writer = store_.Watched("NewBlob", [&] { return real().NewBlob(); });
      if (!writer.ok()) return writer.status();
      return std::make_unique<Writer>(store_, *std::move(writer));
    }
    absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& sha256) const override {
      return store_.Watched("Open", [&] { return real().Open(sha256); });
    }
    absl::Status CheckRoom(std::int64_t bytes) const override { return real().CheckRoom(bytes); }
    std::int64_t used_bytes() const override { return real().used_bytes(); }
    absl::Status Check(const std::string& sha256) const override {
      return store_.Watched("Check", [&] { return real().Check(sha256); });
    }
    bool Contains(const std::string& sha256) const override { return real().Contains(sha256); }
    absl::Status Remove(const std::string& sha256) override {
      return store_.Watched("Remove", [&] { return real().Remove(sha256); });
    }
    absl::StatusOr<std::vector<std::string>> List() const override { return real().List(); }

   private:
    BlobStore& real() const { return store_.store_->blobs(); }
    WatchedStore& store_;
  };

  static bool IsOk(const absl::Status& status) { return status.ok(); }
  template <typename T>
  static bool IsOk(const absl::StatusOr<T>& value) {
    return value.ok();
  }

  template <typename Call>
  auto Watched(std::string_view name, const Call& call) -> decltype(call()) {
    // Copies: they may replace themselves.
    const auto first = before;
    if (absl::Status status = first(name); !status.ok()) return status;
    auto answer = call();
    const auto last = after;
    if (IsOk(answer)) last(name);
    return answer;
  }

  const std::unique_ptr<Store> store_;
  Blobs blobs_;
};

}  // namespace ccst::server
