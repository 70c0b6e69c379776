// No request may have a field of any length: asked of every method of a real server.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "proto/convert/field_limits.h"
#include "tests/proto/api_fields.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FileDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;

// Every method that takes `request`.
std::vector<const MethodDescriptor*> MethodsOf(const Descriptor& request) {
  std::vector<const MethodDescriptor*> methods;
  const FileDescriptor& file = *request.file();
  for (int s = 0; s < file.service_count(); ++s) {
    for (int m = 0; m < file.service(s)->method_count(); ++m) {
      const MethodDescriptor* const method = file.service(s)->method(m);
      if (method->input_type() == &request) methods.push_back(method);
    }
  }
  return methods;
}

// What the server says to one message, whatever the method is.
grpc::Status Call(TestServer& server, const MethodDescriptor& method, const Message& request) {
  const std::string path = "/" + method.service()->full_name() + "/" + method.name();
  grpc::GenericStub stub(server.channel());
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  const grpc::Slice slice(request.SerializeAsString());
  const grpc::ByteBuffer bytes(&slice, 1);
  const auto next = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, path, &queue);
  call->StartCall(nullptr);
  next();
  call->WriteLast(bytes, grpc::WriteOptions(), nullptr);
  next();
  grpc::Status status;
  call->Finish(&status, nullptr);
  next();
  return status;
}

std::int64_t MostOf(const ApiField& field) {
  for (const FieldLimit& limit : FieldLimits()) {
    if (limit.field == field.path.back()->full_name()) return limit.most;
  }
  return 0;
}

TEST(RequestLimits, EveryMethodRefusesEveryFieldThatIsTooLong) {
  TestServer server(QuickSampler());
  int asked = 0;
  for (const ApiField& field : FieldsOf(Requests())) {
    const std::int64_t most = MostOf(field);
    if (most == 0) continue;
    for (const MethodDescriptor* const method : MethodsOf(*field.root)) {
      const grpc::Status status = Call(server, *method, *WithLength(field, most + 1));
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT)
          << method->name() << " " << field.Text() << ": " << status.error_message();
      EXPECT_THAT(status.error_message(),
                  testing::HasSubstr("must have at most " + std::to_string(most)))
          << method->name() << " " << field.Text();
      ++asked;
    }
  }
  EXPECT_GT(asked, 30);
}

TEST(RequestLimits, BytesHaveTheAdvertisedLimits) {
  ServerOptions options;
  options.request_limits.max_inline_mesh_bytes = 100;
  options.request_limits.max_texture_bytes = 50;
  TestServer server(QuickSampler(), options);
  int asked = 0;
  for (const ApiField& field : FieldsOf(Requests())) {
    // A chunk of an upload comes after a header; mesh_upload_test asks for it.
    if (MostOf(field) != 0 || field.root == v1::UploadMeshRequest::descriptor()) continue;
    for (const MethodDescriptor* const method : MethodsOf(*field.root)) {
      const grpc::Status status = Call(server, *method, *WithLength(field, 101));
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field.Text();
      v1::Status details;
      ASSERT_TRUE(details.ParseFromString(status.error_details()));
      v1::LimitViolation violation;
      ASSERT_TRUE(Unpack(details, violation)) << field.Text();
      EXPECT_EQ(violation.requested_value(), 101) << field.Text();
      ++asked;
    }
  }
  EXPECT_EQ(asked, 4);  // A mesh in two ways, an image in two.
}

}  // namespace
}  // namespace ccst::server
