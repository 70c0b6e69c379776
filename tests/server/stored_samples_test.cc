#include "server/jobs/stored_samples.h"

#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/jobs/block_sums.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

class MemoryBlob : public BlobWriter, public Blob {
 public:
  absl::Status Append(std::string_view bytes) override {
    bytes_ += bytes;
    return absl::OkStatus();
  }
  std::int64_t size_bytes() const override { return static_cast<std::int64_t>(bytes_.size()); }
  const std::string& Seal() override { return bytes_; }
  absl::Status Commit() override { return absl::OkStatus(); }
  absl::Status Read(std::int64_t offset, std::span<char> out) const override {
    EXPECT_LE(offset + static_cast<std::int64_t>(out.size()), size_bytes());
    std::copy_n(bytes_.begin() + offset, out.size(), out.begin());
    return absl::OkStatus();
  }
  void Doubt() const override { doubted_ = true; }

  std::string bytes_;
  mutable bool doubted_ = false;
};

SampleSet Samples(int count = 100) {
  SampleSet samples = MakeResult(count).samples;
  samples.attributes = {
      {.name = "mass", .components = 1, .values = {}},
      {.name = "color", .kind = AttributeKind::kColor, .components = 3, .values = {}}};
  for (int i = 0; i < count; ++i) {
    samples.barycentrics[i] = Eigen::Vector2d(1.0 / (i + 3), 1.0 / 3.0);
    samples.positions[i] = Eigen::Vector3d(0.1 * i, -1e7, 1e-30);
    samples.attributes[0].values.push_back(0.5F * static_cast<float>(i));
    for (int k = 0; k < 3; ++k) samples.attributes[1].values.push_back(static_cast<float>(i + k));
  }
  return samples;
}

TEST(StoredSamples, AnyRangeReadsBackAsItWasWritten) {
  const SampleSet samples = Samples();
  const auto blob = std::make_shared<MemoryBlob>();
  ASSERT_TRUE(WriteSamples(samples, *blob).ok());
  const auto stored = StoredSamples::Open(blob);
  ASSERT_TRUE(stored.ok()) << stored.status();
  EXPECT_EQ(stored->sample_count(), 100);
  EXPECT_EQ(stored->triangle_count(), 100);
  for (const auto& [start, count] : {std::pair(0, 100), std::pair(17, 40), std::pair(100, 0)}) {
    const SampleSet read = *stored->ReadSamples(start, count);
    ASSERT_EQ(static_cast<int>(read.faces.size()), count);
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(read.faces[i], samples.faces[start + i]);
      EXPECT_EQ(read.barycentrics[i], samples.barycentrics[start + i]);
      EXPECT_EQ(read.positions[i], samples.positions[start + i].cast<float>().cast<double>());
      EXPECT_EQ(read.attributes[0].values[i], samples.attributes[0].values[start + i]);
      EXPECT_EQ(read.attributes[1].values[3 * i + 2],
                samples.attributes[1].values[3 * (start + i) + 2]);
    }
    const SampleSet mesh = *stored->ReadTriangles(start, count);
    for (int i = 0; i < count; ++i) EXPECT_EQ(mesh.triangles[i], samples.triangles[start + i]);
  }
  EXPECT_EQ(stored->attributes()[1].kind, AttributeKind::kColor);
}

TEST(StoredSamples, EveryTruncationIsNoticed) {
  MemoryBlob whole;
  ASSERT_TRUE(WriteSamples(Samples(), whole).ok());
  for (std::size_t size = 0; size < whole.bytes_.size(); size += 13) {
    const auto cut = std::make_shared<MemoryBlob>();
    cut->bytes_ = whole.bytes_.substr(0, size);
    EXPECT_EQ(GetErrorReason(StoredSamples::Open(cut).status()), ErrorReason::kStorageFailed);
  }
}

