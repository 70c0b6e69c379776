#include "core/io/gzip.h"

#include <random>
#include <string>

#include <gtest/gtest.h>
#include <zlib.h>

#include "core/io/mesh_file.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

std::string Compressed(const std::string& text) {
  z_stream stream = {};
  constexpr int kGzip = 16 + MAX_WBITS;
  EXPECT_EQ(deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY),
            Z_OK);
  std::string out(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

TEST(Gzip, GivesBackWhatWasCompressed) {
  std::mt19937 random(1);
  for (const std::size_t size : {0, 1, 65535, 65536, 1 << 20}) {
    std::string text(size, ' ');
    for (char& c : text) c = static_cast<char>(random() % 7);
    EXPECT_EQ(DecompressGzip(Compressed(text), 1 << 20).value(), text) << size;
  }
}

TEST(Gzip, MembersFollowEachOther) {
  EXPECT_EQ(DecompressGzip(Compressed("ab") + Compressed("cd") + std::string(9, '\0'), 9).value(),
            "abcd");
}

TEST(Gzip, DamagedAndCutFilesAreRefused) {
  const std::string whole = Compressed(std::string(1000, 'x') + "some more");
  for (std::size_t size = 3; size < whole.size(); ++size) {
    EXPECT_REFUSED(DecompressGzip(whole.substr(0, size), 1 << 20), ErrorReason::kMeshUnreadable);
  }
  std::string damaged = whole;
  damaged[whole.size() - 6] ^= 1;  // The checksum.
  EXPECT_REFUSED(DecompressGzip(damaged, 1 << 20), ErrorReason::kMeshUnreadable, "damaged");
}

TEST(Gzip, NoMoreComesOutThanIsAccepted) {
  const std::string bomb = Compressed(std::string(std::size_t{64} << 20, '0'));
  EXPECT_LT(bomb.size(), 100'000u);
  EXPECT_REFUSED(DecompressGzip(bomb, 1 << 20), ErrorReason::kLimitExceeded, "1048576");
  EXPECT_LT(testing::PeakGrowth([&bomb] { (void)DecompressGzip(bomb, 1 << 20); }), 8 << 20);
}

TEST(Gzip, MeshesOfEveryFormatAreReadCompressed) {
  const testing::TemporaryFolder folder;
  testing::WriteBytes(folder / "a.OBJ.gz", Compressed("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  testing::WriteBytes(folder / "a.off.gz",
                      Compressed("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  for (const char* name : {"a.OBJ.gz", "a.off.gz"}) {
    const auto file = ReadMeshFile(folder / name);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->mesh.faces.size(), 1u);
  }
}

}  // namespace
}  // namespace ccst::io
