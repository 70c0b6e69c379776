#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

namespace ccst {

/// A text, list or map somewhere in a message of the API.
struct ApiField {
  const google::protobuf::Descriptor* root;
  std::vector<const google::protobuf::FieldDescriptor*> path;  ///< From the root to it.

  std::string Text() const;
};

/// The requests of all methods of `ccst.v1`, once each.
std::vector<const google::protobuf::Descriptor*> Requests();
/// The same, and what is stored and listed: jobs and meshes.
std::vector<const google::protobuf::Descriptor*> RequestsAndRecords();

/// All texts, lists and maps in `roots`, however deep.
std::vector<ApiField> FieldsOf(const std::vector<const google::protobuf::Descriptor*>& roots);

/// A message of the field's root in which nothing is set but that field, with `length` bytes or
/// entries, and what leads to it.
std::unique_ptr<google::protobuf::Message> WithLength(const ApiField& field, std::int64_t length);

}  // namespace ccst
