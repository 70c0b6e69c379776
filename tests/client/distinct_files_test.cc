#include "client/cli/distinct_files.h"

#include <filesystem>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/server/temp_folder.h"

namespace ccst::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// In a folder of its own, which is the current one, so that relative names are tried too.
class DistinctFiles : public ::testing::Test {
 protected:
  DistinctFiles() : before_(fs::current_path()) {
    fs::current_path(folder_.Path(""));
    fs::create_directory("sub");
    fs::create_directory_symlink("sub", "linked");
    mesh_ = folder_.Write("mesh.ply", "ply");
  }
  ~DistinctFiles() override { fs::current_path(before_); }

  // The error of writing to `output` what is made of `input`.
  static std::string Refusal(const std::string& output, const std::string& input) {
    const absl::Status status = CheckDistinct({{"-o", output}}, {{"the mesh", input}});
    EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status)) << status;
    return std::string(status.message());
  }
  static std::string RefusalOfBoth(const std::string& one, const std::string& other) {
    const absl::Status status = CheckDistinct({{"-o", one}, {"", ""}, {"--summary", other}}, {});
    EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status)) << status;
    return std::string(status.message());
  }

  const fs::path before_;
  server::TempFolder folder_;
  std::string mesh_;  // Its absolute name.
};

// Has `path` as standard input or output for a while.
class Redirected {
 public:
  Redirected(int stream, const std::string& path) : stream_(stream), before_(dup(stream)) {
    const int file = open(path.c_str(), O_RDWR);
    dup2(file, stream);
    close(file);
  }
  ~Redirected() {
    dup2(before_, stream_);
    close(before_);
  }

 private:
  const int stream_;
  const int before_;
};

TEST_F(DistinctFiles, OutputThatIsTheInputIsRefused) {
  fs::create_symlink("mesh.ply", "soft.ply");
  fs::create_symlink("soft.ply", "soft of soft.ply");
  fs::create_hard_link("mesh.ply", "hard.ply");
  for (const std::string& name :
       std::vector<std::string>{"mesh.ply", "./mesh.ply", "sub/../mesh.ply", "linked/../mesh.ply",
                                mesh_, "soft.ply", "soft of soft.ply", "hard.ply", "//" + mesh_}) {
    EXPECT_THAT(Refusal(name, "mesh.ply"), HasSubstr("would overwrite the mesh mesh.ply")) << name;
    EXPECT_THAT(Refusal("mesh.ply", name), HasSubstr("which is read; name another file")) << name;
  }
}

TEST_F(DistinctFiles, OtherFilesAreTaken) {
  folder_.Write("other.ply", "ply");
  fs::create_symlink("nowhere.ply", "dangling.ply");
  for (const char* name : {"other.ply", "new.ply", "sub/mesh.ply", "dangling.ply", ""}) {
    EXPECT_EQ(Refusal(name, "mesh.ply"), "") << name;
  }
  EXPECT_EQ(Refusal("mesh.ply", ""), "");
  EXPECT_EQ(Refusal("missing/mesh.ply", "missing/mesh.ply"), "");  // Others say what is missing.
}

TEST_F(DistinctFiles, OutputsThatAreOneFileAreRefused) {
  fs::create_symlink("mesh.ply", "soft.ply");
  fs::create_hard_link("mesh.ply", "hard.ply");
  EXPECT_THAT(RefusalOfBoth("mesh.ply", "soft.ply"), HasSubstr("are one file"));
  EXPECT_THAT(RefusalOfBoth("mesh.ply", "hard.ply"), HasSubstr("are one file"));
  // One that will be made.
  EXPECT_THAT(RefusalOfBoth("new.ply", "./new.ply"), HasSubstr("-o new.ply and --summary ./new"));
  EXPECT_THAT(RefusalOfBoth("sub/new.ply", "linked/new.ply"), HasSubstr("are one file"));
  EXPECT_THAT(RefusalOfBoth("new.ply", folder_.Path("new.ply")), HasSubstr("are one file"));
  EXPECT_EQ(RefusalOfBoth("new.ply", "sub/new.ply"), "");
  EXPECT_EQ(RefusalOfBoth("new.ply", "new.json"), "");
}

TEST_F(DistinctFiles, StandardOutputTakesOneOutputByWhicheverName) {
  const Redirected out(STDOUT_FILENO, mesh_);
  EXPECT_THAT(RefusalOfBoth("-", "-"), HasSubstr("standard output can take one output only"));
  EXPECT_THAT(RefusalOfBoth("-", "/dev/stdout"), HasSubstr("are one file"));
  EXPECT_THAT(RefusalOfBoth("/dev/fd/1", "/dev/stdout"), HasSubstr("are one file"));
  EXPECT_THAT(RefusalOfBoth("-", "mesh.ply"), HasSubstr("are one file"));
  EXPECT_EQ(RefusalOfBoth("-", "new.ply"), "");
}

TEST_F(DistinctFiles, StandardStreamsAreComparedAsTheFilesTheyAre) {
  {
    const Redirected in(STDIN_FILENO, mesh_);
    EXPECT_THAT(Refusal("mesh.ply", "-"), HasSubstr("would overwrite the mesh"));
    EXPECT_EQ(Refusal("new.ply", "-"), "");
    const Redirected out(STDOUT_FILENO, mesh_);
    EXPECT_THAT(Refusal("-", "-"), HasSubstr("would overwrite the mesh"));
  }
  const Redirected out(STDOUT_FILENO, mesh_);
  EXPECT_THAT(Refusal("/dev/stdout", "mesh.ply"), HasSubstr("would overwrite"));
}

TEST_F(DistinctFiles, DevicesAndPipesMayBeBoth) {
  ASSERT_EQ(mkfifo("pipe", 0600), 0);
  EXPECT_EQ(Refusal("pipe", "pipe"), "");
  EXPECT_EQ(Refusal("/dev/null", "/dev/null"), "");
  EXPECT_EQ(RefusalOfBoth("/dev/null", "/dev/null"), "");
  const Redirected out(STDOUT_FILENO, "/dev/null");
  EXPECT_EQ(RefusalOfBoth("-", "/dev/null"), "");
  EXPECT_THAT(RefusalOfBoth("pipe", "./pipe"), HasSubstr("are one file"));
}

TEST_F(DistinctFiles, BuffersOfGltfCountAsInputs) {
  folder_.Write("cube.gltf", "{}");
  folder_.Write("cube.bin", "numbers");
  fs::create_symlink("cube.bin", "summary.json");
  EXPECT_THAT(Refusal("cube.bin", "cube.gltf"), HasSubstr("a buffer of the mesh cube.gltf"));
  EXPECT_THAT(Refusal("summary.json", "cube.gltf"), HasSubstr("a buffer of"));
  EXPECT_EQ(Refusal("new.bin", "cube.gltf"), "");
  EXPECT_EQ(Refusal("cube.bin", "mesh.ply"), "");
}

}  // namespace
}  // namespace ccst::cli
