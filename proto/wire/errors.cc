#include "proto/wire/errors.h"

#include <algorithm>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "wire/error_info.pb.h"

namespace meshfront {
namespace {

constexpr char kErrorInfoUrl[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr char kRetryInfoUrl[] = "type.googleapis.com/google.rpc.RetryInfo";
constexpr char kBadRequestUrl[] = "type.googleapis.com/google.rpc.BadRequest";
constexpr size_t kMaxMetadataValueBytes = 200;
constexpr size_t kMaxMetadataEntries = 8;
constexpr absl::Duration kDefaultRetryDelay = absl::Seconds(1);

// The longest prefix of at most `limit` bytes that does not cut a UTF-8 character.
absl::string_view CutUtf8(absl::string_view text, size_t limit) {
  if (text.size() <= limit) return text;
  while (limit > 0 && (static_cast<uint8_t>(text[limit]) & 0xc0) == 0x80) --limit;
  return text.substr(0, limit);
}

absl::string_view DefaultReason(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
      return "INVALID_REQUEST";
    case absl::StatusCode::kFailedPrecondition:
      return "INPUT_NOT_MESHABLE";
    case absl::StatusCode::kResourceExhausted:
      return "LIMIT_EXCEEDED";
    case absl::StatusCode::kUnavailable:
      return "UNAVAILABLE";
    case absl::StatusCode::kDataLoss:
      return "CHECKSUM_MISMATCH";
    case absl::StatusCode::kAborted:
      return "READER_STALLED";
    case absl::StatusCode::kCancelled:
      return "CANCELLED";
    case absl::StatusCode::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    case absl::StatusCode::kUnimplemented:
      return "NOT_SUPPORTED_YET";
    default:
      return "INTERNAL";
  }
}

template <class Message>
void Attach(absl::Status& status, const char* url, const Message& message) {
  status.SetPayload(url, absl::Cord(message.SerializeAsString()));
}

absl::Status WithDefaultDetails(absl::Status status) {
  if (!status.GetPayload(kErrorInfoUrl)) status = WithReason(status, DefaultReason(status.code()));
  if (status.code() == absl::StatusCode::kUnavailable && !status.GetPayload(kRetryInfoUrl)) {
    status = WithRetry(status, kDefaultRetryDelay);
  }
  const std::string field = FieldPathOf(status.message());
  if (status.code() == absl::StatusCode::kInvalidArgument && !field.empty()) {
    google::rpc::BadRequest bad;
    google::rpc::BadRequest::FieldViolation* violation = bad.add_field_violations();
    violation->set_field(field);
    violation->set_description(std::string(CutUtf8(status.message(), kMaxMetadataValueBytes)));
    Attach(status, kBadRequestUrl, bad);
  }
  return status;
}

}  // namespace

absl::Status WithReason(absl::Status status, absl::string_view reason, const ErrorMetadata& metadata) {
  wire::ErrorInfo info;
  info.set_reason(std::string(reason));
  info.set_domain(kErrorDomain);
  for (const auto& [key, value] : metadata) {
    if (info.metadata_size() == kMaxMetadataEntries) break;
    (*info.mutable_metadata())[key] = std::string(CutUtf8(value, kMaxMetadataValueBytes));
  }
  Attach(status, kErrorInfoUrl, info);
  return status;
}

absl::Status WithRetry(absl::Status status, absl::Duration delay) {
  google::rpc::RetryInfo info;
  const int64_t milliseconds = std::max<int64_t>(0, absl::ToInt64Milliseconds(delay));
  info.mutable_retry_delay()->set_seconds(milliseconds / 1000);
  info.mutable_retry_delay()->set_nanos(static_cast<int32_t>(milliseconds % 1000) * 1'000'000);
  Attach(status, kRetryInfoUrl, info);
  return status;
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const absl::Status full = WithDefaultDetails(status);
  const std::string message(CutUtf8(full.message(), kMaxErrorMessageBytes));
  google::rpc::Status details;
  details.set_code(static_cast<int>(full.code()));
  details.set_message(message);
  full.ForEachPayload([&](absl::string_view url, const absl::Cord& value) {
    google::protobuf::Any any;
    any.set_type_url(std::string(url));
    any.set_value(std::string(value));
    if (details.ByteSizeLong() + any.ByteSizeLong() + 8 <= kMaxErrorDetailsBytes)
      *details.add_details() = std::move(any);
  });
  return grpc::Status(static_cast<grpc::StatusCode>(full.code()), message, details.SerializeAsString());
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  absl::Status result(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  const google::rpc::Status details = DetailsOf(status);
  for (const google::protobuf::Any& any : details.details()) {
    result.SetPayload(any.type_url(), absl::Cord(any.value()));
  }
  return result;
}

ErrorReason ReasonOf(const absl::Status& status) {
  ErrorReason result;
  wire::ErrorInfo info;
  const absl::optional<absl::Cord> payload = status.GetPayload(kErrorInfoUrl);
  if (!payload || !info.ParseFromString(std::string(*payload))) return result;
  result.reason = info.reason();
  result.metadata.insert(info.metadata().begin(), info.metadata().end());
  return result;
}

google::rpc::Status DetailsOf(const grpc::Status& status) {
  google::rpc::Status details;
  if (!details.ParseFromString(status.error_details())) details.Clear();
  return details;
}

std::string FieldPathOf(absl::string_view message) {
  static constexpr absl::string_view kRoots[] = {"options", "output", "request_id", "mesh", "points",
                                                 "file",    "header", "block",      "end",  "message"};
  const size_t end = std::min(message.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."), message.size());
  absl::string_view path = message.substr(0, end);
  while (!path.empty() && path.back() == '.') path.remove_suffix(1);
  const size_t dot = path.find('.');
  const absl::string_view root = path.substr(0, dot);
  const bool known = std::find(std::begin(kRoots), std::end(kRoots), root) != std::end(kRoots);
  // A bare word may be the beginning of any sentence ("mesh has no face"); only request_id is a field by itself.
  if (!known || (dot == absl::string_view::npos && root != "request_id")) return "";
  return std::string(path);
}

}  // namespace meshfront
