// The reactors: gRPC's callbacks handed to a Call, and its answers to gRPC. None of them blocks. None lets an exception out:
// gRPC would swallow it, and the call would hang.
#pragma once

#include <utility>

#include <grpcpp/grpcpp.h>

#include "meshfront/v1/remesh_service.grpc.pb.h"
#include "proto/wire/errors.h"
#include "server/call.h"

namespace meshfront {

inline Call::Peer PeerOf(const char* rpc, const grpc::CallbackServerContext& context) {
  return {rpc, context.peer(), absl::FromChrono(context.deadline())};
}

// The half of a reactor that reads an upload. Deletes itself when gRPC is done with it.
template <class Base, class Request>
class UploadReactor : public Base, public EventWriter {
 public:
  UploadReactor(ServiceState& state, Call::Peer peer, Call::Run run) : call_(state, std::move(peer), this, run) {}

  void OnReadDone(bool ok) final {
    if (!ok) return call_.OnInputCut();
    const bool more = call_.OnMessage(request_);
    if (!more || call_.submitted()) request_ = Request();  // the job may run long; the last block need not stay
    if (more) this->StartRead(&request_);                  // also after the end: nothing may come there
  }
  void OnCancel() final { call_.OnCancel(); }
  void OnDone() final { delete this; }

 protected:
  // Last in the constructor of the derived class: what it starts may call back at once.
  void Begin() {
    if (call_.Begin()) this->StartRead(&request_);
  }

  Call call_;

 private:
  Request request_;
};

// As ToGrpcStatus, also where there is no memory for the details.
inline grpc::Status FinalStatus(const absl::Status& status) noexcept {
  try {
    return ToGrpcStatus(status);
  } catch (...) {
    return grpc::Status(static_cast<grpc::StatusCode>(status.code()), "");
  }
}

class RemeshReactor final
    : public UploadReactor<grpc::ServerBidiReactor<v1::RemeshRequest, v1::RemeshResponse>, v1::RemeshRequest> {
 public:
  RemeshReactor(ServiceState& state, const grpc::CallbackServerContext& context)
      : UploadReactor(state, PeerOf("Remesh", context), RunRemesh) {
    Begin();
  }

  void OnWriteDone(bool ok) override {
    try {
      call_.OnWritten(ok);
    } catch (...) {
      call_.OnFault();
    }
  }
  void StartEvent(v1::MeshEvent event) override {
    try {
      *response_.mutable_event() = std::move(event);
      StartWrite(&response_);
    } catch (...) {
      call_.OnFault();
    }
  }
  void EndCall(const absl::Status& status) override {
    call_.OnEnded(status);
    Finish(FinalStatus(status));
  }

 private:
  v1::RemeshResponse response_;
};

class EstimateReactor final : public UploadReactor<grpc::ServerReadReactor<v1::EstimateRequest>, v1::EstimateRequest> {
 public:
  EstimateReactor(ServiceState& state, const grpc::CallbackServerContext& context, v1::EstimateResponse* response)
      : UploadReactor(state, PeerOf("Estimate", context), RunEstimate), response_(response) {
    Begin();
  }

  // The one response goes out with the status; Accepted and progress have no place in this rpc.
  void StartEvent(v1::MeshEvent) override { call_.OnWritten(true); }
  void EndCall(const absl::Status& status) override {
    absl::Status final = status;
    try {
      if (status.ok()) *response_ = call_.job().estimate;
    } catch (...) {
      final = absl::Status(absl::StatusCode::kResourceExhausted, "");
    }
    call_.OnEnded(final);
    Finish(FinalStatus(final));
  }

 private:
  v1::EstimateResponse* const response_;
};

}  // namespace meshfront
