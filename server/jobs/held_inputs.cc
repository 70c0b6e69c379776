#include "server/jobs/held_inputs.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/base/assert.h"

namespace ccst::server {
namespace {

class HeldBlob final : public Blob {
 public:
  explicit HeldBlob(std::shared_ptr<const HeldInput> input) : input_(std::move(input)) {}

  std::int64_t size_bytes() const override {
    return static_cast<std::int64_t>(input_->bytes.size());
  }
  absl::Status Read(std::int64_t offset, std::span<char> out) const override {
    CCST_ASSERT(offset >= 0 && offset + static_cast<std::int64_t>(out.size()) <= size_bytes());
    std::copy_n(input_->bytes.begin() + offset, out.size(), out.begin());
    return absl::OkStatus();
  }
  void Doubt() const override {}

 private:
  const std::shared_ptr<const HeldInput> input_;
};

}  // namespace

std::shared_ptr<const Blob> HeldInput::AsBlob(const std::shared_ptr<const HeldInput>& input) {
  return std::make_shared<const HeldBlob>(input);
}

HeldInputs::HeldInputs(std::int64_t most_bytes)
    : most_bytes_of_one_(most_bytes / 16), room_(std::make_shared<Room>()) {
  MutexLock lock(room_->mutex);
  room_->left_bytes = most_bytes;
}

std::shared_ptr<const HeldInput> HeldInputs::Hold(const std::string& sha256, std::string& bytes) {
  const auto size = static_cast<std::int64_t>(bytes.size());
  if (size > most_bytes_of_one_) return nullptr;
  {
    MutexLock lock(room_->mutex);
    if (size > room_->left_bytes) return nullptr;
    room_->left_bytes -= size;
  }
  const auto give_back = [room = room_, size](const HeldInput* input) {
    delete input;
    MutexLock lock(room->mutex);
    room->left_bytes += size;
  };
  return {new HeldInput{.sha256 = sha256, .bytes = std::exchange(bytes, {})}, give_back};
}

}  // namespace ccst::server
