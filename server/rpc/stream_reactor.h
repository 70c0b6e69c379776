#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "core/base/status.h"
#include "server/base/executor.h"
#include "server/base/mutex.h"
#include "server/rpc/call.h"
#include "server/rpc/idle_timer.h"
#include "server/rpc/rpc_executor.h"
#include "server/rpc/stream_memory.h"

namespace ccst::server {

/// The open streams of a server, so that quiet ones can be told to say that they are alive.
/// Thread-safe.
class OpenStreams {
 public:
  /// A stream that may have been quiet for long.
  class Stream {
   public:
    virtual ~Stream() = default;
    virtual void Pulse() = 0;
  };

  void Add(const std::shared_ptr<Stream>& stream);
  void Remove(const std::shared_ptr<Stream>& stream);
  /// Calls Pulse() of all.
  void PulseAll();

 private:
  Mutex mutex_;
  std::set<std::shared_ptr<Stream>> streams_ ABSL_GUARDED_BY(mutex_);
};

/// What the streams of a server share; outlives them.
struct StreamSupport {
  const CallSupport& calls;
  Executor& executor;  ///< Where messages are made, which may read from the disk.
  OpenStreams& open;
  StreamMemory& memory;
};

/// What a stream has to say next.
enum class StreamStep {
  kWrite,  ///< A message was filled.
  kWait,   ///< Nothing new; Pump() when there is.
  kEnd,    ///< The stream is over.
  kRead,   ///< Of NextInMemory() alone: Next() has to say what is next.
};

/// One server-streaming call: makes one message when the last one is written, as fast as the
/// caller reads, so that a slow one costs one message of memory, for which it takes a share of
/// `StreamSupport::memory`. One that does not take a message for too long is cancelled. Keeps
/// itself alive until gRPC is done with it and no task of its own is under way. A derived class
/// says what the messages are; its functions run on the executor, NextInMemory() also on threads of
/// gRPC, one at a time.
template <typename Response>
class StreamReactor : public grpc::ServerWriteReactor<Response>,
                      public OpenStreams::Stream,
                      public std::enable_shared_from_this<StreamReactor<Response>> {
 public:
  /// @param most_bytes  of a message
  StreamReactor(const StreamSupport& support, grpc::CallbackServerContext& context,
                std::string_view method, Scope needed, std::int64_t most_bytes)
      : support_(support),
        most_bytes_(most_bytes),
        context_(&context),
        call_(std::in_place, support.calls, context, method, needed) {}

  /// Makes a reactor of type T and starts it.
  template <typename T, typename... Args>
  static T* Make(Args&&... args) {
    auto reactor = std::make_shared<T>(std::forward<Args>(args)...);
    T* const started = reactor.get();
    started->Start();
    return started;
  }

  void OnWriteDone(bool ok) final {
    write_timer_->Stop();
    {
      MutexLock lock(mutex_);
      writing_ = false;
      if (!ok) caller_gone_ = true;
    }
    // Without another thread where nothing blocks.
    if (!WriteNext(Blocking::kMustNot)) Pump();
  }

  void OnCancel() final {
    {
      MutexLock lock(mutex_);
      caller_gone_ = true;
    }
    OnGone();
    Pump();
  }

  void OnDone() final {
    support_.open.Remove(this->shared_from_this());
    {
      MutexLock lock(context_mutex_);
      context_ = nullptr;
    }
    // What blocks must not run here; the last task lets go of the reactor.
    Post([this] {
      Close();
      share_.reset();
      MutexLock lock(mutex_);
      call_.reset();
    });
    // Goes at the end of this function, or with the task.
    const auto self = std::move(self_);
  }

  void Pulse() final {
    {
      MutexLock lock(mutex_);
      quiet_ = std::exchange(pulsed_, true);
    }
    Pump();
  }

 protected:
  /// First of all, for an admitted caller; an error ends the call.
  virtual absl::Status Open(Call& call) = 0;
  /// The next message, into a cleared `message`.
  virtual StreamStep Next(Response& message) = 0;
  /// The same without blocking; kRead where that takes Next(), as at the end.
  virtual StreamStep NextInMemory(Response& /*message*/) { return StreamStep::kRead; }
  /// How a stream that is over ends.
  virtual absl::Status end_status() { return absl::OkStatus(); }
  /// A message that says no more than that the stream is alive; false when there is none.
  virtual bool MakeHeartbeat(Response& /*message*/) { return false; }
  /// True for a message that others follow at once.
  virtual bool MoreFollows(const Response& /*message*/) { return false; }
  /// The caller went away; on any thread, must not block.
  virtual void OnGone() {}
  /// Last of all, when the request and the context are gone; Open() may have failed or never run.
  virtual void Close() {}

  /// There may be something new to say; on any thread, does not block.
  void Pump() {
    Post([this] { WriteNext(Blocking::kMay); });
  }

  Call& call() { return *call_; }

 private:
  void Start() {
    self_ = this->shared_from_this();
    support_.open.Add(self_);
    write_timer_.emplace(absl::Seconds(support_.memory.limits().longest_write_seconds),
                         [weak = this->weak_from_this()] {
                           if (const auto self = weak.lock()) self->OnWriteTooLong();
                         });
    const bool accepted = support_.executor.Run([self = self_, this] {
      absl::Status status = call_->admission();
      if (status.ok()) status = TakeMemory();
      if (status.ok()) status = RunStep([this] { return Open(*call_); });
      {
        MutexLock lock(mutex_);
        opened_ = true;
        if (!status.ok()) FinishWith(status);
      }
      WriteNext(Blocking::kMay);
    });
    if (accepted) return;
    MutexLock lock(mutex_);
    FinishWith(call_->admission().ok() ? ExecutorFull() : call_->admission());
  }

  void Post(std::function<void()> task) {
    auto run = [self = this->shared_from_this(), task = std::move(task)] { task(); };
    if (!support_.executor.Run(run)) run();
  }

  enum class Blocking { kMay, kMustNot };

  // Writes the next message, or ends the call, where there is something to do. False where it would
  // have to block.
  bool WriteNext(Blocking blocking) {
    MutexLock lock(mutex_);
    if (!opened_ || writing_ || finished_) return true;
    const bool may_block = blocking == Blocking::kMay;
    if (caller_gone_) {
      if (!may_block) return false;
      FinishWith(MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                           too_long_ ? "the caller did not take a message for too long"
                                     : "the caller went away or its deadline passed"));
      return true;
    }
    StreamStep step = StreamStep::kEnd;
    message_.Clear();
    const absl::Status status = RunStep([&] {
      step = may_block ? Next(message_) : NextInMemory(message_);
      return absl::OkStatus();
    });
    if (step == StreamStep::kRead && status.ok()) return false;
    if (!status.ok() || step == StreamStep::kEnd) {
      FinishWith(status.ok() ? end_status() : status);
      return true;
    }
    if (step == StreamStep::kWait && !(std::exchange(quiet_, false) && MakeHeartbeat(message_))) {
      return true;
    }
    grpc::WriteOptions options;
    if (MoreFollows(message_)) options.set_buffer_hint();
    writing_ = true;
    pulsed_ = false;
    call_->Sent(message_);
    write_timer_->Start();
    this->StartWrite(&message_, options);
    return true;
  }

