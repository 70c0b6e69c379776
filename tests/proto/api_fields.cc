#include "tests/proto/api_fields.h"

#include <set>
#include <stdexcept>

#include "ccst/v1/job.pb.h"
#include "ccst/v1/mesh.pb.h"
#include "ccst/v1/mesh_service.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "ccst/v1/server_info_service.pb.h"

namespace ccst {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

void Collect(const Descriptor& root, const Descriptor& message,
             std::vector<const FieldDescriptor*>& path, std::vector<ApiField>& fields) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor* const field = message.field(i);
    path.push_back(field);
    const bool is_text = field->cpp_type() == FieldDescriptor::CPPTYPE_STRING;
    if (is_text || field->is_repeated()) fields.push_back({&root, path});
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Collect(root, *field->message_type(), path, fields);
    }
    path.pop_back();
  }
}

// One more entry, which differs from those before.
void AddEntry(Message& message, const FieldDescriptor& list, std::int64_t number) {
  const Reflection& reflection = *message.GetReflection();
  switch (list.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE: {
      Message& entry = *reflection.AddMessage(&message, &list);
      if (!list.is_map()) return;
      return entry.GetReflection()->SetString(&entry, list.message_type()->map_key(),
                                              std::to_string(number));
    }
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection.AddString(&message, &list, std::to_string(number));
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.AddEnumValue(&message, &list, 1);
    default:
      throw std::logic_error(list.full_name() + " is a list of another kind: make one here");
  }
}

// The message that holds the last field of the path.
Message& Inner(const ApiField& field, Message& root) {
  Message* message = &root;
  for (std::size_t i = 0; i + 1 < field.path.size(); ++i) {
    const FieldDescriptor* const step = field.path[i];
    const Reflection& reflection = *message->GetReflection();
    message = step->is_repeated() ? reflection.AddMessage(message, step)
                                  : reflection.MutableMessage(message, step);
  }
  return *message;
}

}  // namespace

std::string ApiField::Text() const {
  std::string text = root->name();
  for (const FieldDescriptor* const step : path) text += "." + step->name();
  return text;
}

std::vector<const Descriptor*> Requests() {
  std::set<const Descriptor*> seen;
  std::vector<const Descriptor*> requests;
  for (const FileDescriptor* const file :
       {v1::SampleRequest::descriptor()->file(), v1::GetMeshRequest::descriptor()->file(),
        v1::GetServerInfoRequest::descriptor()->file()}) {
    for (int s = 0; s < file->service_count(); ++s) {
      for (int m = 0; m < file->service(s)->method_count(); ++m) {
        const Descriptor* const request = file->service(s)->method(m)->input_type();
        if (seen.insert(request).second) requests.push_back(request);
      }
    }
  }
  return requests;
}

std::vector<const Descriptor*> RequestsAndRecords() {
  std::vector<const Descriptor*> messages = Requests();
  messages.push_back(v1::Job::descriptor());
  messages.push_back(v1::Mesh::descriptor());
  return messages;
}

std::vector<ApiField> FieldsOf(const std::vector<const Descriptor*>& roots) {
  std::vector<ApiField> fields;
  std::vector<const FieldDescriptor*> path;
  for (const Descriptor* const root : roots) Collect(*root, *root, path, fields);
  return fields;
}

std::unique_ptr<Message> WithLength(const ApiField& field, std::int64_t length) {
  std::unique_ptr<Message> root(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(field.root)->New());
  const FieldDescriptor& last = *field.path.back();
  Message& inner = Inner(field, *root);
  if (last.is_repeated()) {
    for (std::int64_t i = 0; i < length; ++i) AddEntry(inner, last, i);
  } else {
    inner.GetReflection()->SetString(&inner, &last,
                                     std::string(static_cast<std::size_t>(length), 'x'));
  }
  return root;
}

}  // namespace ccst
