#include "server/auth/tls_files.h"

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/certificates.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

class TlsFilesTest : public testing::Test {
 protected:
  // The message of LoadTls() for these texts; `ok` when there is none.
  std::string Load(const std::string& certificate, const std::string& key,
                   const std::string& client_ca) {
    const auto material = LoadTls({.certificate = folder_.Write("cert", certificate),
                                   .key = folder_.Write("key", key),
                                   .client_ca = folder_.Write("ca", client_ca)});
    if (!material.ok()) {
      EXPECT_EQ(GetErrorReason(material.status()), ErrorReason::kOptionInvalid);
      return std::string(material.status().message());
    }
    return "ok";
  }

  TempFolder folder_;
  const TestCertificate authority_ = MakeAuthority("authority");
  const TestCertificate server_ = MakeCertificate(authority_, "server");
};

TEST_F(TlsFilesTest, RightFilesAndChainsAreTaken) {
  EXPECT_EQ(Load(server_.certificate, server_.key, authority_.certificate), "ok");
  EXPECT_EQ(Load(server_.certificate + authority_.certificate, server_.key,
                 authority_.certificate + server_.certificate),
            "ok");
}

TEST_F(TlsFilesTest, BrokenOnesAreNamedByTheirFlag) {
  const auto begins = [this](const std::string& flag, const std::string& certificate,
                             const std::string& key, const std::string& client_ca) {
    const std::string message = Load(certificate, key, client_ca);
    EXPECT_EQ(message.rfind(flag + " ", 0), 0U) << message;
    EXPECT_EQ(message.find('/'), std::string::npos) << message;
  };
  const std::string half = server_.certificate.substr(0, server_.certificate.size() / 2);
  const std::string& ca = authority_.certificate;
  begins("--tls-cert", "", server_.key, ca);
  begins("--tls-cert", "not PEM", server_.key, ca);
  begins("--tls-cert", half, server_.key, ca);
  begins("--tls-cert", server_.certificate + half, server_.key, ca);
  begins("--tls-key", server_.certificate, "not PEM", ca);
  begins("--tls-key", server_.certificate, authority_.key, ca);
  begins("--tls-client-ca", server_.certificate, server_.key, "not PEM");
}

TEST_F(TlsFilesTest, MissingFileIsNamedByItsFlag) {
  const auto material = LoadTls({.certificate = folder_.Path("none"), .key = folder_.Path("none")});
  EXPECT_EQ(material.status().message().rfind("--tls-cert: ", 0), 0U) << material.status();
}

TEST_F(TlsFilesTest, StampChangesWithEachOfTheFiles) {
  const TlsPaths paths = {.certificate = folder_.Write("cert", "1"),
                          .key = folder_.Write("key", "1"),
                          .client_ca = folder_.Write("ca", "1")};
  for (const char* name : {"cert", "key", "ca"}) {
    const TlsStamps before = StampsOf(paths);
    EXPECT_EQ(before, StampsOf(paths));
    folder_.Write(name, "2");
    EXPECT_NE(before, StampsOf(paths)) << name;
  }
}

}  // namespace
}  // namespace ccst::server
