#include "server/auth/certificate_identity.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/asn1.h>

#include "absl/strings/ascii.h"
#include "tests/server/certificates.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxOwnerBytes = 128;

class CertificateIdentityTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { authority_ = new TestCertificate(MakeAuthority("authority")); }
  static void TearDownTestSuite() { delete authority_; }

  static absl::StatusOr<CertificateIdentity> Identify(const TestNames& names) {
    return IdentifyCertificate(DerOf(MakeCertificateOf(*authority_, names)));
  }
  static std::string Owner(const TestNames& names) {
    const auto identity = Identify(names);
    EXPECT_TRUE(identity.ok()) << identity.status();
    return identity.ok() ? identity->owner : "";
  }
  static TestNames CommonName(const std::string& name, const std::string& alternatives = "") {
    return {.subject = {{.type = "CN", .value = name}}, .alternatives = alternatives};
  }

  static TestCertificate* authority_;
};

TestCertificate* CertificateIdentityTest::authority_ = nullptr;

bool IsWord(const std::string& text) {
  return !text.empty() && text.size() <= kMaxOwnerBytes &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return absl::ascii_isgraph(static_cast<unsigned char>(c)); });
}

TEST_F(CertificateIdentityTest, PlainCommonNameAloneIsTheOwner) {
  for (const char* name : {"alice", "a_b", "worker-7.example.org", "10.0.0.1", "unknown"}) {
    const auto identity = Identify(CommonName(name));
    ASSERT_TRUE(identity.ok()) << identity.status();
    EXPECT_EQ(identity->owner, name);
    EXPECT_EQ(identity->label, name);
  }
}

TEST_F(CertificateIdentityTest, DifferentNamesAreDifferentOwners) {
  const std::string longest(64, 'n');
  const std::vector<TestNames> all = {
      CommonName("a_b"),
      CommonName("a b"),
      CommonName("a\tb"),
      CommonName("A_B"),
      CommonName(std::string("a_b\0c", 5)),
      CommonName(std::string("a_b\0d", 5)),
      CommonName("M\u00fcller"),
      CommonName("M\u00f6ller"),
      CommonName("\u5f20\u4f1f"),
      CommonName("\u674e\u5a1c"),
      CommonName("Mu\u0308ller"),  // Prints like the first, in other letters.
      CommonName(longest),
      CommonName(longest.substr(1)),
      {.subject = {{.type = "O", .value = longest},
                   {.type = "OU", .value = longest},
                   {.type = "CN", .value = "one"}}},
      {.subject = {{.type = "O", .value = longest},
                   {.type = "OU", .value = longest},
                   {.type = "CN", .value = "two"}}},
      CommonName("a_b", "DNS:a_b"),
      CommonName("a_b", "URI:a_b"),
      CommonName("a_b", "email:a_b"),
      CommonName("a_b", "DNS:shared,DNS:one"),
      CommonName("a_b", "DNS:shared,DNS:two"),
      CommonName("c_d", "DNS:shared,DNS:one"),
      CommonName("", "DNS:shared,DNS:one"),
      {.subject = {}, .alternatives = "DNS:shared"},
      {.subject = {}, .alternatives = "URI:spiffe://example.org/one"},
      {.subject = {}, .alternatives = "URI:spiffe://example.org/two"},
      {.subject = {{.type = "O", .value = "a_b"}}},
      {.subject = {{.type = "CN", .value = "a"}, {.type = "CN", .value = "b"}}},
      {.subject = {{.type = "CN", .value = "b"}, {.type = "CN", .value = "a"}}},
      {.subject = {{.type = "CN", .value = "a"}, {.type = "CN", .value = "b", .beside = true}}},
      {.subject = {{.type = "CN", .value = "a"}, {.type = "O", .value = "b"}}},
      CommonName("a/O=b"),
      CommonName("a,O=b"),
      CommonName("a+O=b"),
      CommonName("x509:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"),
  };
  std::map<std::string, std::size_t> owners;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [other, is_new] = owners.emplace(Owner(all[i]), i);
    EXPECT_TRUE(is_new) << "names " << i << " and " << other->second << " are both "
                        << other->first;
  }
}

// No name may pose as the digest that stands for another.
TEST_F(CertificateIdentityTest, NameOfTheFormOfADigestIsNotTheOwnerItself) {
  const std::string digest = Owner(CommonName("M\u00fcller"));
  ASSERT_LE(digest.size(), 71U);
  // OpenSSL makes no common name over 64 letters; others do.
  EXPECT_NE(Owner(CommonName(digest.substr(0, 64))), digest.substr(0, 64));
}