// Whether reading everything, in pieces of 700, gave an error that says that it is damaged.
bool IsSeen(const std::shared_ptr<MemoryBlob>& blob) {
  const auto stored = StoredSamples::Open(blob);
  if (!stored.ok()) return absl::IsDataLoss(stored.status());
  for (std::int64_t start = 0; start < stored->sample_count(); start += 700) {
    const std::int64_t count = std::min<std::int64_t>(700, stored->sample_count() - start);
    if (absl::IsDataLoss(stored->ReadSamples(start, count).status())) return true;
    if (absl::IsDataLoss(stored->ReadTriangles(start, count).status())) return true;
  }
  return false;
}

TEST(StoredSamples, AFlippedBitIsSeenWhereverItIs) {
  MemoryBlob whole;
  ASSERT_TRUE(WriteSamples(Samples(2000), whole).ok());
  ASSERT_GT(whole.bytes_.size(), 100'000U);  // Several blocks.
  for (std::size_t at = 0; at < whole.bytes_.size(); at += at < 200 ? 1 : 997) {
    const auto blob = std::make_shared<MemoryBlob>();
    blob->bytes_ = whole.bytes_;
    blob->bytes_[at] = static_cast<char>(blob->bytes_[at] ^ 0x04);
    EXPECT_TRUE(IsSeen(blob)) << at;
  }
  const auto last = std::make_shared<MemoryBlob>();
  last->bytes_ = whole.bytes_;
  last->bytes_.back() ^= 1;
  EXPECT_TRUE(IsSeen(last));
}

TEST(StoredSamples, DamageElsewhereDoesNotKeepARangeFromBeingRead) {
  const auto blob = std::make_shared<MemoryBlob>();
  ASSERT_TRUE(WriteSamples(Samples(2000), *blob).ok());
  const auto stored = StoredSamples::Open(blob);
  ASSERT_TRUE(stored.ok());
  blob->bytes_[blob->bytes_.size() / 2] ^= 1;
  EXPECT_TRUE(stored->ReadTriangles(1900, 100).ok());
  EXPECT_FALSE(blob->doubted_);
  EXPECT_EQ(GetErrorReason(stored->ReadSamples(0, 2000).status()), ErrorReason::kStorageFailed);
  EXPECT_TRUE(blob->doubted_);
}

TEST(StoredSamples, BlobsOfEarlierVersionsAreReadButHaveNoSums) {
  const auto blob = std::make_shared<MemoryBlob>();
  ASSERT_TRUE(WriteSamples(Samples(), *blob).ok());
  EXPECT_TRUE(StoredSamples::Open(blob)->has_sums());
  const auto size = blob->bytes_.size();
  blob->bytes_.resize(size - static_cast<std::size_t>(BlockSums::SizeFor(size * 999 / 1000)));
  blob->bytes_[20] = '1';  // The number at the end of the mark.
  const auto stored = StoredSamples::Open(blob);
  ASSERT_TRUE(stored.ok()) << stored.status();
  EXPECT_FALSE(stored->has_sums());
  EXPECT_EQ(stored->ReadSamples(3, 1)->faces[0], 3);
}

TEST(BlockSums, AreTheSameHoweverBytesArrive) {
  const std::string bytes = std::string(40'000, 'a') + std::string(5, 'b');
  BlockSums at_once;
  at_once.Add(bytes);
  BlockSums in_pieces;
  for (std::size_t i = 0; i < bytes.size(); i += 7) in_pieces.Add(bytes.substr(i, 7));
  const std::string sums = at_once.Finish();
  EXPECT_EQ(in_pieces.Finish(), sums);
  EXPECT_EQ(static_cast<std::int64_t>(sums.size()), BlockSums::SizeFor(40'005));
  EXPECT_EQ(sums.substr(0, 16), Sha256Of(bytes.substr(0, 16'384)).substr(0, 16));
  EXPECT_EQ(sums.substr(32), Sha256Of(bytes.substr(32'768)).substr(0, 16));
  EXPECT_EQ(BlockSums::SizeFor(0), 0);
  EXPECT_EQ(BlockSums::SizeFor(16'384), 16);
  EXPECT_EQ(BlockSums::SizeFor(16'385), 32);
}

}  // namespace
}  // namespace ccst::server
