// Errors on the wire: absl::Status to grpc::Status with google.rpc details, and back.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <grpcpp/support/status.h>
#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace meshfront {

inline constexpr char kErrorDomain[] = "meshfront";
// A message is cut to this, and the details with the message to the second: base64 and all, below gRPC's 8 KiB of
// metadata.
inline constexpr size_t kMaxErrorMessageBytes = 1000;
inline constexpr size_t kMaxErrorDetailsBytes = 3600;

using ErrorMetadata = std::vector<std::pair<std::string, std::string>>;

// The status with a reason in UPPER_SNAKE and where it happened; travels as ErrorInfo.
absl::Status WithReason(absl::Status status, absl::string_view reason, const ErrorMetadata& metadata = {});
// The status with a time to wait before trying again; travels as RetryInfo.
absl::Status WithRetry(absl::Status status, absl::Duration delay);

// Codes map one to one. Adds what is missing of the details: ErrorInfo with a reason by the code, BadRequest with the
// path that an InvalidArgument message begins with ("options.eta is …"), RetryInfo on Unavailable.
grpc::Status ToGrpcStatus(const absl::Status& status);
// The way back, for clients: code and message, details as payloads.
absl::Status FromGrpcStatus(const grpc::Status& status);

// What ErrorInfo says about an error: reason empty when there is none.
struct ErrorReason {
  std::string reason;
  std::map<std::string, std::string> metadata;
};
ErrorReason ReasonOf(const absl::Status& status);

// The details of an error; empty when it has none or they are damaged.
google::rpc::Status DetailsOf(const grpc::Status& status);
// The field's path that a message about a request begins with, else empty: "options.eta" of "options.eta is 3; …".
std::string FieldPathOf(absl::string_view message);

}  // namespace meshfront