TEST_F(CertificateIdentityTest, RenewedCertificateIsOfTheSameOwner) {
  const TestNames names = {
      .subject = {{.type = "O", .value = "Caf\u00e9"}, {.type = "CN", .value = "z"}},
      .alternatives = "DNS:b,URI:u,DNS:a"};
  TestNames reordered = names;
  reordered.alternatives = "DNS:a,DNS:b,URI:u";
  TestNames other_kinds = names;
  other_kinds.subject[0].value = std::string("\0C\0a\0f\0\xe9", 8);
  other_kinds.subject[0].kind = V_ASN1_BMPSTRING;
  other_kinds.subject[1].kind = V_ASN1_PRINTABLESTRING;
  const std::string owner = Owner(names);
  EXPECT_EQ(Owner(names), owner);  // Another key and serial number each time.
  EXPECT_EQ(Owner(reordered), owner);
  EXPECT_EQ(Owner(other_kinds), owner);
}

TEST_F(CertificateIdentityTest, NamesOfNobodyAreRefused) {
  for (const TestNames& names :
       {TestNames{}, TestNames{.subject = {{.type = "CN", .value = ""}}}}) {
    const auto identity = Identify(names);
    EXPECT_TRUE(absl::IsUnauthenticated(identity.status())) << identity.status();
    EXPECT_NE(identity.status().message().find("names nobody"), std::string::npos);
  }
}

TEST_F(CertificateIdentityTest, WhatIsNoCertificateIsRefused) {
  const std::string right = DerOf(MakeCertificateOf(*authority_, CommonName("alice")));
  for (const std::string& text : {std::string(), std::string("\x30\x03\x02\x01\x05", 5),
                                  right + "x", right.substr(0, right.size() - 1)}) {
    EXPECT_TRUE(absl::IsUnauthenticated(IdentifyCertificate(text).status()));
  }
}

TEST_F(CertificateIdentityTest, OwnerAndLabelAreWordsOfALogLine) {
  for (const std::string& name :
       {std::string("line\nbreak owner=root"), std::string("\x1b[31mred"),
        std::string("\u202eevil"), std::string(64, ' '), std::string("a\0b", 3)}) {
    const TestNames names = {.subject = {{.type = "CN", .value = name, .kind = V_ASN1_UTF8STRING}}};
    const auto identity = Identify(names);
    ASSERT_TRUE(identity.ok()) << identity.status();
    EXPECT_TRUE(IsWord(identity->owner)) << identity->owner;
    EXPECT_TRUE(IsWord(identity->label)) << identity->label;
  }
}

// Short names over few letters, so that equal ones and near misses come often.
TEST_F(CertificateIdentityTest, OwnersAreEqualExactlyWhereNamesAre) {
  std::mt19937 random(7);
  const std::vector<std::string> types = {"CN", "O", "OU"};
  const std::vector<std::string> letters = {"a", "b", "\u00e4", " ", ","};
  const std::vector<std::string> alternatives = {"DNS:a", "DNS:b", "URI:a"};
  using Names = std::pair<std::vector<TestAttribute>, std::set<std::string>>;
  std::map<Names, std::string> owners;
  std::map<std::string, Names> names_of;
  for (int i = 0; i < 300; ++i) {
    Names names;
    for (auto left = 1 + random() % 2; left > 0; --left) {
      std::string value = letters[random() % letters.size()];
      if (random() % 2 == 0) value += letters[random() % letters.size()];
      names.first.push_back({.type = types[random() % types.size()], .value = value});
    }
    std::string text;
    if (random() % 3 == 0) {
      for (auto left = 1 + random() % 2; left > 0; --left) {
        const std::string& one = alternatives[random() % alternatives.size()];
        names.second.insert(one);
        text += (text.empty() ? "" : ",") + one;
      }
    }
    const std::string owner = Owner({.subject = names.first, .alternatives = text});
    const auto [before, is_new] = owners.emplace(names, owner);
    EXPECT_EQ(before->second, owner);
    const auto [same, first] = names_of.emplace(owner, names);
    EXPECT_EQ(same->second, names);
  }
  EXPECT_GT(owners.size(), 100U);
  EXPECT_LT(owners.size(), 300U);
}

}  // namespace
}  // namespace ccst::server