  absl::Status TakeMemory() {
    auto share = support_.memory.Take(call_->caller().owner, StreamBytes(most_bytes_));
    if (!share.ok()) return share.status();
    share_.emplace(*std::move(share));
    return absl::OkStatus();
  }

  void OnWriteTooLong() {
    {
      MutexLock lock(mutex_);
      if (!writing_) return;
      too_long_ = true;
    }
    // The write fails then, and what it keeps is freed. Reactions to that come on other threads, or
    // on this one after it has returned to gRPC, whose timer this is.
    MutexLock lock(context_mutex_);
    if (context_ != nullptr) context_->TryCancel();
  }

  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (std::exchange(finished_, true)) return;
    this->Finish(call_->End(status));
  }

  const StreamSupport support_;
  const std::int64_t most_bytes_;
  std::shared_ptr<StreamReactor> self_;
  std::optional<IdleTimer> write_timer_;
  std::optional<StreamMemory::Share> share_;  // Of the tasks.

  Mutex context_mutex_;
  // Null once gRPC is done with the call.
  grpc::CallbackServerContext* context_ ABSL_GUARDED_BY(context_mutex_);

  Mutex mutex_;
  std::optional<Call> call_;
  Response message_;  // The one being written.
  bool opened_ ABSL_GUARDED_BY(mutex_) = false;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool caller_gone_ ABSL_GUARDED_BY(mutex_) = false;
  bool too_long_ ABSL_GUARDED_BY(mutex_) = false;  // That is why it is gone.
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  bool pulsed_ ABSL_GUARDED_BY(mutex_) = false;  // Since the last message.
  bool quiet_ ABSL_GUARDED_BY(mutex_) = false;   // For a whole pulse.
};

}  // namespace ccst::server
