#include "server/auth/certificate_identity.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <openssl/err.h>
#include <openssl/sha.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "server/auth/caller.h"

namespace ccst::server {
namespace {

using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;

// No common name that begins so is an owner by itself, so that nobody can be called like a digest.
constexpr char kDigestPrefix[] = "x509:";
constexpr std::size_t kMaxLabelNameBytes = 64;
constexpr std::size_t kLabelDigits = 12;

absl::Status Refused(std::string_view message) {
  ERR_clear_error();
  return MakeError(absl::StatusCode::kUnauthenticated, ErrorReason::kUnauthenticated, message);
}

// One attribute of the subject.
struct Attribute {
  std::string type;      // Object identifier, as numbers.
  std::string value;     // UTF-8, or the bytes of what is no string.
  int kind = 0;          // Kind of what is no string; 0 for UTF-8.
  int set = 0;           // Attributes of one set stand side by side in the name.
  bool is_name = false;  // A common name.
};

// Strings of every kind become UTF-8: an authority may write the same name in another kind next
// year. Bytes that are no string of their kind stay as they are.
void SetValue(const ASN1_STRING* string, Attribute& attribute) {
  unsigned char* utf8 = nullptr;
  const int size = ASN1_STRING_to_UTF8(&utf8, string);
  if (size >= 0) {
    attribute.value.assign(reinterpret_cast<const char*>(utf8), static_cast<std::size_t>(size));
    OPENSSL_free(utf8);
    return;
  }
  attribute.kind = ASN1_STRING_type(string);
  attribute.value.assign(reinterpret_cast<const char*>(ASN1_STRING_get0_data(string)),
                         static_cast<std::size_t>(ASN1_STRING_length(string)));
}

std::vector<Attribute> SubjectOf(const X509& certificate) {
  std::vector<Attribute> subject;
  const X509_NAME* name = X509_get_subject_name(&certificate);
  for (int i = 0; i < X509_NAME_entry_count(name); ++i) {
    const X509_NAME_ENTRY* entry = X509_NAME_get_entry(name, i);
    const ASN1_OBJECT* type = X509_NAME_ENTRY_get_object(entry);
    Attribute attribute;
    attribute.set = X509_NAME_ENTRY_set(entry);
    attribute.is_name = OBJ_obj2nid(type) == NID_commonName;
    attribute.type.resize(static_cast<std::size_t>(OBJ_obj2txt(nullptr, 0, type, 1)) + 1);
    OBJ_obj2txt(attribute.type.data(), static_cast<int>(attribute.type.size()), type, 1);
    SetValue(X509_NAME_ENTRY_get_data(entry), attribute);
    subject.push_back(std::move(attribute));
  }
  return subject;
}

// The alternative names as DER, sorted, each once: their order says nothing.
absl::StatusOr<std::vector<std::string>> AlternativeNamesOf(const X509& certificate) {
  int found = 0;
  const std::unique_ptr<GENERAL_NAMES, decltype(&GENERAL_NAMES_free)> names(
      static_cast<GENERAL_NAMES*>(
          X509_get_ext_d2i(&certificate, NID_subject_alt_name, &found, nullptr)),
      GENERAL_NAMES_free);
  std::vector<std::string> encoded;
  if (names == nullptr) {
    if (found == -1) return encoded;  // There are none.
    return Refused("the alternative names of the certificate cannot be read");
  }
  for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) {
    unsigned char* der = nullptr;
    const int size = i2d_GENERAL_NAME(sk_GENERAL_NAME_value(names.get(), i), &der);
    if (size < 0) return Refused("the alternative names of the certificate cannot be read");
    encoded.emplace_back(reinterpret_cast<const char*>(der), static_cast<std::size_t>(size));
    OPENSSL_free(der);
  }
  std::sort(encoded.begin(), encoded.end());
  encoded.erase(std::unique(encoded.begin(), encoded.end()), encoded.end());
  return encoded;
}

// Kind and length come first, so different parts never make the same text.
void Append(std::string_view part, std::string& text) {
  absl::StrAppend(&text, part.size(), ":", absl::string_view(part.data(), part.size()));
}

std::string DigestOf(const std::vector<Attribute>& subject,
                     const std::vector<std::string>& alternatives) {
  std::string text = absl::StrCat("subject ", subject.size(), " ");
  for (const Attribute& attribute : subject) {
    absl::StrAppend(&text, attribute.set, " ", attribute.kind, " ");
    Append(attribute.type, text);
    Append(attribute.value, text);
  }
  absl::StrAppend(&text, "alternatives ", alternatives.size(), " ");
  for (const std::string& alternative : alternatives) Append(alternative, text);
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  return absl::BytesToHexString(
      absl::string_view(reinterpret_cast<const char*>(digest.data()), digest.size()));
}

// Tag and length alone: a name that is there, and empty.
bool IsEmptyName(const std::string& der) { return der.size() <= 2; }

// What people know the holder by: the common name, else the first thing the certificate says.
std::string NameForPeople(const std::vector<Attribute>& subject,
                          const std::vector<std::string>& alternatives) {
  const auto common = std::find_if(subject.begin(), subject.end(), [](const Attribute& attribute) {
    return attribute.is_name && !attribute.value.empty();
  });
  if (common != subject.end()) return common->value;
  const auto any = std::find_if(subject.begin(), subject.end(), [](const Attribute& attribute) {
    return !attribute.value.empty();
  });
  if (any != subject.end()) return any->value;
  return alternatives.front().substr(2);
}

absl::StatusOr<CertificateIdentity> Identify(const X509& certificate) {
  const std::vector<Attribute> subject = SubjectOf(certificate);
  CCST_ASSIGN_OR_RETURN(const std::vector<std::string> alternatives,
                        AlternativeNamesOf(certificate));
  const bool has_subject =
      std::any_of(subject.begin(), subject.end(),
                  [](const Attribute& attribute) { return !attribute.value.empty(); });
  if (!has_subject && std::all_of(alternatives.begin(), alternatives.end(), IsEmptyName)) {
    return Refused(
        "the certificate names nobody; it needs a subject or a subject alternative name");
  }
  if (subject.size() == 1 && subject.front().is_name && alternatives.empty()) {
    const std::string& name = subject.front().value;
    if (subject.front().kind == 0 && Printable(name) == name &&
        !absl::StartsWith(name, kDigestPrefix)) {
      return CertificateIdentity{.owner = name, .label = name};
    }
  }
  const std::string digest = DigestOf(subject, alternatives);
  const std::string name = NameForPeople(subject, alternatives);
  return CertificateIdentity{.owner = absl::StrCat(kDigestPrefix, digest),
                             .label = absl::StrCat(Printable(name.substr(0, kMaxLabelNameBytes)),
                                                   "#", digest.substr(0, kLabelDigits))};
}

}  // namespace

absl::StatusOr<CertificateIdentity> IdentifyCertificate(std::string_view der) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(der.data());
  const unsigned char* const end = bytes + der.size();
  const Certificate certificate(d2i_X509(nullptr, &bytes, static_cast<long>(der.size())),
                                X509_free);
  if (certificate == nullptr || bytes != end) return Refused("the certificate cannot be read");
  return Identify(*certificate);
}

}  // namespace ccst::server
