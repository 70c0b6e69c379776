#include "server/meshes/blob_pins.h"

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

class BlobPinsTest : public StoreTest {
 protected:
  BlobPinsTest() : pins_(*store_), sha256_(*PutWhole(store_->blobs(), "bytes")) {}

  bool IsThere() { return store_->blobs().Contains(sha256_); }

  BlobPins pins_;
  const std::string sha256_;
};

TEST_F(BlobPinsTest, DroppedBlobGoesWhenNothingRefersToIt) {
  ASSERT_TRUE(pins_.Drop(sha256_).ok());
  EXPECT_FALSE(IsThere());
}

TEST_F(BlobPinsTest, DroppedBlobStaysWhileARecordRefersToIt) {
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "bytes")).ok());
  ASSERT_TRUE(pins_.Drop(sha256_).ok());
  EXPECT_TRUE(IsThere());
}

TEST_F(BlobPinsTest, DroppedBlobGoesWithItsLastPin) {
  std::optional<BlobPins::Pin> first;
  std::optional<BlobPins::Pin> second;
  first.emplace(pins_, sha256_);
  second.emplace(pins_, sha256_);
  ASSERT_TRUE(pins_.Drop(sha256_).ok());
  first.reset();
  EXPECT_TRUE(IsThere());
  second.reset();
  EXPECT_FALSE(IsThere());
}

TEST_F(BlobPinsTest, RecordMadeBeforeThePinGoesKeepsADroppedBlob) {
  {
    const BlobPins::Pin pin(pins_, sha256_);
    ASSERT_TRUE(pins_.Drop(sha256_).ok());
    ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "bytes")).ok());
  }
  EXPECT_TRUE(IsThere());
}

TEST_F(BlobPinsTest, PinAloneRemovesNothing) {
  { const BlobPins::Pin pin(pins_, sha256_); }
  EXPECT_TRUE(IsThere());
}

}  // namespace
}  // namespace ccst::server
