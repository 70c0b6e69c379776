#include "server/auth/authenticator.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

const Peer kPeer = {.address = "peer"};

class AuthenticatorTest : public testing::Test {
 protected:
  // Uses `lines` as the token file.
  absl::Status Use(const std::string& lines) {
    folder_.Write("tokens", lines);
    return authenticator_.UseTokens(folder_.Path("tokens"), [this](const std::string& message) {
      reports_.push_back(message);
    });
  }
  absl::StatusOr<Caller> Call(const std::string& token) {
    return authenticator_.Authenticate("Bearer " + token, kPeer);
  }

  TempFolder folder_;
  Authenticator authenticator_;
  std::vector<std::string> reports_;
  const std::string alice_ = TokenLine("alice", Scope::kFull, "a") + "\n";
  const std::string bob_ = TokenLine("bob", Scope::kReadOnly, "b") + "\n";
};

TEST_F(AuthenticatorTest, WithoutTokensEverybodyIsCalledByTheirAddress) {
  const auto caller = authenticator_.Authenticate("", Peer{.address = "10.0.0.1"});
  ASSERT_TRUE(caller.ok());
  EXPECT_EQ(caller->owner, "10.0.0.1");
  EXPECT_EQ(caller->scope, Scope::kFull);
  EXPECT_FALSE(caller->known);
  EXPECT_EQ(authenticator_.Authenticate("", Peer{.address = "a b\nc"})->owner, "a_b_c");
  EXPECT_EQ(authenticator_.Authenticate("", Peer{})->owner, "unknown");
}

TEST_F(AuthenticatorTest, WithoutTokensACertificateSaysWhoCalls) {
  const Peer peer = {.address = "10.0.0.1",
                     .certificate = CertificateIdentity{.owner = "x509:1f", .label = "Zoe#1f"}};
  const auto caller = authenticator_.Authenticate("", peer);
  ASSERT_TRUE(caller.ok());
  EXPECT_EQ(caller->owner, "x509:1f");
  EXPECT_EQ(caller->visible_owner(), "x509:1f");
  EXPECT_EQ(caller->shown(), "Zoe#1f");
}

TEST_F(AuthenticatorTest, CertificateThatNamesNobodyIsRefusedUnlessATokenSaysWhoCalls) {
  const Peer peer = {.address = "10.0.0.1", .certificate = absl::UnauthenticatedError("nobody")};
  EXPECT_TRUE(absl::IsUnauthenticated(authenticator_.Authenticate("", peer).status()));
  ASSERT_TRUE(Use(alice_).ok());
  EXPECT_EQ(authenticator_.Authenticate("Bearer a", peer)->owner, "alice");
}

TEST_F(AuthenticatorTest, TokenSaysWhoCalls) {
  ASSERT_TRUE(Use(alice_ + bob_).ok());
  EXPECT_EQ(Call("a")->owner, "alice");
  EXPECT_EQ(Call("b")->scope, Scope::kReadOnly);
  EXPECT_EQ(authenticator_.Authenticate("bearer a", kPeer)->owner, "alice");
}

TEST_F(AuthenticatorTest, NoTokenAWrongOneAndAnotherSchemeAreRefused) {
  ASSERT_TRUE(Use(alice_).ok());
  for (const std::string authorization : {"", "a", "Basic a", "Bearer", "Bearer ", "Bearer x"}) {
    const auto caller = authenticator_.Authenticate(authorization, kPeer);
    EXPECT_EQ(GetErrorReason(caller.status()), ErrorReason::kUnauthenticated) << authorization;
    EXPECT_TRUE(absl::IsUnauthenticated(caller.status())) << authorization;
  }
}

TEST_F(AuthenticatorTest, ChangedFileCountsWithTheNextCall) {
  ASSERT_TRUE(Use(alice_).ok());
  folder_.Write("tokens", bob_);
  EXPECT_FALSE(Call("a").ok());
  EXPECT_TRUE(Call("b").ok());
  EXPECT_EQ(reports_, std::vector<std::string>{"tokens reloaded: 1"});
}

TEST_F(AuthenticatorTest, EmptiedFileLetsNobodyIn) {
  ASSERT_TRUE(Use(alice_).ok());
  folder_.Write("tokens", "");
  EXPECT_FALSE(Call("a").ok());
}

TEST_F(AuthenticatorTest, BrokenOrMissingFileLeavesTheTokensBeforeAndIsReportedOnce) {
  ASSERT_TRUE(Use(alice_).ok());
  folder_.Write("tokens", bob_ + "nonsense\n");
  EXPECT_TRUE(Call("a").ok());
  EXPECT_FALSE(Call("b").ok());
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_NE(reports_[0].find("line 2"), std::string::npos) << reports_[0];
  EXPECT_EQ(reports_[0].find("nonsense"), std::string::npos) << reports_[0];
  std::filesystem::remove(folder_.Path("tokens"));
  EXPECT_TRUE(Call("a").ok());
  EXPECT_TRUE(Call("a").ok());
  EXPECT_EQ(reports_.size(), 2U);
  for (const std::string& report : reports_) EXPECT_EQ(report.find('/'), std::string::npos);
}

TEST_F(AuthenticatorTest, MissingFileAndFolderAreRefusedAtTheStart) {
  for (const std::string& path : {folder_.Path("nothing"), folder_.Path("")}) {
    const absl::Status status = authenticator_.UseTokens(path, [](const std::string&) {});
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kOptionInvalid) << path;
    EXPECT_EQ(status.message().rfind("--auth-token-file: ", 0), 0U) << status;
  }
}

TEST(Scope, ReadOnlyDoesNotReachFull) {
  const Caller reader = {.owner = "r", .scope = Scope::kReadOnly};
  const Caller writer = {.owner = "w", .scope = Scope::kFull};
  EXPECT_TRUE(CheckScope(reader, Scope::kReadOnly).ok());
  EXPECT_TRUE(CheckScope(writer, Scope::kReadOnly).ok());
  EXPECT_TRUE(CheckScope(writer, Scope::kFull).ok());
  const absl::Status refused = CheckScope(reader, Scope::kFull);
  EXPECT_TRUE(absl::IsPermissionDenied(refused));
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kPermissionDenied);
}

}  // namespace
}  // namespace ccst::server
